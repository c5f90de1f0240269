"""Turns found from positions put every joint back where it was."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from studykit.library import joint_limit
from studykit.motion import kinematics, rotation
from studykit.motion.inverse_kinematics import rotations_from_positions
from studykit.motion.skeleton import AIST_BODY, NEUTRAL_BODY


def possible_poses(count: int) -> np.ndarray:
    """Give poses anywhere within the limits of a person's joints, facing anywhere."""
    rng = np.random.default_rng(11)
    rotations = joint_limit.rotations(rng.uniform(joint_limit.LOW, joint_limit.HIGH, size=(count, 24, 3)))
    rotations[:, 0] = rotation.exp(rng.normal(scale=1.5, size=(count, 3)))
    return rotations


@pytest.mark.parametrize("skeleton", [NEUTRAL_BODY, AIST_BODY])
def test_every_joint_is_put_back(skeleton) -> None:
    positions = kinematics.centred_positions(skeleton, possible_poses(200))
    found = rotations_from_positions(positions + np.array([3.0, 1.0, -2.0]), skeleton)
    assert np.abs(kinematics.centred_positions(skeleton, found) - positions).max() < 1e-6


def test_only_directions_matter() -> None:
    positions = kinematics.centred_positions(NEUTRAL_BODY, possible_poses(20))
    assert rotations_from_positions(1.2 * positions) == pytest.approx(rotations_from_positions(positions))


def test_the_rest_pose_needs_no_turn() -> None:
    rest = kinematics.centred_positions(NEUTRAL_BODY, rotation.identity(1, 24))
    assert rotation.log(rotations_from_positions(rest)) == pytest.approx(np.zeros((1, 24, 3)), abs=1e-7)


def test_pelvis_and_chest_are_found_as_they_were_turned() -> None:
    # Joints with three bones leave nothing open.
    rotations = possible_poses(50)
    positions = kinematics.centred_positions(NEUTRAL_BODY, rotations)
    world, found = (
        kinematics.global_rotations(NEUTRAL_BODY, r) for r in (rotations, rotations_from_positions(positions))
    )
    for joint in (0, NEUTRAL_BODY.index("spine3")):
        assert rotation.between(world[:, joint], found[:, joint]) == pytest.approx(
            np.zeros((50, 3)), abs=1e-6
        )


def test_bones_that_do_not_fit_are_turned_as_well_as_can_be() -> None:
    # A camera's noise can turn three bones inside out; a body never is.
    rng = np.random.default_rng(6)
    positions = rng.normal(scale=0.3, size=(100, 24, 3))
    found = rotations_from_positions(positions)[:, 0]
    children = NEUTRAL_BODY.children(0)
    rest, seen = NEUTRAL_BODY.offsets[list(children)], positions[:, list(children)] - positions[:, :1]
    rest = rest / np.linalg.norm(rest, axis=-1, keepdims=True)
    seen = seen / np.linalg.norm(seen, axis=-1, keepdims=True)
    for frame in range(100):
        best = Rotation.align_vectors(seen[frame], rest)[0].as_quat(scalar_first=True)
        assert rotation.log(rotation.multiply(rotation.inverse(best), found[frame])) == pytest.approx(
            np.zeros(3), abs=1e-5
        )


def test_an_arm_that_points_the_opposite_way() -> None:
    rotations = rotation.identity(1, 24)
    across = np.cross(NEUTRAL_BODY.offsets[NEUTRAL_BODY.index("left_elbow")], [0.0, 0.0, 1.0])
    rotations[:, NEUTRAL_BODY.index("left_shoulder")] = rotation.exp(np.pi * across / np.linalg.norm(across))
    positions = kinematics.centred_positions(NEUTRAL_BODY, rotations)
    found = kinematics.centred_positions(NEUTRAL_BODY, rotations_from_positions(positions))
    assert found == pytest.approx(positions, abs=1e-6)


def test_a_trembling_camera_turns_no_short_bone() -> None:
    rest = kinematics.centred_positions(NEUTRAL_BODY, rotation.identity(300, 24))
    seen = rest + np.random.default_rng(3).normal(scale=0.005, size=rest.shape)
    chest = NEUTRAL_BODY.index("spine3")

    def trembling(shortest_bone_m: float) -> float:
        found = rotations_from_positions(seen, shortest_bone_m=shortest_bone_m)
        return float(np.linalg.norm(rotation.log(found[:, chest]), axis=-1).mean())

    assert trembling(0.08) < 0.7 * trembling(0.0)
