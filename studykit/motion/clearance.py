"""How much room there is between an arm and the rest of the body."""

from __future__ import annotations

from typing import Final, Literal

import numpy as np
from numba import njit

from studykit.core.arrays import Floats
from studykit.motion.joint_mask import beyond
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY

Side = Literal["left", "right"]

# Half the thickness of what lies between each joint and its parent, m: mean anthropometry, rounded down, so
# that what touches here touches on a body.
_RADII: Final = {
    "hip": 0.09, "knee": 0.07, "ankle": 0.045, "foot": 0.035,
    "spine1": 0.11, "spine2": 0.11, "spine3": 0.11, "neck": 0.08, "head": 0.055,
    "collar": 0.05, "shoulder": 0.05, "elbow": 0.04, "wrist": 0.035, "hand": 0.025,
}  # fmt: skip
_HEAD_RADIUS_M: Final = 0.09
_HEAD_M: Final = 0.07  # from the joint to the middle of the skull, away from the chest
_FINGERS: Final = 1.0  # lengths of the hand's bone that the fingers reach beyond it
_ALONG: Final = np.linspace(0.0, 1.0, 5)


def clearance(positions: Floats, side: Side) -> Floats:
    """Give the gap between a forearm with its hand and trunk, head, legs and the other arm.

    Parameters
    ----------
    positions : ndarray, shape (..., 24, 3), m
        Joint positions in SMPL's order.
    side : {"left", "right"}
        Whose forearm.

    Returns
    -------
    ndarray, shape (...), m
        Distance of the nearest surfaces, every bone being a rounded rod; below 0 where they overlap.
    """
    index = NEUTRAL_BODY.index
    elbow, wrist, hand = (positions[..., index(f"{side}_{name}"), :] for name in ("elbow", "wrist", "hand"))
    fingers = hand + _FINGERS * (hand - wrist)
    own = np.concatenate((_between(elbow, wrist), _between(wrist, fingers)), axis=-2)
    thick = np.repeat([_RADII["wrist"], _RADII["hand"]], len(_ALONG))

    # The skull is a ball: a rod without length.
    head = positions[..., index("head"), :]
    up = head - positions[..., index("spine3"), :]
    skull = head + _HEAD_M * up / np.maximum(np.linalg.norm(up, axis=-1, keepdims=True), 1e-9)

    arm = beyond(f"{side}_collar")
    others = [joint for joint in range(1, len(JOINT_NAMES)) if joint not in arm]
    parents = [NEUTRAL_BODY.parents[joint] for joint in others]
    starts = np.concatenate((positions[..., parents, :], skull[..., None, :]), axis=-2)
    ends = np.concatenate((positions[..., others, :], skull[..., None, :]), axis=-2)
    radii = np.array([*(_RADII[JOINT_NAMES[joint].split("_")[-1]] for joint in others), _HEAD_RADIUS_M])
    starts, ends = (rods.reshape(-1, len(radii), 3) for rods in (starts, ends))
    gaps = _gaps(own.reshape(-1, len(thick), 3), thick, starts, ends, radii)
    return np.asarray(gaps.reshape(positions.shape[:-2]))


def _between(start: Floats, end: Floats) -> Floats:
    """Give points along a bone, shape (..., point, 3)."""
    return start[..., None, :] + _ALONG[:, None] * (end - start)[..., None, :]


@njit(cache=True, nogil=True)
def _gaps(points: Floats, thick: Floats, starts: Floats, ends: Floats, radii: Floats) -> Floats:
    """Give the least distance of the surfaces of balls and rods in each pose."""
    least = np.full(len(points), np.inf)
    for pose in range(len(points)):
        for rod in range(len(radii)):
            sx, sy, sz = starts[pose, rod]
            ex, ey, ez = ends[pose, rod]
            bx, by, bz = ex - sx, ey - sy, ez - sz
            length = max(bx * bx + by * by + bz * bz, 1e-12)
            for point in range(len(thick)):
                px, py, pz = points[pose, point]
                x, y, z = px - sx, py - sy, pz - sz
                share = min(max((x * bx + y * by + z * bz) / length, 0.0), 1.0)
                x, y, z = x - share * bx, y - share * by, z - share * bz
                gap = np.sqrt(x * x + y * y + z * z) - radii[rod] - thick[point]
                least[pose] = min(least[pose], gap)
    return least
