"""SMPL's joints from COCO's points: what is seen stays where it is seen, whichever way the dancer stands."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import kinematics, rotation
from studykit.motion.coco_body import COCO_JOINTS, body_from_coco
from studykit.motion.motion import Motion
from studykit.motion.plausibility import implausible
from studykit.motion.skeleton import AIST_BODY, JOINT_NAMES

AT = {name: number for number, name in enumerate(JOINT_NAMES)}
FACE = {
    "nose": (0.0, 0.05, 0.11),
    "left_eye": (0.03, 0.05, 0.11),
    "right_eye": (-0.03, 0.05, 0.11),
    "left_ear": (0.075, 0.05, 0.0),
    "right_ear": (-0.075, 0.05, 0.0),
}


def points_of(motion: Motion) -> np.ndarray:
    joints = kinematics.joint_positions(motion)
    head = kinematics.global_rotations(motion.skeleton, motion.rotations)[:, AT["head"]]
    return np.stack(
        [
            joints[:, AT["head"]] + rotation.rotate(head, np.array(FACE[name]))
            if name in FACE
            else joints[:, AT[name]]
            for name in COCO_JOINTS
        ],
        axis=1,
    )


def dancer(**turns: tuple[float, float, float]) -> Motion:
    """Give five frames of a body at rest but for some joints, which turn further from frame to frame."""
    vectors = np.zeros((5, 24, 3))
    for name, turn in turns.items():
        vectors[:, AT[name]] = np.linspace(0.5, 1.0, 5)[:, None] * np.array(turn)
    return Motion(
        skeleton=AIST_BODY,
        rotations=rotation.exp(vectors),
        root_positions=np.tile([0.3, 1.0, -0.2], (5, 1)),
        frame_rate_hz=60.0,
    )


def turns_deg(found: Motion, expected: Motion) -> dict[str, float]:
    away = np.linalg.norm(rotation.between(expected.rotations, found.rotations), axis=-1)
    return dict(zip(JOINT_NAMES, np.degrees(away.max(axis=0)), strict=True))


def test_a_body_at_rest_is_found_at_rest() -> None:
    rest = dancer()
    found = body_from_coco(points_of(rest), frame_rate_hz=60.0)
    assert max(turns_deg(found, rest).values()) < 1.5  # the twist of a straight leg cannot be seen
    away = kinematics.joint_positions(found) - kinematics.joint_positions(rest)
    assert np.linalg.norm(away, axis=-1).max() < 5e-3


@pytest.mark.parametrize("turn", [(0.0, 2.5, 0.0), (1.2, 0.0, 0.0), (0.7, -1.0, 2.0)])
def test_turning_the_dancer_turns_the_pelvis_alone(turn: tuple[float, float, float]) -> None:
    moving = dancer(left_knee=(1.2, 0, 0), right_elbow=(0, 1.3, 0), left_elbow=(0, -1.0, 0), head=(0, 0.6, 0))
    here = body_from_coco(points_of(moving), frame_rate_hz=60.0)
    whole = rotation.exp(np.array(turn))
    there = body_from_coco(rotation.rotate(whole, points_of(moving)), frame_rate_hz=60.0)
    np.testing.assert_allclose(
        np.abs(np.sum(there.rotations[:, 1:] * here.rotations[:, 1:], axis=-1)), 1.0, atol=1e-6
    )
    expected = rotation.multiply(whole, here.rotations[:, 0])
    np.testing.assert_allclose(np.abs(np.sum(there.rotations[:, 0] * expected, axis=-1)), 1.0, atol=1e-9)


def test_bends_are_found_where_they_are() -> None:
    bent = dancer(left_knee=(1.4, 0, 0), right_hip=(-0.8, 0, 0), right_elbow=(0, 1.3, 0))
    found = body_from_coco(points_of(bent), frame_rate_hz=60.0)
    away = turns_deg(found, bent)
    # Thigh and shank share a twist that points alone do not fix to the last degree.
    assert max(away[name] for name in ("left_knee", "right_hip", "right_elbow", "left_hip")) < 10.0
    joints = kinematics.joint_positions(found)
    seen = [AT[name] for name in COCO_JOINTS if name not in FACE]
    theirs = kinematics.joint_positions(bent)
    assert np.linalg.norm(joints - theirs, axis=-1)[:, seen].max() < 2e-3
    assert implausible(found) is None


def test_a_head_that_turns_is_shared_with_the_neck() -> None:
    looking = dancer(head=(0.0, 1.0, 0.0))
    found = body_from_coco(points_of(looking), frame_rate_hz=60.0)
    world = kinematics.global_rotations(found.skeleton, found.rotations)[:, AT["head"]]
    theirs = kinematics.global_rotations(looking.skeleton, looking.rotations)[:, AT["head"]]
    assert np.degrees(np.linalg.norm(rotation.between(theirs, world), axis=-1).max()) < 1.0


def test_sizes_carry_over() -> None:
    rest = dancer()
    child = body_from_coco(0.7 * points_of(rest), frame_rate_hz=60.0)
    np.testing.assert_allclose(child.skeleton.bone_lengths, 0.7 * AIST_BODY.bone_lengths, atol=1e-3)


def test_swapped_sides_would_be_noticed() -> None:
    """Wrong: left and right exchanged, so that the dancer faces backwards and the knees bend forwards."""
    moving = dancer(left_knee=(1.4, 0, 0), right_knee=(1.4, 0, 0))
    points = points_of(Motion(
        skeleton=AIST_BODY,
        rotations=np.tile(moving.rotations, (4, 1, 1)),
        root_positions=np.tile(moving.root_positions, (4, 1)),
        frame_rate_hz=60.0,
    ))  # fmt: skip
    swapped = [
        COCO_JOINTS.index(
            name.replace("left", "x").replace("right", "left").replace("x", "right") if "_" in name else name
        )
        for name in COCO_JOINTS
    ]
    found = body_from_coco(points[:, swapped], frame_rate_hz=60.0)
    straight = body_from_coco(points, frame_rate_hz=60.0)
    ahead = rotation.rotate(straight.rotations[0, 0], np.array([0.0, 0.0, 1.0]))
    behind = rotation.rotate(found.rotations[0, 0], np.array([0.0, 0.0, 1.0]))
    assert ahead[2] > 0.9
    assert behind[2] < -0.9
