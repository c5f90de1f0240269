"""Outcomes in the order of the visit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

from studykit.core.errors import InputError
from studykit.figures import outcomes_by_period
from studykit.figures.samples import mean_interval

LABELS = {"heart_rate_mean_bpm": "Heart rate (beats/min)", "dtw_m": "Distance (m)"}


@pytest.fixture
def trials(made_trials: Callable[..., pd.DataFrame]) -> pd.DataFrame:
    table = made_trials()
    return table.assign(period=table.groupby("participant").cumcount() + 1)


def test_everybody_is_a_point_in_every_period_and_means_stand_beside_them(trials: pd.DataFrame) -> None:
    axes = outcomes_by_period(trials, LABELS).axes[0]
    for period in range(1, 9):
        (points,) = (one for one in axes.collections if one.get_gid() == f"participants {period}")
        values = trials.loc[trials["period"] == period, "heart_rate_mean_bpm"].to_numpy()
        assert np.asarray(points.get_offsets())[:, 1] == pytest.approx(values)
    means = np.asarray(axes.containers[0].lines[0].get_ydata())
    assert means == pytest.approx(trials.groupby("period")["heart_rate_mean_bpm"].mean().to_numpy())
    ends = [path.vertices[:, 1] for path in axes.containers[0].lines[2][0].get_paths()]
    interval = mean_interval(trials.loc[trials["period"] == 1, "heart_rate_mean_bpm"].to_numpy())
    assert ends[0] == pytest.approx([interval.low, interval.high])


def test_trials_that_are_not_valid_do_not_count(trials: pd.DataFrame) -> None:
    wild = trials.assign(is_valid=trials.index > 0, dtw_m=np.where(trials.index > 0, trials["dtw_m"], 99.0))
    assert outcomes_by_period(wild, LABELS).axes[1].get_ylim()[1] < 1.0


def test_an_outcome_without_values_is_left_out_and_none_is_refused(trials: pd.DataFrame) -> None:
    assert len(outcomes_by_period(trials.assign(dtw_m=np.nan), LABELS).axes) == 1
    with pytest.raises(InputError, match="no valid trial has a value of heart_rate_mean_bpm, dtw_m"):
        outcomes_by_period(trials.assign(is_valid=False), LABELS)
