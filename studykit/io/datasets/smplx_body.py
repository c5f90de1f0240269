"""The neutral body of SMPL-X, as far as published joint positions tell it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from studykit.core.arrays import Floats
from studykit.motion.skeleton import NEUTRAL_BODY, Skeleton

SMPLX_PELVIS = (0.0031, -0.3514, 0.0120)
"""Where the SMPL-X model itself puts the pelvis of the neutral shape, m; its translation adds to this."""

# Rest positions (m) of the joints that SMPL-X and SMPL share, as in FineDance's smplx_neu_J_1.npy. Those of
# spine1 to spine3 and of the collars are not quoted anywhere that may be quoted.
_REST = {
    "pelvis": SMPLX_PELVIS,
    "left_hip": (0.0613, -0.4442, -0.0140),
    "right_hip": (-0.0601, -0.4553, -0.0092),
    "left_knee": (0.1160, -0.8229, -0.0234),
    "right_knee": (-0.1044, -0.8177, -0.0260),
    "left_ankle": (0.0726, -1.2260, -0.0552),
    "right_ankle": (-0.0889, -1.2284, -0.0462),
    "left_foot": (0.1198, -1.2840, 0.0630),
    "right_foot": (-0.1277, -1.2868, 0.0728),
    "neck": (-0.0137, 0.1077, -0.0247),
    "head": (0.0111, 0.2682, -0.0040),
    "left_shoulder": (0.1641, 0.0852, -0.0158),
    "right_shoulder": (-0.1518, 0.0804, -0.0191),
    "left_elbow": (0.4182, 0.0131, -0.0582),
    "right_elbow": (-0.4229, 0.0439, -0.0456),
    "left_wrist": (0.6702, 0.0363, -0.0607),
    "right_wrist": (-0.6722, 0.0394, -0.0609),
}
_CHAINS = (
    ("pelvis", "spine1", "spine2", "spine3", "neck"),
    ("spine3", "left_collar", "left_shoulder"),
    ("spine3", "right_collar", "right_shoulder"),
)


def _body() -> Skeleton:
    """Build the body: quoted joints where they are, the others between them as in SMPL's neutral body.

    A chain between two quoted joints has the offsets of SMPL's neutral body; what is then missing to its end
    is shared out by the lengths of its bones. The hands have SMPL's own offsets.
    """
    names = NEUTRAL_BODY.joint_names
    rest: dict[str, Floats] = {name: np.array(place) for name, place in _REST.items()}
    for start, *bones in _CHAINS:
        offsets = NEUTRAL_BODY.offsets[[NEUTRAL_BODY.index(bone) for bone in bones]]
        lengths = np.linalg.norm(offsets, axis=1, keepdims=True)
        missing = rest[bones[-1]] - rest[start] - offsets.sum(axis=0)
        places = rest[start] + np.cumsum(offsets + missing * lengths / lengths.sum(), axis=0)
        rest |= dict(zip(bones[:-1], places[:-1], strict=True))
    for side in ("left", "right"):
        hand = f"{side}_hand"
        rest[hand] = rest[f"{side}_wrist"] + NEUTRAL_BODY.offsets[NEUTRAL_BODY.index(hand)]
    places = np.array([rest[name] for name in names])
    offsets = places - places[[max(parent, 0) for parent in NEUTRAL_BODY.parents]]
    return replace(NEUTRAL_BODY, offsets=offsets)


SMPLX_BODY = _body()
"""SMPL's 24 joints with the bone lengths of neutral SMPL-X; legs, arms, neck and head as published."""
