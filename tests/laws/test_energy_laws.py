"""Laws of energy: where the world lies and which way it is turned is nobody's effort."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studykit.motion import energy, kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY

metres = st.floats(-50.0, 50.0)
angles = st.floats(-10.0, 10.0)


def wandering(seed: int) -> Motion:
    rng = np.random.default_rng(seed)
    turns = rng.normal(scale=0.4, size=(1, 24, 3)) + np.cumsum(
        rng.normal(scale=0.05, size=(30, 24, 3)), axis=0
    )
    return Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.exp(turns),
        root_positions=np.cumsum(rng.normal(scale=0.02, size=(30, 3)), axis=0),
        frame_rate_hz=30.0,
    )


def energies(motion: Motion, *, centred: bool = True) -> np.ndarray:
    positions = kinematics.joint_positions(motion)
    if centred:
        positions = positions - positions[:, :1]
    return np.stack(
        (
            energy.linear_energy(positions, motion.frame_rate_hz),
            energy.rotational_energy(motion.rotations, motion.frame_rate_hz),
        )
    )


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 1000), x=metres, y=metres, z=metres, angle=angles)
def test_turning_and_moving_the_world_changes_no_energy(seed, x, y, z, angle) -> None:
    motion = wandering(seed)
    moved = kinematics.turned(motion, angle, about=np.array([x, 0.0, z]))
    moved = Motion(
        skeleton=moved.skeleton,
        rotations=moved.rotations,
        root_positions=moved.root_positions + np.array([x, y, z]),
        frame_rate_hz=moved.frame_rate_hz,
    )
    assert energies(moved) == pytest.approx(energies(motion), rel=1e-9)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000), speed=st.floats(0.5, 5.0))
def test_a_dancer_carried_along_spends_nothing_more(seed, speed) -> None:
    motion = wandering(seed)
    way = speed * np.arange(len(motion))[:, None] / 30.0 * np.array([1.0, 0.0, 0.0])
    carried = Motion(
        skeleton=motion.skeleton,
        rotations=motion.rotations,
        root_positions=motion.root_positions + way,
        frame_rate_hz=30.0,
    )
    assert energies(carried) == pytest.approx(energies(motion), rel=1e-9)
    # Wrong: positions in the world instead of from the pelvis.
    assert energies(carried, centred=False)[0].sum() > 1.1 * energies(motion)[0].sum()


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000), factor=st.sampled_from([0.5, 2.0, 3.0]))
def test_the_same_steps_in_less_time_ask_for_its_square(seed, factor) -> None:
    motion = wandering(seed)
    faster = Motion(
        skeleton=motion.skeleton,
        rotations=motion.rotations,
        root_positions=motion.root_positions,
        frame_rate_hz=30.0 * factor,
    )
    assert energies(faster) == pytest.approx(factor**2 * energies(motion), rel=1e-9)
