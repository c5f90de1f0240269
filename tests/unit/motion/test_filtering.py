"""Smoothing takes trembling out, and gaps are bridged by straight lines."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import filtering

RATE = 30.0
TIMES = np.arange(300) / RATE


def wave(frequency_hz: float) -> np.ndarray:
    return np.sin(2.0 * np.pi * frequency_hz * TIMES)[:, None] * np.ones(3)


@pytest.mark.parametrize(("frequency_hz", "gain"), [(1.0, 1.0), (6.0, 0.5), (13.0, 0.0)])
def test_slow_movement_stays_and_trembling_goes(frequency_hz, gain) -> None:
    # Twice a Butterworth of second order: 1 / (1 + tan^4 / tan^4) of the amplitude.
    tangents = np.tan(np.pi * np.array([frequency_hz, 6.0]) / RATE)
    expected = 1.0 / (1.0 + (tangents[0] / tangents[1]) ** 4)
    assert expected == pytest.approx(gain, abs=2e-3)
    middle = slice(60, -60)
    smooth = filtering.low_pass(wave(frequency_hz), 6.0, RATE)[middle]
    assert smooth == pytest.approx(expected * wave(frequency_hz)[middle], abs=2e-3)  # no delay either


def test_gaps_are_bridged_on_an_even_grid() -> None:
    times = np.array([0.0, 0.1, 0.3, 0.4])
    positions = np.zeros((4, 2, 3))
    positions[:, 0, 0] = times * 2.0
    positions[2, 0] = np.nan
    positions[:, 1] = np.nan
    filled = filtering.without_gaps(times, positions, np.arange(5) / 10.0)
    assert filled[:, 0, 0] == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8])
    assert np.all(np.isnan(filled[:, 1]))
