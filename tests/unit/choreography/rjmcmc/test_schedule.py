"""The search cools and narrows as planned."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.choreography.rjmcmc.schedule import Schedule


def test_geometric_cooling() -> None:
    schedule = Schedule.geometric(iterations=16_000, start=0.3, end=0.002, start_width=6.0)
    assert schedule.iterations == 16_000
    ratios = schedule.temperatures[1:] / schedule.temperatures[:-1]
    assert ratios == pytest.approx(np.full(99, (0.002 / 0.3) ** (1 / 99)))
    assert schedule.temperatures[[0, -1]] == pytest.approx([0.3, 0.002])
    assert schedule.widths[0] == pytest.approx(6.0)
    assert np.all(np.diff(schedule.widths) <= 0.0)
    assert np.all(schedule.widths[67:] == 1.0)
    assert schedule.widths[60] > 1.0


def test_the_paper_s_cooling() -> None:
    schedule = Schedule.paper()
    assert schedule.temperatures[[0, 1, 50, 100]] == pytest.approx([1.0, 0.99, 0.5, 0.0], abs=1e-15)
    assert schedule.temperatures[-1] == 0.0
    assert (schedule.stage_iterations, schedule.iterations) == (1000, 101_000)
    assert np.all(schedule.widths == 1.0)


def test_one_width_a_temperature() -> None:
    with pytest.raises(ValueError, match="widths has the shape"):
        Schedule(temperatures=[1.0, 0.5], widths=[1.0], stage_iterations=10)
