from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studykit.analysis.smoothness import log_dimensionless_jerk, squared_jerk


def waves(seed: int, frames: int = 600) -> np.ndarray:
    rng = np.random.default_rng(seed)
    time = np.linspace(0.0, 1.0, frames)[:, None, None]
    turns, starts = rng.uniform(1.0, 6.0, size=(2, 3)), rng.uniform(0.0, 6.0, size=(2, 3))
    return np.asarray(np.sin(2.0 * np.pi * turns * time + starts))


@pytest.mark.parametrize("swings", [1, 2, 5])
def test_a_pendulum_has_the_jerk_that_calculus_says(swings: int) -> None:
    # x = cos(w t): jerk^2 averages w^6 / 2, the peak speed is w and w T = 2 pi n: -ln(T^4 w^6 / 2 / w^2).
    frames = 3000
    way = np.cos(2.0 * np.pi * swings * np.linspace(0.0, 1.0, frames))
    found = log_dimensionless_jerk(way[:, None, None] * [1.0, 0.0, 0.0], 100.0)
    assert found[0] == pytest.approx(-np.log((2.0 * np.pi * swings) ** 4 / 2.0), abs=0.01)


def test_the_smoothest_reach_has_the_published_value() -> None:
    # The minimum-jerk reach has the dimensionless jerk 720 / 1.875^2 = 204.8.
    t = np.linspace(0.0, 1.0, 4001)
    way = (10.0 * t**3 - 15.0 * t**4 + 6.0 * t**5)[:, None, None] * [0.3, 0.0, 0.1]
    assert log_dimensionless_jerk(way, 4000.0)[0] == pytest.approx(-np.log(204.8), abs=0.005)
    # With a tremor of a centimetre on it, it is far rougher.
    assert log_dimensionless_jerk(way + 0.01 * np.sin(40.0 * t)[:, None, None], 4000.0)[0] < -7.0


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**32 - 1), st.floats(0.1, 10.0), st.floats(10.0, 120.0))
def test_neither_size_nor_tempo_nor_place_counts(seed: int, size: float, rate: float) -> None:
    way = waves(seed)
    np.testing.assert_allclose(
        log_dimensionless_jerk(size * way + 3.0, rate), log_dimensionless_jerk(way, 30.0), rtol=1e-7
    )


def test_trembling_is_rougher_and_can_be_taken_off() -> None:
    rng = np.random.default_rng(0)
    way, noise = waves(1), 2e-6 * rng.normal(size=(600, 2, 3))
    still = 2e-6 * rng.normal(size=(600, 2, 3))
    true, seen = log_dimensionless_jerk(way, 30.0), log_dimensionless_jerk(way + noise, 30.0)
    corrected = log_dimensionless_jerk(way + noise, 30.0, trembling=squared_jerk(still, 30.0))
    assert (seen < true).all()
    assert (np.abs(corrected - true) < 0.25 * np.abs(seen - true)).all()


def test_what_does_not_move_has_no_smoothness() -> None:
    assert np.isnan(log_dimensionless_jerk(np.zeros((50, 1, 3)), 30.0)).all()
    still = np.random.default_rng(0).normal(size=(50, 1, 3))
    assert np.isnan(log_dimensionless_jerk(still, 30.0, trembling=2.0 * squared_jerk(still, 30.0))).all()
