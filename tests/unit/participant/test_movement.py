from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from studykit.core.seeding import stream
from studykit.participant import movement
from studykit.participant.person import cohort

PERSON = replace(cohort(1, 0)[0], height_m=1.70)
FRAMES = 960


def guide(*, metres: float, joints: int = 24) -> np.ndarray:
    """A dance of 32 s in which every joint swings with a phase of its own."""
    times_s = np.arange(FRAMES) / 30.0
    phases = np.arange(joints * 3).reshape(joints, 3)
    return 1.0 + metres * np.sin(2 * np.pi * 0.5 * times_s[:, None, None] + phases)


@pytest.mark.parametrize("metres", [0.0, 0.05, 0.5])
@pytest.mark.parametrize("error_m", [0.01, 0.12, 0.3])
@pytest.mark.parametrize("joints", [24, 15])
def test_the_error_is_as_large_as_asked_whatever_the_dance(
    metres: float, error_m: float, joints: int
) -> None:
    shown = guide(metres=metres, joints=joints)
    danced = movement.copy(shown, error_m, stream(1, "copy"), frame_rate_hz=30.0)
    assert np.linalg.norm(danced - shown, axis=-1).mean() == pytest.approx(error_m, rel=1e-9)


def test_the_same_chance_gives_the_same_error_in_every_dance() -> None:
    errors = [
        movement.copy(shown, 0.1, stream(1, "copy"), frame_rate_hz=30.0) - shown
        for shown in (guide(metres=0.0), guide(metres=0.5))
    ]
    np.testing.assert_allclose(*errors, atol=1e-12)


def test_hands_stray_further_than_the_trunk() -> None:
    shown = guide(metres=0.1)
    strays = np.linalg.norm(
        movement.copy(shown, 0.1, stream(1, "x"), frame_rate_hz=30.0) - shown, axis=-1
    ).mean(0)
    pelvis, left_hand = 0, 22
    assert strays[left_hand] > 3 * strays[pelvis]


def test_errors_are_smooth_and_independent() -> None:
    still = np.zeros((30 * 600, 24, 3))
    error = movement.copy(still, 0.1, stream(2, "copy"), frame_rate_hz=30.0)
    unit = (error - error.mean(axis=0)) / error.std(axis=0)

    def correlation(lag_frames: int) -> np.ndarray:
        return np.mean(unit[lag_frames:] * unit[: len(unit) - lag_frames], axis=0)

    # It falls to 1/e within 0.5 to 1 s: above that at 0.4 s, below it at 1.15 s.
    assert correlation(12).min() > np.exp(-1)
    assert correlation(35).max() < np.exp(-1)
    flat = unit.reshape(len(unit), -1)
    between = np.corrcoef(flat.T) - np.eye(72)
    assert np.abs(between).max() < 0.25
    assert np.abs(between).mean() < 0.05


def test_noise_that_is_not_smooth_would_be_noticed() -> None:
    jagged = stream(2, "white").normal(size=(18_000, 1))
    assert np.mean(jagged[12:] * jagged[:-12]) < np.exp(-1)


def test_the_dancer_follows_a_little_late_and_the_delay_drifts_slowly() -> None:
    for seed in range(20):
        delays = movement.delays_s(FRAMES, stream(seed, "delay"), frame_rate_hz=30.0)
        assert delays.min() >= 0.1
        assert delays.max() <= 0.3
        assert np.abs(np.diff(delays)).max() * 30.0 < 0.1  # s of delay a second
    assert np.ptp(delays) > 0.0


def test_a_delay_shows_earlier_poses() -> None:
    ramp = np.arange(100.0)[:, None, None] * np.ones((1, 2, 3))
    late = movement.delayed(ramp, np.full(100, 0.25), frame_rate_hz=30.0)
    np.testing.assert_allclose(late[:, 0, 0], np.maximum(np.arange(100.0) - 7.5, 0.0))


def test_everybody_dances_in_their_own_size() -> None:
    shown = guide(metres=0.1)
    tall = movement.own_size(shown, replace(PERSON, height_m=1.87))
    np.testing.assert_allclose(tall, 1.1 * shown)


def test_a_whole_performance_is_finite_late_and_repeatable() -> None:
    shown = guide(metres=0.3)
    danced = movement.perform(shown, PERSON, 0.05, stream(4, "perform"))
    assert danced.shape == shown.shape
    assert np.isfinite(danced).all()
    np.testing.assert_array_equal(danced, movement.perform(shown, PERSON, 0.05, stream(4, "perform")))
    lags = range(15)
    misses = [np.linalg.norm(danced[lag:] - shown[: FRAMES - lag], axis=-1).mean() for lag in lags]
    assert 3 <= int(np.argmin(misses)) <= 9
    assert min(misses) < 1.2 * 0.05
