"""What a clip is like in the terms of dance generation research: 72 kinetic and 32 geometric numbers."""

from __future__ import annotations

from typing import Literal

import numpy as np

from studykit.core.arrays import Booleans, Floats
from studykit.core.errors import InputError
from studykit.motion import features
from studykit.motion.skeleton import AIST_BODY, JOINT_NAMES, NEUTRAL_BODY, Skeleton

Compat = Literal["aistpp"]

KINETIC_CLIP_NAMES = features.FEATURE_NAMES[: features.KINETIC]
"""Three a joint: horizontal, vertical and effort."""

GEOMETRIC_CLIP_NAMES = (
    "hand_forward_right", "hand_forward_left", "hand_over_neck_right", "hand_over_neck_left",
    "hand_up_right", "hand_up_left", "elbow_bent_right", "elbow_bent_left",
    "hands_apart", "hands_approaching", "hand_from_root_right", "hand_from_root_left",
    "hand_fast_right", "hand_fast_left", "foot_behind_right", "foot_behind_left",
    "foot_raised_right", "foot_raised_left", "feet_apart", "knee_bent_right", "knee_bent_left",
    "foot_fast_right", "foot_fast_left", "arm_out_right", "arm_out_left", "leg_out_right", "leg_out_left",
    "root_behind", "spine_horizontal", "hand_low_right", "hand_low_left", "root_fast",
)  # fmt: skip
"""Each the share of frames, 0 to 1, in which it is so."""

_COMPAT_RATE_HZ = 60.0
_COMPAT_VELOCITY_RATE_HZ = 120.0
_HALF_WINDOW = 2


def kinetic_clip_features(positions: Floats, frame_rate_hz: float, *, compat: Compat | None = None) -> Floats:
    """Give how lively each joint is in a clip, on average (Onuma et al. 2008).

    Parameters
    ----------
    positions : ndarray, shape (frame, 24, 3), m
        Where the joints are in the world, Y up; four frames or more.
    frame_rate_hz : float
        Frames a second.
    compat : {"aistpp"}, optional
        Repeat the slip of the programs that published values come from; see Notes.

    Returns
    -------
    ndarray, shape (72,)
        Squares of the horizontal and of the vertical speed (m2/s2) and the size of the acceleration (m/s2),
        each of the mean of five frames, averaged over all frames but the first; joint by joint, in the order
        of `KINETIC_CLIP_NAMES`.

    Raises
    ------
    InputError
        If the clip is too short, is not finite, or `compat` is asked of a clip that is not at 60 Hz.

    Notes
    -----
    The programs behind the published FID_k and diversity values (AIST++, and those that copied it) forget a
    pair of brackets: of the two velocities whose difference makes the acceleration, the earlier is
    p(t) - p(t-1) / dt. Their "effort" is about |p| / dt^2, the distance from the origin and no acceleration;
    it changes when the dance is moved. They also take 60 frames a second for granted. "aistpp" repeats both.
    """
    _check(positions, frame_rate_hz, compat)
    if compat is None:
        return np.asarray(features.kinetic(positions, frame_rate_hz)[1:].mean(axis=0))
    values = features.kinetic(positions, _COMPAT_RATE_HZ)[1:].mean(axis=0)
    values[2::3] = _unbracketed_effort(positions, _COMPAT_RATE_HZ)
    return np.asarray(values)


def geometric_clip_features(
    positions: Floats,
    frame_rate_hz: float,
    *,
    compat: Compat | None = None,
    skeleton: Skeleton = NEUTRAL_BODY,
) -> Floats:
    """Give how often a clip shows each of 32 postures and gestures (after Mueller et al. 2005).

    Parameters
    ----------
    positions : ndarray, shape (frame, 24, 3), m
        Where the joints are in the world, Y up; four frames or more.
    frame_rate_hz : float
        Frames a second.
    compat : {"aistpp"}, optional
        Repeat the slips of the program that published values come from; see Notes.
    skeleton : Skeleton
        The body that moves; thresholds are shares of its upper arm and of its width at shoulders and hips.

    Returns
    -------
    ndarray, shape (32,)
        Shares of all frames but the first, in the order of `GEOMETRIC_CLIP_NAMES`.

    Raises
    ------
    InputError
        If the clip is too short, is not finite, or `compat` is asked of a clip that is not at 60 Hz.

    Notes
    -----
    Postures and thresholds are those of the AIST++ program. Its slips, which "aistpp" repeats and the default
    does not:

    - a frame is taken to last 1/120 s, although its clips have 60 frames a second;
    - lengths are those of the AIST++ body, whoever dances;
    - the velocity along a direction ignores the joint that is meant. "hand up" follows the chest; "hands
      approaching" tells that they part; "hand from root" follows the other hand;
    - of three planes the wrong side is asked: "hand forward" is backward for the right hand, "foot behind"
      is before the other leg for the right foot, and "root behind" is in front of the ankles and the neck.
      So left and right do not change places in a mirror; by default they do.

    A foot is "behind" the plane of pelvis, hip and toes of the other leg; as that plane leans forward, this
    is so of people who stand still.
    """
    _check(positions, frame_rate_hz, compat)
    if compat is None:
        poses = _Poses(positions, frame_rate_hz, skeleton)
        relations = _relations(poses)
    else:
        poses = _Poses(positions, _COMPAT_VELOCITY_RATE_HZ, AIST_BODY)
        relations = _relations(poses) | _slips(poses)
    return np.array([relations[name].mean() for name in GEOMETRIC_CLIP_NAMES])


