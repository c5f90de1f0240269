"""Writes an archive of SMPL's own parameters, Y up."""

from __future__ import annotations

from pathlib import Path

import numpy as np

RATE_HZ = None
DANCERS = 1
RECIPE = {"format": "smpl-npz"}
PELVIS = (-0.001795, -0.223333, 0.028219)


def write(folder: Path, dance: dict[str, np.ndarray]) -> Path:
    """Write light-easy-on.npz."""
    vectors, pelvis = dance["vectors"][0], dance["pelvis"][0]
    path = folder / "light-easy-on.npz"
    folder.mkdir(parents=True, exist_ok=True)
    np.savez(
        path,
        poses=vectors.reshape(len(vectors), 72),
        trans=pelvis - np.array(PELVIS),
        betas=np.zeros(10),
        gender=np.array("neutral"),
        mocap_framerate=np.array(float(dance["rate"])),
    )
    return path
