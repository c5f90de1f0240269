"""AIST++ as joints in space: COCO's 17 points, triangulated from nine cameras."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.io.datasets.aistpp import (
    CITATION,
    FRAME_RATE_HZ,
    LICENCE,
    genre_of,
    has_sequences,
    performer_of,
    sequences,
)
from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.smpl_arrays import numbers
from studykit.io.gaps import filled
from studykit.io.restricted_pickle import read_pickle
from studykit.io.skeleton_map import LEG_LENGTHS_M
from studykit.motion.coco_body import COCO_JOINTS, body_from_coco
from studykit.motion.retargeting import leg_length

_CENTIMETRE = 0.01


class AistPlusPlusKeypoints:
    """The 3D keypoints of AIST++: folder `keypoints3d`, one pickle a sequence, centimetres, Y up.

    Of the two tables in a file the smoothed one, `keypoints3d_optim`, is taken if it is there. Points lost
    for half a second or less are filled in.
    """

    name = "aistpp-keypoints"
    citation = CITATION
    licence = LICENCE
    native_format = (
        "Pickles of COCO's 17 joints, keypoints3d/gBR_sBM_cAll_d04_mBR0_ch01.pkl, 60 frames a second."
    )

    def recognises(self, folder: Path) -> bool:
        """Tell whether a folder has the keypoints of AIST's sequences and not their SMPL fits."""
        return has_sequences(folder, "keypoints3d") and not has_sequences(folder, "motions")

    def items(self, folder: Path) -> list[Path]:
        """List the sequences but for those that `ignore_list.txt` names."""
        return sequences(folder, "keypoints3d")

    def companions(self, path: Path) -> list[Path]:  # noqa: ARG002
        """List nothing: a sequence stands alone."""
        return []

    def read(self, path: Path, recipe: Recipe) -> list[Performance]:  # noqa: ARG002
        """Read one sequence and find how SMPL's joints are turned."""
        points, lost = _points(read_pickle(path), path)
        motion = body_from_coco(points * _CENTIMETRE, frame_rate_hz=FRAME_RATE_HZ)
        legs = leg_length(motion.skeleton)
        if not LEG_LENGTHS_M[0] <= legs <= LEG_LENGTHS_M[1]:
            problem = f"legs of {legs:.3g} m (thigh and shank) are nobody's"
            raise InputError(problem, where=path, remedy="check that its lengths are centimetres")
        counts = ", ".join(f"{point} {frames}" for point, frames in lost.items())
        notes = f"frames filled in: {counts}" if counts else ""
        return [Performance(motion=motion, performer=performer_of(path), genre=genre_of(path), notes=notes)]


def _points(values: Any, path: Path) -> tuple[Floats, dict[str, int]]:
    """Give the points without gaps, and how many frames were filled in for each."""
    names = [
        name for name in ("keypoints3d_optim", "keypoints3d") if isinstance(values, dict) and name in values
    ]
    if not names:
        remedy = "check that it belongs to the data set"
        raise InputError("has no array keypoints3d_optim or keypoints3d", where=path, remedy=remedy)
    points, lost = _without_gaps(values[names[0]], names[0], path)
    hips = np.linalg.norm(points[:, 11] - points[:, 12], axis=-1)
    if np.any(hips < 1e-6):
        problem = f"both hips are in one place in frame {np.argmin(hips)}"
        raise InputError(problem, where=path, remedy="export the file again, or leave it out")
    return points, lost


def _without_gaps(stored: Any, name: str, path: Path) -> tuple[Floats, dict[str, int]]:
    is_gap = np.isnan(stored) if isinstance(stored, np.ndarray) and stored.dtype.kind == "f" else False
    points = numbers(
        np.where(is_gap, 0.0, stored) if np.any(is_gap) else stored, name, path, shape=(None, 17, 3)
    )
    if not np.any(is_gap):
        return points, {}
    points[is_gap] = np.nan
    gone: NDArray[np.bool_] = np.asarray(np.isnan(points).any(axis=-1))
    remedy = "export the file again, or leave it out"
    if np.any(gone.all(axis=1)):
        problem = f"{name} has nan in frame {np.argmax(gone.all(axis=1))}, where nothing was seen"
        raise InputError(problem, where=path, remedy=remedy)
    if np.any(gone.all(axis=0)):
        point = COCO_JOINTS[np.argmax(gone.all(axis=0))]
        raise InputError(f"{name} has {point} in no frame", where=path, remedy=remedy)
    return filled(points, COCO_JOINTS, FRAME_RATE_HZ, path)
