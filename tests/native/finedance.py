"""Writes FineDance as it is distributed: two rows of each rotation's matrix, one after the other."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

RATE_HZ = 30.0
DANCERS = 1
RECIPE = {"format": "finedance"}
GENRE = "HanTang"
PELVIS = (0.0031, -0.3514, 0.0120)  # of the neutral SMPL-X body
LEFT_HAND, RIGHT_HAND = 22, 37  # first finger joint of each hand, of 52


def hands(vectors: np.ndarray) -> np.ndarray:
    """Give SMPL-H's 52 joints: the fingers rest, but for the first joint of each hand."""
    rng = np.random.default_rng(1)
    joints = rng.normal(scale=0.2, size=(len(vectors), 52, 3))
    joints[:, :22] = vectors[:, :22]
    joints[:, LEFT_HAND], joints[:, RIGHT_HAND] = vectors[:, 22], vectors[:, 23]
    return joints


def rows(vectors: np.ndarray, *, columns: bool = False) -> np.ndarray:
    """Give the first two rows of the matrices of rotation vectors (wrong: the first two columns)."""
    finite = np.all(np.isfinite(vectors), axis=-1)
    matrices = Rotation.from_rotvec(np.where(finite[..., None], vectors, 0.0).reshape(-1, 3)).as_matrix()
    matrices = matrices.reshape(*vectors.shape[:-1], 3, 3)
    matrices[~finite] = np.nan
    if columns:
        matrices = np.swapaxes(matrices, -1, -2)
    return matrices[..., :2, :].reshape(len(vectors), -1)


def write(folder: Path, dance: dict[str, np.ndarray], *, width: int = 315, columns: bool = False) -> Path:
    """Write motion/NNN.npy and label_json/NNN.json, and music features that are no dance."""
    vectors, pelvis = dance["vectors"][0], dance["pelvis"][0]
    trans = pelvis - np.array(PELVIS)
    joints = hands(vectors)
    if width == 168:
        jaw_and_eyes = np.full((len(joints), 3, 3), 0.3)
        all_55 = np.concatenate((joints[:, :22], jaw_and_eyes, joints[:, 22:]), axis=1)
        array = np.concatenate((trans, all_55.reshape(len(joints), 165)), axis=1)
    else:
        array = np.concatenate((trans, rows(joints, columns=columns)), axis=1)
    if width == 319:
        array = np.concatenate((np.ones((len(array), 4)), array), axis=1)
    path = folder / "motion" / "012.npy"
    path.parent.mkdir(parents=True)
    np.save(path, array)
    (folder / "label_json").mkdir()
    (folder / "label_json" / "012.json").write_text(
        json.dumps({"name": "a song", "style1": "Classic", "style2": GENRE})
    )
    (folder / "music_npy").mkdir()
    np.save(folder / "music_npy" / "012.npy", np.zeros((len(array), 35)))
    return path
