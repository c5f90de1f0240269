"""Which joint of a foreign skeleton drives which joint of SMPL."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, field_validator

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.io.skeletal_take import SkeletalTake
from studykit.io.toml_file import read_model
from studykit.motion import kinematics, rotation
from studykit.motion.inverse_kinematics import shortest_swing
from studykit.motion.motion import Motion
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY

LEG_LENGTHS_M = (0.4, 1.4)
"""Thigh and shank of anybody from a child of four to a giant."""
_MOST_OFF_DEG = 40.0  # how far a limb may be from SMPL's in what still is a T-pose

Degrees = Annotated[float, Field(ge=-360, le=360, allow_inf_nan=False)]


class SkeletonMap(BaseModel):
    """How the joints of a file drive the 24 joints of SMPL.

    Every bone of SMPL is turned, against its T-pose, as the foreign joint that drives it is turned against
    its own T-pose. A map of your own is a TOML file beside the recipe that names it
    (``skeleton = "mine.toml"``), or one named with ``--skeleton mine.toml``. A joint left out moves with its
    parent; where two joints of the file do the work of one (two necks, a twist bone), name the lower, which
    carries the turns of both.

    Examples
    --------
    A skeleton with arms hanging aslant at rest, two spine joints and no toes::

        t_pose = "limbs"

        [joints]
        pelvis = "Root"
        left_hip = "LThigh"
        right_hip = "RThigh"
        left_knee = "LCalf"
        right_knee = "RCalf"
        left_ankle = "LFoot"
        right_ankle = "RFoot"
        spine1 = "Spine"
        spine3 = "Chest"
        neck = "Neck"
        head = "Head"
        left_shoulder = "LUpperArm"
        right_shoulder = "RUpperArm"
        left_elbow = "LForearm"
        right_elbow = "RForearm"
        left_wrist = "LHand"
        right_wrist = "RHand"
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    joints: dict[str, str]
    """SMPL's joint to the joint of the file."""
    t_pose: Literal["zero", "limbs", "first-frame"] = "zero"
    """Where the file's T-pose is. "zero": all angles at zero, facing +Z, but for the turns below. "limbs": at
    zero, but with arms and legs spread or hanging; each limb is swung, as a straight one, to where SMPL's
    points. "first-frame": the first frame of each file, standing upright."""
    turns: dict[str, tuple[Degrees, Degrees, Degrees]] = Field(default_factory=dict)
    """How joints stand in the T-pose against the axes of the world, where they do not agree with them:
    degrees about the fixed axes X (left), then Y (up), then Z (ahead); by SMPL's joint."""

    @field_validator("joints", "turns")
    @classmethod
    def _are_smpl(cls, entries: dict[str, object]) -> dict[str, object]:
        unknown = next((name for name in entries if name not in JOINT_NAMES), None)
        if unknown is not None:
            raise InputError(
                f"SMPL has no joint {unknown!r}",
                where=unknown,
                remedy=f"choose from {', '.join(JOINT_NAMES)}",
            )
        return entries

    @field_validator("joints")
    @classmethod
    def _has_legs(cls, joints: dict[str, str]) -> dict[str, str]:
        lacking = [name for name in _NEEDED if name not in joints]
        if lacking:
            raise InputError(
                f"no joint for {lacking[0]}", remedy=f"name one for each of {', '.join(_NEEDED)}"
            )
        twice = next((one for one in joints.values() if list(joints.values()).count(one) > 1), None)
        if twice is not None:
            raise InputError(f"the joint {twice!r} stands twice", remedy="name each joint of the file once")
        return joints


_NEEDED = ("pelvis", "left_hip", "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle")


def skeleton_names() -> tuple[str, ...]:
    """Name the skeletons that studykit knows by itself."""
    folder = Path(str(files("studykit.io") / "skeletons"))
    return (*sorted(path.stem for path in folder.glob("*.toml")), "smpl")


