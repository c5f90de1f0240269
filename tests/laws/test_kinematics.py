"""What must hold of any body in any pose."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from studykit.motion import energy, kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import AIST_BODY, NEUTRAL_BODY, Skeleton

SEEDS = st.integers(0, 10_000)


def random_motion(seed: int, frames: int = 6, skeleton: Skeleton = NEUTRAL_BODY) -> Motion:
    rng = np.random.default_rng(seed)
    return Motion(
        skeleton=skeleton,
        rotations=rotation.exp(rng.normal(scale=0.7, size=(frames, 24, 3))),
        root_positions=rng.normal(size=(frames, 3)),
        frame_rate_hz=30.0,
    )


@given(seed=SEEDS, skeleton=st.sampled_from([NEUTRAL_BODY, AIST_BODY]))
@settings(deadline=None)
def test_bones_keep_their_length(seed: int, skeleton: Skeleton) -> None:
    positions = kinematics.joint_positions(random_motion(seed, skeleton=skeleton))
    bones = positions[:, 1:] - positions[:, skeleton.parents[1:]]
    assert np.linalg.norm(bones, axis=-1) == pytest.approx(
        np.tile(skeleton.bone_lengths[1:], (len(positions), 1)), abs=1e-12
    )


@given(seed=SEEDS)
@settings(deadline=None)
def test_local_rotations_undo_global_ones(seed: int) -> None:
    motion = random_motion(seed)
    world = kinematics.global_rotations(NEUTRAL_BODY, motion.rotations)
    assert kinematics.local_rotations(NEUTRAL_BODY, world) == pytest.approx(motion.rotations, abs=1e-12)


@given(seed=SEEDS, angle=st.floats(-7.0, 7.0), about=arrays(np.float64, 3, elements=st.floats(-5.0, 5.0)))
@settings(deadline=None)
def test_turning_a_motion_turns_its_joints(seed: int, angle: float, about: np.ndarray) -> None:
    motion = random_motion(seed)
    turned = kinematics.turned(motion, angle, about=about)
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])  # +Z towards +X
    expected = (kinematics.joint_positions(motion) - about) @ matrix.T + about
    assert kinematics.joint_positions(turned) == pytest.approx(expected, abs=1e-9)
    back = kinematics.turned(turned, -angle, about=about)
    assert kinematics.joint_positions(back) == pytest.approx(kinematics.joint_positions(motion), abs=1e-9)


@given(seed=SEEDS, angle=st.floats(-7.0, 7.0), shift=arrays(np.float64, 3, elements=st.floats(-9.0, 9.0)))
@settings(deadline=None)
def test_energy_knows_neither_place_nor_direction(seed: int, angle: float, shift: np.ndarray) -> None:
    motion = random_motion(seed)
    moved = kinematics.turned(motion, angle, about=shift)
    moved = Motion(
        skeleton=moved.skeleton,
        rotations=moved.rotations,
        root_positions=moved.root_positions + shift,
        frame_rate_hz=moved.frame_rate_hz,
    )
    for before, after in (
        (
            energy.linear_energy(kinematics.joint_positions(motion), 30.0),
            energy.linear_energy(kinematics.joint_positions(moved), 30.0),
        ),
        (energy.rotational_energy(motion.rotations, 30.0), energy.rotational_energy(moved.rotations, 30.0)),
    ):
        assert after == pytest.approx(before, rel=1e-9, abs=1e-12)


def test_energy_that_forgot_to_turn_a_frame_would_be_noticed() -> None:
    motion = random_motion(1)
    rotations = np.array(motion.rotations)
    rotations[:3, 0] = rotation.multiply(rotation.yaw(0.1), rotations[:3, 0])
    assert energy.rotational_energy(rotations, 30.0).sum() != pytest.approx(
        energy.rotational_energy(motion.rotations, 30.0).sum(), rel=1e-6
    )


@given(angle=st.floats(-3.1, 3.1), turn=st.floats(-3.0, 3.0))
@settings(deadline=None)
def test_facing_follows_the_turn_of_the_body(angle: float, turn: float) -> None:
    rest = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.identity(1, 24),
        root_positions=np.zeros((1, 3)),
        frame_rate_hz=30.0,
    )
    at_rest = kinematics.facing(kinematics.joint_positions(rest))
    assert at_rest == pytest.approx([0.0], abs=0.03)  # the body is not quite symmetric
    first = kinematics.turned(rest, angle)
    second = kinematics.turned(first, turn)
    change = kinematics.facing(kinematics.joint_positions(second)) - kinematics.facing(
        kinematics.joint_positions(first)
    )
    assert np.exp(1j * change) == pytest.approx(np.exp(1j * turn), abs=1e-9)


def test_a_body_that_faces_x_faces_a_quarter_turn() -> None:
    quarter = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=np.concatenate((rotation.yaw(np.pi / 2)[None, None], rotation.identity(1, 23)), axis=1),
        root_positions=np.zeros((1, 3)),
        frame_rate_hz=30.0,
    )
    positions = kinematics.joint_positions(quarter)
    toes = positions[0, NEUTRAL_BODY.index("left_foot")] - positions[0, NEUTRAL_BODY.index("left_ankle")]
    assert toes[0] > 0.1  # the feet point to +X
    assert kinematics.facing(positions) == pytest.approx([np.pi / 2], abs=0.03)


@given(angle=st.floats(-3.1, 3.1), heading=st.floats(-3.0, 3.0))
@settings(deadline=None)
def test_a_joint_is_turned_from_rest_by_its_own_rotation_alone(angle: float, heading: float) -> None:
    turns = np.zeros((2, 24, 3))
    turns[1, 5] = np.array([2.0, -1.0, 2.0]) / 3.0 * angle
    turns[:, 0, 1] = heading
    angles = kinematics.rest_angles(rotation.exp(turns) * np.array([[[1.0]], [[-1.0]]]))  # q and -q are one
    assert angles[1, 5] == pytest.approx(abs(angle), abs=1e-7)
    angles[1, 5] = 0.0
    assert np.all(angles == 0.0)  # the pelvis too, whichever way it faces
