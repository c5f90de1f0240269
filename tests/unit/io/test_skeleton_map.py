"""Takes of foreign skeletons move SMPL's body the same way."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io.skeletal_take import SkeletalTake
from studykit.io.skeleton_map import skeleton_map, skeleton_names, to_smpl
from studykit.motion import kinematics, rotation
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY

# A daz figure to the thighs and up to the neck, with a buttock between hip and thigh that SMPL lacks.
DAZ = (
    ("hip", -1, (0, 0, 0)),
    ("abdomen", 0, (0, 20, 0)),
    ("chest", 1, (0, 12, 0)),
    ("neck", 2, (0, 22, 0)),
    ("head", 3, (0, 7, 0)),
    *(
        joint
        for side, sign, first in (("l", 1, 5), ("r", -1, 13))
        for joint in (
            (f"{side}Buttock", 0, (sign * 8, 0, 0)),
            (f"{side}Thigh", first, (0, -5, 0)),
            (f"{side}Shin", first + 1, (0, -40, 0)),
            (f"{side}Foot", first + 2, (0, -42, 0)),
            (f"{side}Collar", 2, (sign * 3, 18, 0)),
            (f"{side}Shldr", first + 4, (sign * 12, 0, 0)),
            (f"{side}ForeArm", first + 5, (sign * 28, 0, 0)),
            (f"{side}Hand", first + 6, (sign * 25, 0, 0)),
        )
    ),
)


def take(**turns: tuple[float, float, float]) -> SkeletalTake:
    """Give one frame of the figure with some joints turned (degrees about X, Y, Z)."""
    names = tuple(name for name, _, _ in DAZ)
    rotations = rotation.identity(1, len(names))
    for name, degrees in turns.items():
        rotations[0, names.index(name)] = rotation.exp(np.radians(degrees))
    return SkeletalTake(
        path=Path("made/up.bvh"),
        joint_names=names,
        parents=tuple(parent for _, parent, _ in DAZ),
        offsets=np.array([offset for _, _, offset in DAZ], dtype=float),
        rotations=rotations,
        root_positions=np.array([[0.0, 95.0, 10.0]]),
        frame_rate_hz=120.0,
    )


def joints(**turns: tuple[float, float, float]) -> dict[str, np.ndarray]:
    motion = to_smpl(take(**turns), "daz", units_m=0.01)
    return dict(
        zip(JOINT_NAMES, kinematics.centred_positions(NEUTRAL_BODY, motion.rotations)[0], strict=True)
    )


def test_the_rest_pose_is_the_rest_pose() -> None:
    rest = kinematics.centred_positions(NEUTRAL_BODY, rotation.identity(24))
    assert np.array(list(joints().values())) == pytest.approx(rest)


def test_a_bent_knee_and_a_raised_arm_stay_what_and_where_they_are() -> None:
    rest, bent = joints(), joints(lShin=(90, 0, 0), rShldr=(0, 0, -90))
    assert bent["left_ankle"][2] < bent["left_knee"][2] - 0.3  # behind
    assert bent["left_ankle"][1] == pytest.approx(bent["left_knee"][1], abs=0.05)
    assert bent["right_ankle"] == pytest.approx(rest["right_ankle"])
    assert bent["right_wrist"][1] > bent["right_shoulder"][1] + 0.4  # up
    assert bent["left_wrist"] == pytest.approx(rest["left_wrist"])


def test_joints_that_smpl_lacks_still_pass_their_turn_on() -> None:
    assert joints(lButtock=(0, 0, 40))["left_ankle"] == pytest.approx(joints(lThigh=(0, 0, 40))["left_ankle"])


def test_joints_that_the_take_lacks_move_with_their_parent() -> None:
    bent = to_smpl(take(chest=(30, 0, 0), lFoot=(20, 0, 0)), "daz", units_m=0.01)
    turned = rotation.log(bent.rotations[0])
    for name in ("spine2", "left_foot", "left_hand"):
        assert turned[NEUTRAL_BODY.index(name)] == pytest.approx(np.zeros(3), abs=1e-12)
    assert np.degrees(turned[NEUTRAL_BODY.index("spine3")]) == pytest.approx([30.0, 0.0, 0.0])


def test_the_way_is_scaled_to_our_legs_and_the_rate_stays() -> None:
    motion = to_smpl(take(), "daz", units_m=0.01)
    bones = NEUTRAL_BODY.bone_lengths
    legs = bones[NEUTRAL_BODY.index("left_knee")] + bones[NEUTRAL_BODY.index("left_ankle")]
    assert motion.root_positions[0] == pytest.approx(np.array([0.0, 0.95, 0.10]) * legs / 0.82)
    assert motion.frame_rate_hz == 120.0


@pytest.mark.parametrize("name", skeleton_names())
def test_every_map_treats_both_sides_alike(name) -> None:
    joints = skeleton_map(name).joints
    assert set(joints) <= set(JOINT_NAMES)
    assert len(set(joints.values())) == len(joints)
    for joint in joints:
        assert JOINT_NAMES[NEUTRAL_BODY.mirror[NEUTRAL_BODY.index(joint)]] in joints
        side = joint.split("_")[0]
        if side in ("left", "right"):
            foreign = joints[joint]
            assert foreign.endswith(f"_{side[0].upper()}") or foreign[0].lower() == side[0]


def test_a_skeleton_that_does_not_fit_is_named() -> None:
    with pytest.raises(InputError, match=r"made/up\.bvh: has no joint 'Head' of the neo skeleton; choose"):
        to_smpl(take(), "neo", units_m=0.01)
    with pytest.raises(
        InputError, match=r"no skeleton map called 'dax'; choose .*daz, motionbuilder, neo, smpl, or"
    ):
        to_smpl(take(), "dax", units_m=0.01)
