from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

from studykit import figures
from studykit.figures.relations import heart_rate_against_energy


def test_lines_have_the_slope_within_people(made_trials: Callable[..., pd.DataFrame]) -> None:
    trials = made_trials()
    # People with more variety have lower distances: pooling all trials would turn the slope round.
    person = trials["participant"].astype(int)
    trials["variety_achieved"] += 10.0 * person
    trials["dtw_m"] = 0.5 * trials["variety_achieved"] - 20.0 * person
    lines = [
        line for line in figures.movement_against_variety(trials).axes[0].lines if len(line.get_xdata()) == 2
    ]
    slopes = [np.diff(line.get_ydata())[0] / np.diff(line.get_xdata())[0] for line in lines]
    assert slopes == pytest.approx([0.5] * 6)


def test_energy_is_shown_for_a_body_in_joules(made_trials: Callable[..., pd.DataFrame]) -> None:
    axes = heart_rate_against_energy(made_trials(), body_mass_kg=100.0).axes[0]
    ends = next(line.get_xdata() for line in axes.lines if len(line.get_xdata()) == 2)
    assert ends.tolist() == pytest.approx([130.0, 350.0])
    assert "(J, 100 kg)" in axes.get_xlabel()
