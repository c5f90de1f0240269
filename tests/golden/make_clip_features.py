"""Writes clip_features.json: what the AIST++ program says about movements that are made of sines.

Run by hand: python tests/golden/make_clip_features.py FOLDER tests/golden/clip_features.json
FOLDER holds a package `features` with kinetic.py, manual.py and utils.py of google/aistplusplus_api
(aist_plusplus/features; manual.py at commit 091f00b245, utils.py at 74fac6d38f). The numbers here were made
with the copy of kinetic.py in gia-cat-bui-le/dhms at 91a0b4531a, which bears the same notice and whose
formulas are those of facebookresearch/fairmotion at c16b6590cb.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

from studykit.motion.skeleton import AIST_BODY

MOVEMENTS = (
    {"frames": 150, "shift_m": [0.0, 1.0, 0.0], "swing_m": 0.25, "tilt_rad": 0.0},
    {"frames": 150, "shift_m": [3.0, 1.0, -2.0], "swing_m": 0.25, "tilt_rad": 0.0},
    {"frames": 90, "shift_m": [0.0, 0.0, 0.0], "swing_m": 0.05, "tilt_rad": 0.2},
    {"frames": 120, "shift_m": [0.0, 0.5, 0.0], "swing_m": 0.2, "tilt_rad": 1.45},
    {"frames": 7, "shift_m": [0.3, 0.9, 0.1], "swing_m": 0.4, "tilt_rad": 0.0},
)


def positions(*, frames: int, shift_m: list[float], swing_m: float, tilt_rad: float) -> np.ndarray:
    """Swing every joint of a tilted body about its place at rest, along each axis at a pace of its own."""
    rest = np.zeros((24, 3))
    for joint, parent in enumerate(AIST_BODY.parents):
        rest[joint] = AIST_BODY.offsets[joint] + (rest[parent] if parent >= 0 else 0.0)
    cosine, sine = np.cos(tilt_rad), np.sin(tilt_rad)
    tilted = rest @ np.array([[1.0, 0.0, 0.0], [0.0, cosine, sine], [0.0, -sine, cosine]]) + shift_m
    number = np.arange(72.0).reshape(24, 3)
    times_s = np.arange(frames)[:, None, None] / 60.0
    pace_hz = 0.3 + (number * 0.381966) % 1.3
    return tilted + swing_m * np.sin(2.0 * np.pi * (pace_hz * times_s + (number * 0.618034) % 1.0))


def main(folder: str, out: str) -> None:
    """Let the other program measure each movement, and write what it says."""
    sys.path.insert(0, folder)
    from features.kinetic import extract_kinetic_features
    from features.manual import extract_manual_features

    golden = []
    for movement in MOVEMENTS:
        joints = positions(**movement)
        golden.append(
            movement
            | {
                "kinetic": extract_kinetic_features(joints).tolist(),
                "geometric": extract_manual_features(joints).tolist(),
            }
        )
    Path(out).write_text(json.dumps(golden, indent=1) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
