from __future__ import annotations

import numpy as np
import pytest

from studykit.core.seeding import stream
from studykit.motion.skeleton import JOINT_NAMES
from studykit.participant import movement

FRAMES = 960


def test_wrong_turns_are_smooth_and_independent() -> None:
    turns = movement.wrong_turns(JOINT_NAMES, 30 * 600, stream(2, "copy"), frame_rate_hz=30.0)
    moving = turns[:, turns.std(axis=(0, 2)) > 0.0]
    unit = (moving - moving.mean(axis=0)) / moving.std(axis=0)

    def correlation(lag_frames: int) -> np.ndarray:
        return np.mean(unit[lag_frames:] * unit[: len(unit) - lag_frames], axis=0)

    # It falls to 1/e within 0.5 to 1 s: above that at 0.4 s, below it at 1.15 s.
    assert correlation(12).min() > np.exp(-1)
    assert correlation(35).max() < np.exp(-1)
    flat = unit.reshape(len(unit), -1)
    between = np.corrcoef(flat.T) - np.eye(flat.shape[1])
    assert flat.shape[1] == 20 * 3
    assert np.abs(between).max() < 0.25
    assert np.abs(between).mean() < 0.05
    shoulder = turns[:, JOINT_NAMES.index("left_shoulder")]
    assert np.mean(np.sum(shoulder**2, axis=-1)) == pytest.approx(1.0)


def test_noise_that_is_not_smooth_would_be_noticed() -> None:
    jagged = stream(2, "white").normal(size=(18_000, 1))
    assert np.mean(jagged[12:] * jagged[:-12]) < np.exp(-1)


def test_the_trunk_is_turned_less_wrong_than_arms_and_legs() -> None:
    turns = movement.wrong_turns(JOINT_NAMES, FRAMES, stream(1, "x"), frame_rate_hz=30.0)
    rms = dict(zip(JOINT_NAMES, np.sqrt(np.mean(np.sum(turns**2, axis=-1), axis=0)), strict=True))
    assert (rms["left_shoulder"], rms["right_elbow"]) == pytest.approx((1.0, 1.0))
    limbs = [rms[f"{side}_{joint}"] for side in ("left", "right") for joint in ("hip", "knee", "shoulder")]
    assert rms["pelvis"] < rms["spine2"] < rms["neck"] < rms["left_wrist"] < min(limbs)


def test_the_dancer_follows_a_little_late_and_the_delay_drifts_slowly() -> None:
    for seed in range(20):
        delays = movement.delays_s(FRAMES, stream(seed, "delay"), frame_rate_hz=30.0)
        assert delays.min() >= 0.1
        assert delays.max() <= 0.3
        assert np.abs(np.diff(delays)).max() * 30.0 < 0.1  # s of delay a second
    assert np.ptp(delays) > 0.0
