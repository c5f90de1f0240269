"""Which joint of a foreign skeleton drives which joint of SMPL."""

from __future__ import annotations

import numpy as np

from studykit.core.errors import InputError
from studykit.io.skeletal_take import SkeletalTake
from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY

SkeletonMap = dict[str, str]
"""SMPL joint to foreign joint; a joint left out moves with its parent."""


def _both_sides(joints: dict[str, str]) -> SkeletonMap:
    """Write out a map in which {side}, {s} and {Side} stand for left and right."""
    out: SkeletonMap = {}
    for smpl, foreign in joints.items():
        if "{" in smpl:
            for side in ("left", "right"):
                out[smpl.format(side=side)] = foreign.format(s=side[0], Side=side.capitalize())
        else:
            out[smpl] = foreign
    return out


SKELETON_MAPS: dict[str, SkeletonMap] = {
    # "Daz-friendly" CMU conversion; collars and toes were not captured.
    "daz": _both_sides(
        {
            "pelvis": "hip",
            "{side}_hip": "{s}Thigh",
            "spine1": "abdomen",
            "{side}_knee": "{s}Shin",
            "{side}_ankle": "{s}Foot",
            "spine3": "chest",
            "neck": "neck",
            "head": "head",
            "{side}_collar": "{s}Collar",
            "{side}_shoulder": "{s}Shldr",
            "{side}_elbow": "{s}ForeArm",
            "{side}_wrist": "{s}Hand",
        }
    ),
    "neo": _both_sides(
        {
            "pelvis": "Hips",
            "{side}_hip": "{Side}UpLeg",
            "spine1": "Spine",
            "{side}_knee": "{Side}Leg",
            "spine2": "Spine1",
            "{side}_ankle": "{Side}Foot",
            "spine3": "Spine2",
            "{side}_foot": "{Side}ToeBase",
            "neck": "Neck",
            "head": "Head",
            "{side}_collar": "{Side}Shoulder",
            "{side}_shoulder": "{Side}Arm",
            "{side}_elbow": "{Side}ForeArm",
            "{side}_wrist": "{Side}Hand",
        }
    ),
    "smpl": {name: name for name in NEUTRAL_BODY.joint_names},
}
"""Skeletons whose zero pose is a T-pose with SMPL's axes, so that rotations carry over."""


def to_smpl(take: SkeletalTake, skeleton: str, *, units_m: float) -> Motion:
    """Carry a take over to SMPL's body.

    Every bone of SMPL is turned, against its T-pose, as the foreign bone that drives it is turned against
    its own. The way of the root is scaled by the length of the legs, so that feet slide little.

    Parameters
    ----------
    take : SkeletalTake
        What was read.
    skeleton : str
        A key of `SKELETON_MAPS`.
    units_m : float
        The file's unit of length, in metres.

    Raises
    ------
    InputError
        If the file lacks a joint of the map or the map is unknown.
    """
    if skeleton not in SKELETON_MAPS:
        known = ", ".join(SKELETON_MAPS)
        raise InputError(
            f"no skeleton map called {skeleton!r}", where=take.path, remedy=f"choose one of {known}"
        )
    joints = SKELETON_MAPS[skeleton]
    missing = sorted(set(joints.values()) - set(take.joint_names))
    if missing:
        remedy = f"choose the skeleton that fits ({', '.join(SKELETON_MAPS)})"
        raise InputError(
            f"has no joint {missing[0]!r} of the {skeleton} skeleton", where=take.path, remedy=remedy
        )

    foreign = np.array(take.rotations)
    for joint, parent in enumerate(take.parents):
        if parent >= 0:
            foreign[:, joint] = rotation.multiply(foreign[:, parent], take.rotations[:, joint])
    world = rotation.identity(len(foreign), len(NEUTRAL_BODY.joint_names))
    for joint, (name, parent) in enumerate(zip(NEUTRAL_BODY.joint_names, NEUTRAL_BODY.parents, strict=True)):
        world[:, joint] = (
            foreign[:, take.joint_names.index(joints[name])] if name in joints else world[:, parent]
        )
    return Motion(
        skeleton=NEUTRAL_BODY,
        rotations=kinematics.local_rotations(NEUTRAL_BODY, world),
        root_positions=take.root_positions * units_m * _leg_ratio(take, joints, units_m),
        frame_rate_hz=take.frame_rate_hz,
    )


def _leg_ratio(take: SkeletalTake, joints: SkeletonMap, units_m: float) -> float:
    """Length of our leg over the length of theirs, thigh and shank."""
    theirs = sum(
        float(np.linalg.norm(take.offsets[take.joint_names.index(joints[name])]))
        for name in ("left_knee", "left_ankle")
    )
    bones = NEUTRAL_BODY.bone_lengths
    ours = float(bones[NEUTRAL_BODY.index("left_knee")] + bones[NEUTRAL_BODY.index("left_ankle")])
    return ours / (theirs * units_m)
