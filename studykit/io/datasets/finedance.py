"""FineDance: solo dances of many genres, fitted with the neutral SMPL-X body."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.io.array_files import read_npy
from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.smpl_arrays import numbers, plain_stem
from studykit.io.datasets.smplx_body import SMPLX_BODY, SMPLX_PELVIS
from studykit.io.packed import files_ending, read_text
from studykit.motion import rotation
from studykit.motion.motion import Motion

FRAME_RATE_HZ = 30.0

# Of the 52 joints: SMPL's first 22, then the first joint of each hand for SMPL's hands, as the official
# renderer does.
_OF_52 = [*range(22), 22, 37]
_CONTACTS = 4
_LONGEST_STYLE = 100


class FineDance:
    """The dances of FineDance: folder `motion`, one array a dance, metres, Y up.

    A row has the translation, then 52 joints as the first two rows of their rotation matrices (315 numbers);
    files of others have four foot contacts in front (319), or rotation vectors of SMPL-X's 55 joints (168).
    The dances that the authors' loader leaves out (116-123, 130, 202) are read: nothing says that they are
    faulty. Still beginnings are for a recipe to skip.
    """

    name = "finedance"
    citation = "FineDance: R. Li, J. Zhao, Y. Zhang, M. Su, Z. Ren, H. Zhang, Y. Tang, X. Li, ICCV 2023."
    licence = "Research only, no distribution: neither the files nor what is made of them may be passed on"
    native_format = "NumPy arrays (frame, 315), motion/001.npy, 30 frames a second, styles in label_json"

    def recognises(self, folder: Path) -> bool:
        """Tell whether a folder has numbered arrays in a folder `motion`, or is that."""
        base = folder if folder.name == "motion" else folder / "motion"
        return any(re.fullmatch(r"\d{3}", plain_stem(path)) for path in files_ending(base, ".npy"))

    def items(self, folder: Path) -> list[Path]:
        """List the dances; the arrays in `music_npy` are none."""
        base = folder / "motion"
        return files_ending(base if base.is_dir() else folder, ".npy")

    def companions(self, path: Path) -> list[Path]:
        """List the label of a dance."""
        return [_label(path)]

    def read(self, path: Path, recipe: Recipe) -> list[Performance]:  # noqa: ARG002
        """Read one dance."""
        array = numbers(read_npy(path), "the array", path, shape=(None, None))
        width = array.shape[1]
        if width == 319:
            array = array[:, _CONTACTS:]
        elif width not in (315, 168):
            problem = f"the array has {width} numbers a frame, expected 315, 319 or 168"
            raise InputError(problem, where=path, remedy="check that it belongs to the data set")
        motion = Motion(
            skeleton=SMPLX_BODY,
            rotations=_from_vectors(array[:, 3:]) if width == 168 else _from_rows(array[:, 3:], path),
            root_positions=array[:, :3] + np.array(SMPLX_PELVIS),
            frame_rate_hz=FRAME_RATE_HZ,
        )
        return [Performance(motion=motion, genre=_style(path))]


def _from_vectors(vectors: Floats) -> Floats:
    """Take SMPL's joints out of the rotation vectors of SMPL-X's 55, of which jaw and eyes come 23rd."""
    joints = vectors.reshape(len(vectors), 55, 3)
    return rotation.exp(np.delete(joints, [22, 23, 24], axis=1)[:, _OF_52])


def _from_rows(numbers_6d: Floats, path: Path) -> Floats:
    """Make rotations of the first two rows of matrices, by Gram and Schmidt (as PyTorch3D does)."""
    pairs = numbers_6d.reshape(len(numbers_6d), 52, 2, 3)[:, _OF_52]
    first, second = pairs[..., 0, :], pairs[..., 1, :]
    length = np.linalg.norm(first, axis=-1, keepdims=True)
    first = first / np.maximum(length, 1e-9)
    second = second - np.sum(first * second, axis=-1, keepdims=True) * first
    rest = np.linalg.norm(second, axis=-1, keepdims=True)
    flat = np.argwhere(np.minimum(length, rest)[..., 0] < 1e-3)
    if len(flat):
        frame, joint = flat[0]
        problem = f"the rotation of {SMPLX_BODY.joint_names[joint]} in frame {frame} is none"
        raise InputError(problem, where=path, remedy="export the file again, or leave it out")
    second = second / rest
    return rotation.from_matrix(np.stack((first, second, np.cross(first, second)), axis=-2))


def _label(path: Path) -> Path:
    return path.parent.parent / "label_json" / f"{plain_stem(path)}.json"


def _style(path: Path) -> str:
    """Give the style that the label of a dance names, the finer one if it can; empty if there is none."""
    label = _label(path)
    if not label.is_file():
        return ""
    try:
        values = json.loads(read_text(label))
    except (ValueError, RecursionError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("is no JSON", where=label, remedy="copy the label again, or remove it") from error
    for name in ("style2", "style1"):
        style = values.get(name) if isinstance(values, dict) else None
        if isinstance(style, str) and style.strip() and len(style) <= _LONGEST_STYLE:
            return " ".join(style.split())
    return ""