def skeleton_map(name: str) -> SkeletonMap:
    """Give a map by its name, or from a TOML file.

    Raises
    ------
    InputError
        If there is no such map or the file has a mistake; names the line and the remedy.
    """
    if name.endswith(".toml"):
        return read_model(Path(name), SkeletonMap)
    if name not in skeleton_names():
        raise InputError(
            f"no skeleton map called {name!r}",
            remedy=f"choose {', '.join(skeleton_names())}, or name a map file that ends in .toml",
        )
    return _built_in(name)


@cache
def _built_in(name: str) -> SkeletonMap:
    if name == "smpl":
        return SkeletonMap(joints={joint: joint for joint in JOINT_NAMES})
    return read_model(Path(str(files("studykit.io") / "skeletons" / f"{name}.toml")), SkeletonMap)


def to_smpl(take: SkeletalTake, skeleton: str, *, units_m: float) -> Motion:
    """Carry a take over to SMPL's body.

    Every bone of SMPL is turned, against its T-pose, as the foreign bone that drives it is turned against
    its own. The way of the pelvis is scaled by the length of the legs, so that feet slide little.

    Parameters
    ----------
    take : SkeletalTake
        What was read.
    skeleton : str
        One of `skeleton_names`, or a map file.
    units_m : float
        The file's unit of length, in metres.

    Raises
    ------
    InputError
        If the file lacks a joint of the map, the map is unknown or nobody has legs that long.
    """
    chosen = skeleton_map(skeleton)
    joints = chosen.joints
    missing = sorted(set(joints.values()) - set(take.joint_names))
    if missing:
        remedy = f"choose the skeleton that fits ({', '.join(skeleton_names())}) or write a map file"
        raise InputError(
            f"has no joint {missing[0]!r} of the {skeleton} skeleton", where=take.path, remedy=remedy
        )
    ratio = _leg_ratio(take, joints, units_m)
    foreign = np.array(take.rotations)
    for joint, parent in enumerate(take.parents):
        if parent >= 0:
            foreign[:, joint] = rotation.multiply(foreign[:, parent], take.rotations[:, joint])
    rest = _t_pose(take, chosen, foreign)
    world = rotation.identity(len(foreign), len(JOINT_NAMES))
    for joint, (name, parent) in enumerate(zip(JOINT_NAMES, NEUTRAL_BODY.parents, strict=True)):
        if name in joints:
            driven = foreign[:, take.joint_names.index(joints[name])]
            world[:, joint] = rotation.multiply(driven, rotation.inverse(rest[joint]))
        else:
            world[:, joint] = world[:, parent]
    return Motion(
        skeleton=NEUTRAL_BODY,
        rotations=kinematics.local_rotations(NEUTRAL_BODY, world),
        root_positions=_pelvis_positions(take, joints["pelvis"], foreign) * units_m * ratio,
        frame_rate_hz=take.frame_rate_hz,
    )


def _t_pose(take: SkeletalTake, chosen: SkeletonMap, foreign: Floats) -> Floats:
    """How the driving joints stand, against the world, where SMPL is at rest, shape (joint, 4)."""
    rest = rotation.identity(len(JOINT_NAMES))
    for name, degrees in chosen.turns.items():
        rest[JOINT_NAMES.index(name)] = rotation.from_euler("ZYX", np.radians(degrees[::-1]))
    if chosen.t_pose == "first-frame":
        _check_t_pose(take, chosen.joints, foreign)
        for number, name in enumerate(JOINT_NAMES):
            if name in chosen.joints:
                rest[number] = foreign[0, take.joint_names.index(chosen.joints[name])]
    elif chosen.t_pose == "limbs":
        for limb, swing in _limb_swings(take, chosen.joints).items():
            for name in _LIMBS[limb]:
                number = JOINT_NAMES.index(name)
                rest[number] = rotation.multiply(swing, rest[number])
    return rest


_LIMBS = {
    f"{side}_{parts[0]}": tuple(f"{side}_{part}" for part in parts)
    for side in ("left", "right")
    for parts in (("hip", "knee", "ankle", "foot"), ("shoulder", "elbow", "wrist", "hand"))
}


