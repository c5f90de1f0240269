"""Writes joint positions as EDGE does: comma-separated, Z up, no header; here in centimetres."""

from __future__ import annotations

from pathlib import Path

import numpy as np

RATE_HZ = 30.0
DANCERS = 1
RECIPE = {"format": "positions", "skeleton": "aist", "units_m": 0.01, "up": "Z"}
RECOGNISED = False
ROTATION_TOLERANCE = None
PERFORMER, GENRE = "AIST d04", "break"


def write(folder: Path, dance: dict[str, np.ndarray]) -> Path:
    """Write one table; (x, y, z) with Y up becomes (x, -z, y)."""
    joints = 100.0 * dance["joints"][0][..., [0, 2, 1]] * [1.0, -1.0, 1.0]
    path = folder / "true_gBR_sBM_cAll_d04_mBR0_ch01_slice0.csv"
    path.parent.mkdir(parents=True)
    rows = [",".join(f"{number:.8f}" for number in row) for row in joints.reshape(len(joints), -1)]
    path.write_text("\n".join(rows) + "\n")
    return path
