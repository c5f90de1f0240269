"""AMASS: many collections of motion capture, fitted with SMPL-H or SMPL-X."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.io.array_files import read_npz
from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.smpl_arrays import movement, numbers, part, plain_stem, rate_hz, same_length
from studykit.io.datasets.smplx_body import SMPLX_BODY, SMPLX_PELVIS
from studykit.io.packed import files_ending
from studykit.motion import rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import AIST_BODY, NEUTRAL_BODY, NEUTRAL_PELVIS

_NAMES = ("poses", "trans", "root_orient", "pose_body", "gender", "mocap_framerate", "mocap_frame_rate")
_RATES = ("mocap_framerate", "mocap_frame_rate")
_ENDINGS = ("_poses", "_stageii")
_BODY_JOINTS = 22

# Z up to Y up, (x, y, z) -> (x, z, -y): a quarter turn about X. Swapping y and z alone would mirror the body.
_QUARTER_TURN = np.array([np.sqrt(0.5), -np.sqrt(0.5), 0.0, 0.0])


class Amass:
    """The archives of AMASS: COLLECTION/SUBJECT/TAKE_poses.npz (SMPL-H) or TAKE_stageii.npz (SMPL-X).

    Z is up, metres, each at its own rate. The shape of the subject is not carried over (that needs the model
    files): men have the male mean shape of SMPL, all others the neutral one, and SMPL-X files the neutral
    SMPL-X one. Hands are left as they rest.
    """

    name = "amass"
    citation = "AMASS: N. Mahmood, N. Ghorbani, N. F. Troje, G. Pons-Moll, M. J. Black, ICCV 2019."
    licence = "Research only, no redistribution; each collection in it has terms of its own"
    native_format = "NumPy archives of SMPL-H or SMPL-X parameters, Z up, COLLECTION/SUBJECT/TAKE_poses.npz"

    def recognises(self, folder: Path) -> bool:
        """Tell whether any archive below a folder is named as those of AMASS are."""
        return bool(self.items(folder))

    def items(self, folder: Path) -> list[Path]:
        """List the takes; the archives of a subject's shape are none."""
        return [path for path in files_ending(folder, ".npz") if plain_stem(path).endswith(_ENDINGS)]

    def companions(self, path: Path) -> list[Path]:  # noqa: ARG002
        """List nothing: a file stands alone."""
        return []

    def read(self, path: Path, recipe: Recipe) -> list[Performance]:  # noqa: ARG002
        """Read one take."""
        arrays = read_npz(path, _NAMES)
        places = numbers(part(arrays, "trans", path), "trans", path, shape=(None, 3))
        rate_name = next((name for name in _RATES if name in arrays), _RATES[0])
        rate = rate_hz(part(arrays, rate_name, path), rate_name, path)
        if "poses" in arrays:
            width = arrays["poses"].shape[-1] if arrays["poses"].ndim == 2 else 156
            poses = numbers(
                arrays["poses"], "poses", path, shape=(None, width if width in (156, 165) else 156)
            )
            is_smplx = width == 165
            vectors = poses[:, : _BODY_JOINTS * 3]
        else:
            is_smplx = True
            root = numbers(part(arrays, "root_orient", path), "root_orient", path, shape=(None, 3))
            body = numbers(part(arrays, "pose_body", path), "pose_body", path, shape=(None, 63))
            same_length(root, body, "root_orient and pose_body", path)
            vectors = np.concatenate((root, body), axis=1)
        same_length(vectors, places, "poses and trans", path)
        skeleton, pelvis = (SMPLX_BODY, SMPLX_PELVIS) if is_smplx else (NEUTRAL_BODY, NEUTRAL_PELVIS)
        if not is_smplx and _gender(arrays.get("gender"), path) == "male":
            skeleton = AIST_BODY
        motion = movement(_joints_24(vectors), places + np.array(pelvis), rate=rate, skeleton=skeleton)
        collection = path.parent.parent.name
        return [Performance(motion=y_up(motion), performer=path.parent.name, genre=collection)]


def y_up(motion: Motion) -> Motion:
    """Turn a movement with Z up by a quarter about X, so that Y is up and left stays left."""
    rotations = np.array(motion.rotations)
    rotations[:, 0] = rotation.multiply(_QUARTER_TURN, rotations[:, 0])
    return Motion(
        skeleton=motion.skeleton,
        rotations=rotations,
        root_positions=rotation.rotate(_QUARTER_TURN, motion.root_positions),
        frame_rate_hz=motion.frame_rate_hz,
    )


def _joints_24(vectors: Floats) -> Floats:
    """Fill up 22 joints with SMPL's hands, which are not turned."""
    return np.concatenate((vectors, np.zeros((len(vectors), 6))), axis=1).reshape(-1, 24, 3)


def _gender(value: Any, path: Path) -> str:
    """Give the gender, which some archives have as text, some as bytes and some not at all."""
    if value is None:
        return "neutral"
    text = str(value.reshape(-1)[0]) if value.size == 1 and value.dtype.kind == "U" else ""
    if value.size == 1 and value.dtype.kind == "S":
        text = bytes(value.reshape(-1)[0]).decode("latin-1")
    if text not in ("male", "female", "neutral"):
        raise InputError("gender is neither male, female nor neutral", where=path, remedy="copy it again")
    return text
