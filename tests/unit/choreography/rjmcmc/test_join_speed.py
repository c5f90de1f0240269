from __future__ import annotations

import numpy as np
import pytest

from studykit.choreography.rjmcmc.join_speed import join_peak
from studykit.motion import kinematics, rotation
from studykit.motion.blending import joined
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY

FRAMES = 20


def segment(rotations: np.ndarray) -> Motion:
    root = np.tile([0.0, 0.9, 0.0], (len(rotations), 1))
    return Motion(skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=root, frame_rate_hz=30.0)


def any_turns(rng: np.random.Generator) -> np.ndarray:
    turns = rng.normal(size=(FRAMES, 24, 4))
    return turns / np.linalg.norm(turns, axis=-1, keepdims=True)


def danced_turns(rng: np.random.Generator, *, rate: float = 4.0) -> np.ndarray:
    """Poses anywhere, from which joints swing smoothly; quaternions of either sign."""
    phase = np.arange(FRAMES)[:, None, None] / 30.0
    swings = rng.normal(scale=0.4, size=(24, 3)) * np.sin(rate * phase + rng.uniform(0.0, 6.0, (24, 3)))
    poses = rotation.exp(rng.normal(scale=0.8, size=(24, 3)))
    return rotation.multiply(poses, rotation.exp(swings)) * rng.choice([-1.0, 1.0], size=(FRAMES, 24, 1))


def peaks_of_the_blend(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Peak speed of each joint over the steps that the blend of whole bodies changes, shape (24,)."""
    speeds = kinematics.angular_speeds(joined([segment(first), segment(second)]).rotations, 30.0)
    return speeds[FRAMES - 6 : FRAMES + 5].max(axis=0)


def peaks(first: np.ndarray, second: np.ndarray) -> list[float]:
    return [join_peak(first[-7:, joint], second[:7, joint]) for joint in range(24)]


@pytest.mark.parametrize("turns", [any_turns, danced_turns])
@pytest.mark.parametrize("seed", range(10))
def test_a_joint_peaks_as_in_the_blend_of_the_whole_body(turns, seed) -> None:
    rng = np.random.default_rng(seed)
    first, second = turns(rng), turns(rng)
    found, expected = peaks(first, second), peaks_of_the_blend(first, second)
    # All but the pelvis, whose heading is brought in line before.
    assert found[1:] == pytest.approx(expected[1:], abs=1e-9)


def test_a_joint_that_rests_does_not_turn() -> None:
    still = np.tile(rotation.exp(np.array([0.3, -0.2, 1.0])), (7, 1))
    assert join_peak(still, still) == pytest.approx(0.0, abs=1e-7)
    assert join_peak(still, -still) == pytest.approx(0.0, abs=1e-7)


def test_the_frames_further_away_do_not_matter() -> None:
    rng = np.random.default_rng(5)
    first, second = danced_turns(rng)[:, 18], danced_turns(rng)[:, 18]
    assert join_peak(first[-6:], second[:6]) == join_peak(first, second)


def test_forgetting_speeds_would_be_noticed() -> None:
    # Wrong: the gap of places spread by a smooth step, the gap of speeds forgotten.
    rng = np.random.default_rng(3)
    first, second = danced_turns(rng, rate=8.0), danced_turns(rng, rate=8.0)
    gap = rotation.between(first[-1], second[0])
    near = 1.0 - (np.arange(5) + 0.5) / 5
    share = 0.5 * near**2 * (3.0 - 2.0 * near)
    wrong = np.concatenate((first[-6:], second[:6]))
    turn = np.concatenate((share[::-1], -share))[:, None, None] * gap
    wrong[1:-1] = rotation.multiply(wrong[1:-1], rotation.exp(turn))
    off = kinematics.angular_speeds(wrong, 30.0).max(axis=0) - peaks_of_the_blend(first, second)
    assert np.median(np.abs(off[1:])) > 0.1
