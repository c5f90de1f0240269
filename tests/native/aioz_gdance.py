"""Writes AIOZ-GDANCE as it is distributed: all dancers of a group in one dictionary."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np

RATE_HZ = 30.0
DANCERS = 3
RECIPE = {"format": "aioz-gdance"}
PELVIS = (-0.001795, -0.223333, 0.028219)  # of the neutral SMPL body


def write(
    folder: Path, dance: dict[str, np.ndarray], *, body_numbers: int = 72, root_too: bool = False
) -> Path:
    """Write motions_smpl/NAME.pkl; fewer than 72 numbers have the root apart, and perhaps no hands.

    With `root_too` the root is apart even if the 72 numbers have it.
    """
    vectors, pelvis = dance["vectors"], dance["pelvis"]
    poses = vectors.reshape(*vectors.shape[:2], 72)
    content = {
        "smpl_poses": poses if body_numbers == 72 else poses[..., 3 : 3 + body_numbers],
        "root_trans": pelvis - np.array(PELVIS),
        "smpl_betas": np.zeros((len(vectors), 10)),
        "meta": {"orig_start": 120, "orig_end": 120 + vectors.shape[1], "video": "abc"},
    }
    if body_numbers != 72 or root_too:
        content["smpl_orients"] = poses[..., :3]
    path = folder / "motions_smpl" / f"zyVRg2QR6LA_01_120_{120 + vectors.shape[1]}.pkl"
    path.parent.mkdir(parents=True)
    path.write_bytes(pickle.dumps(content))
    (folder / "split_sequence_names.txt").write_text(path.stem + "\n")
    return path
