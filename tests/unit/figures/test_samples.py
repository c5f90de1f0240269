from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

from studykit.core.errors import InputError
from studykit.figures.samples import beside_each_other, by_participant, mean_interval, valid_trials


def test_the_interval_is_that_of_students_t() -> None:
    # t(0.975, 9) = 2.262157 in printed tables; the mean of 1..10 is 5.5, its standard error sqrt(55 / 6 / 10)
    interval = mean_interval(np.arange(1.0, 11.0))
    half = 2.262157 * np.sqrt(55.0 / 6.0 / 10.0)
    assert (interval.mean, interval.low, interval.high) == pytest.approx(
        (5.5, 5.5 - half, 5.5 + half), rel=1e-6
    )


def test_an_unknown_value_is_left_out_and_one_value_has_no_interval() -> None:
    assert mean_interval(np.array([1.0, np.nan, 2.0, 3.0])) == mean_interval(np.array([1.0, 2.0, 3.0]))
    assert mean_interval(np.array([4.0])).mean == 4.0
    assert np.isnan(mean_interval(np.array([4.0])).low)
    assert np.isnan(mean_interval(np.array([np.nan])).mean)


def test_equal_points_stand_beside_each_other_and_lone_ones_in_the_middle() -> None:
    shifts = beside_each_other(np.array([1.0, 5.0, 5.0, 5.0, 9.0, np.nan]), half_width=0.2)
    assert shifts[[0, 4, 5]].tolist() == [0.0, 0.0, 0.0]
    assert len(set(shifts[1:4])) == 3
    assert shifts[1:4].sum() == pytest.approx(0.0)
    assert np.abs(shifts).max() <= 0.2
    assert beside_each_other(np.full(3, np.nan), half_width=0.2).tolist() == [0.0, 0.0, 0.0]


def test_only_valid_trials_count(made_trials: Callable[..., pd.DataFrame]) -> None:
    trials = made_trials(participants=2)
    trials.loc[0, ["is_valid", "dtw_m"]] = [False, 99.0]
    table = by_participant(valid_trials(trials, ["dtw_m"], transition="on"), "dtw_m")
    assert list(table.columns) == ["light-easy-on", "light-hard-on", "intense-easy-on", "intense-hard-on"]
    assert np.isnan(table.loc["01", "light-easy-on"])
    assert table.max().max() < 99.0


def test_nothing_to_show_is_said(made_trials: Callable[..., pd.DataFrame]) -> None:
    trials = made_trials(participants=1).assign(is_valid=False)
    with pytest.raises(InputError, match="no valid trial has a value of dtw_m"):
        valid_trials(trials, ["dtw_m"], transition=None)
