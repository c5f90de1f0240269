"""How hot the search is, and how wide its tolerances, over time."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.choreography.preset import PAPER, PRESETS
from studykit.choreography.rjmcmc.annealing import Annealing


def test_a_geometric_annealing_cools_by_one_factor_a_stage() -> None:
    annealing = Annealing.geometric(iterations=40_000, start=0.3, end=0.001, start_width=6.0)
    temperatures, widths = annealing.temperatures, annealing.widths
    assert (temperatures[0], temperatures[-1]) == pytest.approx((0.3, 0.001))
    factors = temperatures[1:] / temperatures[:-1]
    assert factors == pytest.approx(np.full(99, (0.001 / 0.3) ** (1.0 / 99.0)))
    assert annealing.iterations == 40_000 == 100 * annealing.stage_iterations
    assert annealing.stop_below == 0.0
    # Tolerances narrow by one factor a stage until two thirds, and are what they are from there on.
    assert widths[0] == 6.0
    narrowing = widths[widths > 1.0]
    assert narrowing[1:] / narrowing[:-1] == pytest.approx(np.full(len(narrowing) - 1, 6.0 ** (-1.5 / 99.0)))
    assert len(narrowing) == 66
    assert (widths[66:] == 1.0).all()


def test_the_printed_annealing_cools_by_a_hundredth_every_thousand() -> None:
    annealing = Annealing.paper()
    assert np.diff(annealing.temperatures) == pytest.approx(np.full(100, -0.01))
    assert (annealing.temperatures[0], annealing.temperatures[-1]) == (1.0, 0.0)
    assert (annealing.widths == 1.0).all()
    assert (annealing.stage_iterations, annealing.stop_below) == (1000, 0.03)
    assert PAPER.annealing.iterations == 101_000


@pytest.mark.parametrize("preset", PRESETS.values(), ids=PRESETS)
def test_presets_end_cold_at_the_true_tolerances(preset) -> None:
    for annealing in (preset.annealing, preset.preview):
        assert annealing.widths[-1] == 1.0
        assert np.all(np.diff(annealing.temperatures) < 0.0)
        assert np.all(np.diff(annealing.widths) <= 0.0)
        assert annealing.temperatures[-1] <= 0.001
    assert preset.preview.iterations <= preset.annealing.iterations


def test_a_longer_annealing_cools_more_slowly_to_the_same_end() -> None:
    short = Annealing.geometric(iterations=2000, start=0.3, end=0.001, start_width=6.0)
    longer = short.longer(3)
    assert longer.iterations == 6000
    assert np.array_equal(longer.temperatures, short.temperatures)
    assert np.array_equal(longer.widths, short.widths)
    assert Annealing.paper().longer(2).stop_below == 0.03


def test_a_stage_has_a_temperature_and_a_width() -> None:
    with pytest.raises(ValueError, match="widths"):
        Annealing(temperatures=[0.2, 0.1], widths=[1.0], stage_iterations=5)
    annealing = Annealing(temperatures=[0.2, 0.1], widths=[2.0, 1.0], stage_iterations=5)
    assert annealing.iterations == 10
    with pytest.raises(ValueError, match="read-only"):
        annealing.temperatures[0] = 9.0