def _limb_swings(take: SkeletalTake, joints: dict[str, str]) -> dict[str, Floats]:
    """Give the turn of each whole limb from the zero pose of a file to SMPL's rest pose."""
    theirs, ours = (
        _zero_pose(take.parents, take.offsets),
        _zero_pose(NEUTRAL_BODY.parents, NEUTRAL_BODY.offsets),
    )
    swings = {}
    for limb, (first, _, last, _) in _LIMBS.items():
        if first in joints and last in joints:
            ends = [take.joint_names.index(joints[name]) for name in (first, last)]
            start = theirs[ends[1]] - theirs[ends[0]]
            goal = ours[JOINT_NAMES.index(last)] - ours[JOINT_NAMES.index(first)]
            if not np.linalg.norm(start) > 0.0:
                raise InputError(
                    f"the joints {joints[first]!r} and {joints[last]!r} lie on one point",
                    where=take.path,
                    remedy="export the take again",
                )
            swings[limb] = shortest_swing(start, goal)
    return swings


def _zero_pose(parents: tuple[int, ...], offsets: Floats) -> Floats:
    places = np.zeros_like(offsets)
    for joint, parent in enumerate(parents):
        if parent >= 0:
            places[joint] = places[parent] + offsets[joint]
    return places


def _check_t_pose(take: SkeletalTake, joints: dict[str, str], foreign: Floats) -> None:
    """Refuse a first frame in which legs do not hang or arms do not point aside."""
    places = np.zeros_like(take.offsets)
    for joint, parent in enumerate(take.parents):
        if parent >= 0:
            places[joint] = places[parent] + rotation.rotate(foreign[0, parent], take.offsets[joint])
    rest = _zero_pose(NEUTRAL_BODY.parents, NEUTRAL_BODY.offsets)
    for first, _, last, _ in _LIMBS.values():
        if first in joints and last in joints:
            ends = [take.joint_names.index(joints[name]) for name in (first, last)]
            seen = places[ends[1]] - places[ends[0]]
            goal = rest[JOINT_NAMES.index(last)] - rest[JOINT_NAMES.index(first)]
            cosine = float(seen @ goal) / max(float(np.linalg.norm(seen) * np.linalg.norm(goal)), 1e-12)
            if cosine < np.cos(np.radians(_MOST_OFF_DEG)):
                raise InputError(
                    f"the first frame is no T-pose facing +Z ({first} to {last})",
                    where=take.path,
                    remedy='use a map with t_pose = "limbs" or "zero"',
                )


def _pelvis_positions(take: SkeletalTake, pelvis: str, foreign: Floats) -> Floats:
    """Where the pelvis is in the file's unit; what stands above it (a root on the floor) moves it along."""
    chain = [take.joint_names.index(pelvis)]
    while take.parents[chain[0]] >= 0:
        chain.insert(0, take.parents[chain[0]])
    places = np.array(take.root_positions)
    for parent, joint in pairwise(chain):
        step = take.shifts.get(joint, np.broadcast_to(take.offsets[joint], places.shape))
        places += rotation.rotate(foreign[:, parent], step)
    return places


def _leg_ratio(take: SkeletalTake, joints: dict[str, str], units_m: float) -> float:
    """Length of our left leg over the length of theirs, thigh and shank."""
    theirs = 0.0
    for upper, lower in (("left_hip", "left_knee"), ("left_knee", "left_ankle")):
        top, joint = take.joint_names.index(joints[upper]), take.joint_names.index(joints[lower])
        bone = np.zeros(3)
        while joint not in (top, -1):
            bone += take.offsets[joint]
            joint = take.parents[joint]
        if joint == -1:
            raise InputError(
                f"the joint {joints[lower]!r} does not hang on {joints[upper]!r}",
                where=take.path,
                remedy="choose the skeleton that fits, or correct the map",
            )
        theirs += float(np.linalg.norm(bone)) * units_m
    if not LEG_LENGTHS_M[0] <= theirs <= LEG_LENGTHS_M[1]:
        raise InputError(
            f"legs of {theirs:.3g} m (thigh and shank) are nobody's",
            where=take.path,
            remedy=f"correct units_m, the file's unit of length in metres (now {units_m:g})",
        )
    bones = NEUTRAL_BODY.bone_lengths
    return float(bones[NEUTRAL_BODY.index("left_knee")] + bones[NEUTRAL_BODY.index("left_ankle")]) / theirs