class _Poses:
    """Joints of all frames but the first, their velocities, and the lengths that thresholds refer to."""

    def __init__(self, positions: Floats, rate_hz: float, skeleton: Skeleton) -> None:
        velocities = np.diff(positions, axis=0) * rate_hz
        self.at = {name: positions[1:, joint] for joint, name in enumerate(JOINT_NAMES)}
        self.velocity = {name: velocities[:, joint] for joint, name in enumerate(JOINT_NAMES)}
        self.floor = positions[1:, :, 1].min(axis=1)
        rest = _rest_positions(skeleton)
        self.upper_arm = float(skeleton.bone_lengths[skeleton.index("left_elbow")])
        self.shoulders = float(np.linalg.norm(rest["left_shoulder"] - rest["right_shoulder"]))
        self.hips = float(np.linalg.norm(rest["left_hip"] - rest["right_hip"]))

    def way(self, start: str, end: str) -> Floats:
        return np.asarray(self.at[end] - self.at[start])

    def speed(self, joint: str) -> Floats:
        return np.asarray(np.linalg.norm(self.velocity[joint], axis=-1))

    def speed_along(self, direction: Floats, joint: str, *, seen_from: str) -> Floats:
        return _along(self.velocity[joint] - self.velocity[seen_from], direction)

    def is_between(self, first: Floats, second: Floats, low_deg: float, high_deg: float) -> Booleans:
        across = np.linalg.norm(np.cross(first, second), axis=-1)
        angle = np.degrees(np.arctan2(across, np.sum(first * second, axis=-1)))
        return np.asarray((angle > low_deg) & (angle < high_deg))

    def front_of_leg(self, side: str) -> Floats:
        hip, toes = self.way("pelvis", f"{side}_hip"), self.way("pelvis", f"{side}_foot")
        return np.cross(toes, hip) if side == "left" else np.cross(hip, toes)

    @property
    def front_of_trunk(self) -> Floats:
        return np.cross(self.way("right_hip", "left_hip"), self.way("right_hip", "neck"))

    @property
    def front_of_stance(self) -> Floats:
        return np.cross(self.way("right_ankle", "left_ankle"), self.way("right_ankle", "neck"))


def _relations(poses: _Poses) -> dict[str, Booleans]:
    arm, up = poses.upper_arm, np.array([0.0, 1.0, 0.0])
    spine = poses.way("neck", "pelvis")
    hands = poses.way("left_wrist", "right_wrist")
    relations = {
        "hands_apart": _along(hands, poses.way("left_shoulder", "right_shoulder")) > 2.5 * poses.shoulders,
        "hands_approaching": poses.speed_along(hands, "left_wrist", seen_from="right_wrist") > 1.4 * arm,
        "feet_apart": _along(poses.way("left_ankle", "right_ankle"), poses.way("left_hip", "right_hip"))
        > 2.1 * poses.hips,
        "root_behind": _along(poses.way("right_ankle", "pelvis"), -poses.front_of_stance) > 0.5 * arm,
        "spine_horizontal": poses.is_between(spine, up, 70.0, 110.0),
        "root_fast": poses.speed("pelvis") > 2.3 * arm,
    }
    for side, other in (("right", "left"), ("left", "right")):
        relations |= {
            f"{name}_{side}": values for name, values in _relations_of_side(poses, side, other).items()
        }
    return relations


