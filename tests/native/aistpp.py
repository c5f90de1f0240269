"""Writes AIST++ as it is distributed: a dictionary a sequence, the translation in the unit of the capture."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np

RATE_HZ = 60.0
DANCERS = 1
RECIPE = {"format": "aistpp"}
PERFORMER, GENRE = "AIST d04", "break"
SCALING = 93.0


def write(folder: Path, dance: dict[str, np.ndarray], *, protocol: int = 4, flat: bool = True) -> Path:
    """Write motions/NAME.pkl, and the list of sequences to ignore."""
    vectors, pelvis = dance["vectors"][0], dance["pelvis"][0]
    path = folder / "motions" / "gBR_sBM_cAll_d04_mBR0_ch01.pkl"
    path.parent.mkdir(parents=True)
    content = {
        "smpl_loss": 1.25,
        "smpl_poses": vectors.reshape(len(vectors), 72) if flat else vectors,
        "smpl_scaling": np.array([SCALING]),
        "smpl_trans": pelvis * SCALING,
    }
    path.write_bytes(pickle.dumps(content, protocol))
    (folder / "ignore_list.txt").write_text("gBR_sBM_cAll_d04_mBR0_ch09\n")
    path.with_name("gBR_sBM_cAll_d04_mBR0_ch09.pkl").write_bytes(b"known to be wrong")
    return path
