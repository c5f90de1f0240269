"""Motions at another frame rate keep their moments."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from studykit.motion import energy, rotation
from studykit.motion.motion import Motion
from studykit.motion.resampling import resampled
from studykit.motion.skeleton import NEUTRAL_BODY


def turning(frames: int, rate: float, *, spin: float = 2.0) -> Motion:
    """Give a body that turns and walks evenly, so that every moment is known."""
    times = np.arange(frames) / rate
    rotations = rotation.identity(frames, 24)
    rotations[:, 0] = rotation.yaw(spin * times)
    rotations[:, 18] = rotation.exp(times[:, None] * np.array([0.3, -0.2, 0.9]))
    return Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotations,
        root_positions=times[:, None] * np.array([1.0, 0.0, -0.5]),
        frame_rate_hz=rate,
    )


@pytest.mark.parametrize("rate", [120.0, 60.0, 25.0, 100.0, 48.0])
@pytest.mark.parametrize("frames", [2, 61, 240, 601])
def test_frames_lie_at_exactly_k_thirtieths(rate, frames) -> None:
    motion = turning(frames, rate)
    at_30 = resampled(motion, 30.0)
    # As many as fit between the first and the last frame, none made up.
    assert len(at_30) == int((frames - 1) / rate * 30.0 + 1e-9) + 1
    times = np.arange(len(at_30)) / 30.0
    assert at_30.root_positions == pytest.approx(times[:, None] * np.array([1.0, 0.0, -0.5]), abs=1e-12)
    difference = rotation.between(rotation.yaw(2.0 * times), at_30.rotations[:, 0])
    assert difference == pytest.approx(np.zeros((len(times), 3)), abs=1e-12)
    assert at_30.frame_rate_hz == 30.0


@pytest.mark.parametrize("rate", [120.0, 60.0, 90.0])
def test_a_whole_multiple_is_thinned_out_and_nothing_else(rate) -> None:
    motion, step = turning(241, rate), int(rate / 30.0)
    at_30 = resampled(motion, 30.0)
    assert at_30.rotations == pytest.approx(motion.rotations[::step], abs=1e-15)
    assert at_30.root_positions == pytest.approx(motion.root_positions[::step], abs=1e-15)


@pytest.mark.parametrize(
    ("rate", "step"), [(29.97, 1), (59.94, 2), (1 / 0.03333333, 1), (1 / 0.0083333, 4), (119.88, 4)]
)
def test_nearly_a_multiple_is_thinned_out_too_and_no_last_frame_is_lost(rate, step) -> None:
    motion = turning(1200 * step, rate)
    at_30 = resampled(motion, 30.0)
    assert len(at_30) == 1200
    assert at_30.rotations == pytest.approx(motion.rotations[::step], abs=1e-15)
    assert at_30.frame_rate_hz == 30.0


def test_trembling_is_not_lost_by_a_rate_that_is_nearly_right() -> None:
    # Interpolated, frames between two moments would be averages: a beat of 33 s in the energy at 29.97 Hz.
    rng = np.random.default_rng(0)
    trembling = turning(1000, 29.97)
    rotations = rotation.multiply(
        trembling.rotations, rotation.exp(rng.normal(scale=0.005, size=(1000, 24, 3)))
    )
    at_30 = resampled(replace(trembling, rotations=rotations), 30.0)
    energies = energy.rotational_energy_steps(at_30.rotations, 30.0)[:, 20]
    parts = energies[: 8 * 124].reshape(8, 124).sum(axis=1)
    assert parts.min() > 0.7 * parts.max()
    assert parts.sum() == pytest.approx(energy.rotational_energy_steps(rotations, 30.0)[: 8 * 124, 20].sum())


def test_halfway_is_halfway_along_the_shortest_arc() -> None:
    rotations = rotation.identity(2, 24)
    # The second quaternion has the other sign: a careless average would go the long way round.
    rotations[1, 5] = -rotation.exp(np.array([1.2, 0.0, 0.0]))
    motion = Motion(
        skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=[[0, 0, 0], [0, 0, 1]], frame_rate_hz=15.0
    )
    halfway = resampled(motion, 30.0)
    assert rotation.log(halfway.rotations[1, 5]) == pytest.approx([0.6, 0.0, 0.0], abs=1e-12)
    assert halfway.root_positions[1] == pytest.approx([0.0, 0.0, 0.5])


def test_averaging_quaternions_would_be_noticed() -> None:
    start, end = rotation.identity(1)[0], rotation.exp(np.array([0.0, 2.5, 0.0]))
    straight = 0.75 * start + 0.25 * end
    straight /= np.linalg.norm(straight)
    quarter = rotation.slerp(start, end, np.array(0.25))
    assert rotation.log(quarter)[1] == pytest.approx(0.625)
    assert abs(rotation.log(straight)[1] - 0.625) > 0.03


def test_nothing_changes_at_the_same_rate_or_in_one_frame() -> None:
    motion = turning(10, 30.0)
    assert np.array_equal(resampled(motion, 30.0).rotations, motion.rotations)
    assert len(resampled(turning(1, 120.0), 30.0)) == len(resampled(turning(1, 100.0), 30.0)) == 1