def _relations_of_side(poses: _Poses, side: str, other: str) -> dict[str, Booleans]:
    arm, spine = poses.upper_arm, poses.way("neck", "pelvis")
    shoulder, elbow, wrist = (f"{side}_{joint}" for joint in ("shoulder", "elbow", "wrist"))
    hip, knee, ankle = (f"{side}_{joint}" for joint in ("hip", "knee", "ankle"))
    return {
        "hand_forward": poses.speed_along(poses.front_of_trunk, wrist, seen_from="neck") > 1.8 * arm,
        "hand_over_neck": _along(poses.way("neck", wrist), poses.way("spine3", "neck")) > 0.2 * arm,
        "hand_up": poses.speed_along(poses.way("spine1", "spine3"), wrist, seen_from="spine3") > 1.8 * arm,
        "elbow_bent": poses.is_between(poses.way(elbow, shoulder), poses.way(elbow, wrist), 0.0, 110.0),
        "hand_from_root": poses.speed_along(poses.way("pelvis", wrist), wrist, seen_from="pelvis")
        > 1.4 * arm,
        "hand_fast": poses.speed(wrist) > 2.5 * arm,
        "foot_behind": _along(poses.way("pelvis", ankle), -poses.front_of_leg(other)) > 0.38 * arm,
        "foot_raised": poses.at[ankle][:, 1] - poses.floor > 1.2 * arm,
        "knee_bent": poses.is_between(poses.way(knee, hip), poses.way(knee, ankle), 0.0, 110.0),
        "foot_fast": poses.speed(ankle) > 2.5 * arm,
        "arm_out": poses.is_between(spine, poses.way(shoulder, elbow), 25.0, 180.0),
        "leg_out": poses.is_between(spine, poses.way(hip, knee), 50.0, 180.0),
        "hand_low": poses.at[wrist][:, 1] - poses.floor < 1.2 * arm,
    }


def _slips(poses: _Poses) -> dict[str, Booleans]:
    """Give what the AIST++ program has in place of the relations that it names."""
    arm, chest = poses.upper_arm, poses.way("spine1", "spine3")
    hands = poses.way("left_wrist", "right_wrist")
    chest_up = poses.speed_along(chest, "spine3", seen_from="spine1") > 1.8 * arm
    relations = {
        "hand_forward_right": poses.speed_along(-poses.front_of_trunk, "right_wrist", seen_from="neck")
        > 1.8 * arm,
        "hand_up_right": chest_up,
        "hand_up_left": chest_up,
        "hands_approaching": poses.speed_along(hands, "right_wrist", seen_from="left_wrist") > 1.4 * arm,
        "foot_behind_right": _along(poses.way("pelvis", "right_ankle"), poses.front_of_leg("left"))
        > 0.38 * arm,
        "root_behind": _along(poses.way("right_ankle", "pelvis"), poses.front_of_stance) > 0.5 * arm,
    }
    for side, other in (("right", "left"), ("left", "right")):
        inwards = poses.way(f"{side}_wrist", "pelvis")
        relations[f"hand_from_root_{side}"] = (
            poses.speed_along(inwards, f"{other}_wrist", seen_from=f"{side}_wrist") > 1.4 * arm
        )
    return relations


def _unbracketed_effort(positions: Floats, rate_hz: float) -> Floats:
    """Give the mean size of the "acceleration" with the missing brackets, shape (24,)."""
    before, now, after = positions[:-2], positions[1:-1], positions[2:]
    slipped = ((after - now) * rate_hz - (now - before * rate_hz)) * rate_hz
    sums = np.concatenate((np.zeros_like(slipped[:1]), np.cumsum(slipped, axis=0)))
    frames = np.arange(1, len(positions))
    first = np.clip(frames - _HALF_WINDOW - 1, 0, len(slipped) - 1)
    end = np.clip(frames + _HALF_WINDOW, 1, len(slipped))
    means = (sums[end] - sums[first]) / (end - first)[:, None, None]
    return np.asarray(np.linalg.norm(means, axis=-1).mean(axis=0))


def _along(vectors: Floats, direction: Floats) -> Floats:
    """Give the component of vectors along a direction; 0 where there is no direction."""
    length = np.maximum(np.linalg.norm(direction, axis=-1), 1e-12)
    return np.asarray(np.sum(vectors * direction, axis=-1) / length)


def _rest_positions(skeleton: Skeleton) -> dict[str, Floats]:
    rest: dict[str, Floats] = {}
    for joint, parent in enumerate(skeleton.parents):
        start = rest[skeleton.joint_names[parent]] if parent >= 0 else np.zeros(3)
        rest[skeleton.joint_names[joint]] = start + skeleton.offsets[joint]
    return rest


def _check(positions: Floats, frame_rate_hz: float, compat: Compat | None) -> None:
    if positions.ndim != 3 or positions.shape[1:] != (24, 3) or len(positions) < 4:
        raise InputError(
            f"positions have the shape {positions.shape}",
            where="positions",
            remedy="give four frames or more of 24 joints",
        )
    if not np.isfinite(positions).all() or not (np.isfinite(frame_rate_hz) and frame_rate_hz > 0.0):
        raise InputError(
            "a position or the frame rate is not a finite number",
            where="positions",
            remedy="leave out what was not measured",
        )
    if compat is not None and abs(frame_rate_hz - _COMPAT_RATE_HZ) > 0.1:
        raise InputError(
            f'"{compat}" takes 60 frames a second for granted, these are {frame_rate_hz:g}',
            where="frame_rate_hz",
            remedy="resample the clip to 60 Hz",
        )
