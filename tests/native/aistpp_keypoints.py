"""Writes the 3D keypoints of AIST++ as they are distributed: COCO's 17 joints in centimetres."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np

RATE_HZ = 60.0
DANCERS = 1
RECIPE = {"format": "aistpp-keypoints"}
PERFORMER, GENRE = "AIST d04", "break"
# Hips, knees, ankles, shoulders, elbows and wrists are where they were seen.
JOINTS = [1, 2, 4, 5, 7, 8, 16, 17, 18, 19, 20, 21]
ROTATION_TOLERANCE = None
POSITION_TOLERANCE_M = 0.03

# From the head joint, in the head's own axes (m): nose, eyes, ears.
_FACE = np.array(
    [[0.0, 0.03, 0.12], [0.03, 0.07, 0.10], [-0.03, 0.07, 0.10], [0.075, 0.06, 0.0], [-0.075, 0.06, 0.0]]
)
_LIMBS = [16, 17, 18, 19, 20, 21, 1, 2, 4, 5, 7, 8]


def write(folder: Path, dance: dict[str, np.ndarray]) -> Path:
    """Write keypoints3d/NAME.pkl; the table that was not smoothed has a gap, as many have."""
    joints, head = dance["joints"][0], dance["world"][0][:, 15]
    face = joints[:, [15]] + np.einsum("tab,fb->tfa", head, _FACE)
    points = 100.0 * np.concatenate((face, joints[:, _LIMBS]), axis=1)
    rough = points + np.random.default_rng(0).normal(scale=2.0, size=points.shape)
    rough[3, 9] = np.nan
    path = folder / "keypoints3d" / "gBR_sBM_cAll_d04_mBR0_ch01.pkl"
    path.parent.mkdir(parents=True)
    path.write_bytes(pickle.dumps({"keypoints3d": rough, "keypoints3d_optim": points}))
    return path
