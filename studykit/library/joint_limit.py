"""How far each joint of a person can turn, and the comfortable middle of it."""

from __future__ import annotations

from typing import Final

import numpy as np

from studykit.core.arrays import Floats
from studykit.motion import rotation
from studykit.motion.skeleton import NEUTRAL_BODY

Range = tuple[float, float, float]
"""Least, neutral and greatest angle, degrees."""

# Angles about X (positive: bend forwards, leg backwards), Y (positive: turn to the left) and Z (positive:
# lean to the right, left limb away from the body), for the middle and the left side, from the T-pose. An axis
# left out does not move. Rounded down from clinical norms of active range (American Academy of Orthopaedic
# Surgeons), each link of the spine and neck given its share; the legs stand slightly bent in neutral.
_RANGES: Final[dict[str, dict[str, Range]]] = {
    "pelvis": {"x": (-15, 2, 25), "z": (-15, 0, 15)},
    "spine1": {"x": (-10, 2, 25), "y": (-12, 0, 12), "z": (-12, 0, 12)},
    "spine2": {"x": (-10, 2, 25), "y": (-12, 0, 12), "z": (-12, 0, 12)},
    "spine3": {"x": (-10, 2, 20), "y": (-12, 0, 12), "z": (-10, 0, 10)},
    "neck": {"x": (-25, 0, 25), "y": (-35, 0, 35), "z": (-20, 0, 20)},
    "head": {"x": (-20, 0, 20), "y": (-30, 0, 30), "z": (-15, 0, 15)},
    "left_collar": {"y": (-15, 0, 15), "z": (-10, 0, 25)},
    "left_shoulder": {"x": (-60, 0, 60), "y": (-110, -15, 35), "z": (-85, -50, 80)},
    "left_elbow": {"x": (-70, 0, 70), "y": (-140, -35, -1)},
    "left_wrist": {"y": (-20, 0, 20), "z": (-55, 0, 55)},
    "left_hand": {"z": (-30, 0, 30)},
    "left_hip": {"x": (-110, -12, 20), "y": (-35, 8, 40), "z": (-20, 4, 40)},
    "left_knee": {"x": (1, 24, 135)},
    "left_ankle": {"x": (-25, -12, 45), "z": (-25, -4, 25)},
    "left_foot": {"x": (-45, 0, 25)},
}
_LEGS: Final = ("hip", "knee", "ankle", "foot")


def _table() -> tuple[Floats, Floats, Floats]:
    """Write the table out for all joints, degrees; right is the mirror image of left."""
    table = np.zeros((3, len(NEUTRAL_BODY.joint_names), 3))
    for name, axes in _RANGES.items():
        left = NEUTRAL_BODY.index(name)
        for axis, limits in axes.items():
            table[:, left, "xyz".index(axis)] = limits
        right = NEUTRAL_BODY.mirror[left]
        if right != left:
            table[:, right, 0] = table[:, left, 0]
            table[:, right, 1:] = -table[::-1, left, 1:]
    low, neutral, high = np.radians(table)
    return low, neutral, high


LOW, NEUTRAL, HIGH = _table()
"""Least, neutral and greatest angle of each joint about X, Y and Z, shape (24, 3), rad."""

IS_LEG = np.array([name.split("_")[-1] in _LEGS for name in NEUTRAL_BODY.joint_names])
"""Which joints turn in the order of a leg (X, Z, Y) and not in that of arm and trunk (Y, Z, X)."""


def within(angles: Floats) -> Floats:
    """Bring angles softly inside the limits of each joint.

    Parameters
    ----------
    angles : ndarray, shape (..., 24, 3), rad
        Wished angles about X, Y and Z.

    Returns
    -------
    ndarray, shape (..., 24, 3), rad
        Strictly inside the limits, and the closer to the wish the nearer this is to neutral:
        n + r tanh((a - n) / r), r being the room on that side. Smooth up to the second derivative.
    """
    beyond = angles - NEUTRAL
    room = 0.99 * np.where(beyond >= 0.0, HIGH - NEUTRAL, NEUTRAL - LOW)
    return np.asarray(NEUTRAL + room * np.tanh(beyond / np.maximum(room, 1e-12)))


def rotations(angles: Floats) -> Floats:
    """Give the parent-relative rotations of joint angles, shape (..., 24, 4).

    Parameters
    ----------
    angles : ndarray, shape (..., 24, 3), rad
        About X, Y and Z.
    """
    half = 0.5 * angles
    about = np.zeros((3, *angles.shape[:-1], 4))  # the turn about each axis alone
    about[..., 0] = np.cos(np.moveaxis(half, -1, 0))
    for axis in range(3):
        about[axis, ..., axis + 1] = np.sin(half[..., axis])
    x, y, z = about
    outer, inner = np.where(IS_LEG[:, None], x, y), np.where(IS_LEG[:, None], y, x)
    return rotation.multiply(outer, rotation.multiply(z, inner))


def angles(rotations: Floats) -> Floats:
    """Give the joint angles of parent-relative rotations: undo `rotations`, shape (..., 24, 3), rad."""
    out = np.empty((*rotations.shape[:-1], 3))
    out[..., IS_LEG, :] = rotation.to_euler("XZY", rotations[..., IS_LEG, :])[..., [0, 2, 1]]
    out[..., ~IS_LEG, :] = rotation.to_euler("YZX", rotations[..., ~IS_LEG, :])[..., [2, 0, 1]]
    return out
