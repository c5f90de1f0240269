"""AMASS: many collections of motion capture, fitted with SMPL-H or SMPL-X."""

from __future__ import annotations

import re
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

_RATES = ("mocap_framerate", "mocap_frame_rate")
_NAMES = ("poses", "trans", "root_orient", "pose_body", *_RATES)
_WORDS = ("gender", "surface_model_type")
_GENDERS = ("male", "female", "neutral")
_MODELS = ("smpl", "smplh", "smplx")
_SMPLX_WIDTH = 165
_ENDINGS = ("_poses", "_stageii")
_BODY_JOINTS = 22

_FOLDERS = """
    ACCAD BMLhandball BMLmovi BMLrub BioMotionLab_NTroje CMU CNRS DFaust DFaust_67 DanceDB EKUT EyesJapan
    EyesJapanDataset Eyes_Japan_Dataset GRAB HDM05 HUMAN4D HumanEva KIT MPI_HDM05 MPI_Limits MPI_mosh MoSh
    PosePrior SFU SOMA SSM SSM_synced TCDHands TCD_handMocap TotalCapture Transitions Transitions_mocap
    WEIZMANN"""
COLLECTIONS = frozenset(_FOLDERS.split())
"""Names of the folders in which AMASS is distributed; no other folder's name is taken for a collection."""

# Z up to Y up, (x, y, z) -> (x, z, -y): a quarter turn about X. Swapping y and z alone would mirror the body.
_QUARTER_TURN = np.array([np.sqrt(0.5), -np.sqrt(0.5), 0.0, 0.0])


class Amass:
    """The archives of AMASS: COLLECTION/SUBJECT/TAKE_poses.npz (SMPL-H) or TAKE_stageii.npz (SMPL-X).

    Z is up, metres, each at its own rate. The shape of the subject is not carried over (that needs the model
    files): men have the male mean shape of SMPL, all others the neutral one, and SMPL-X files the neutral
    SMPL-X one. Hands are left as they rest. The performer is called by collection and subject, since subjects
    of several collections share a name. A collection is no genre: that is for a recipe to say.
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

    def read(self, path: Path, recipe: Recipe) -> list[Performance]:
        """Read one take; a rate in the recipe serves where the file has none."""
        arrays = read_npz(path, _NAMES, dispensable=_WORDS)
        places = numbers(part(arrays, "trans", path), "trans", path, shape=(None, 3))
        rate = _rate(arrays, path, recipe)
        vectors, is_smplx = _body(arrays, path)
        same_length(vectors, places, "poses and trans", path)
        gender = _word(arrays.get("gender"))
        skeleton, pelvis = (SMPLX_BODY, SMPLX_PELVIS) if is_smplx else (NEUTRAL_BODY, NEUTRAL_PELVIS)
        if not is_smplx and gender == "male":
            skeleton = AIST_BODY
        motion = movement(_joints_24(vectors), places + np.array(pelvis), rate=rate, skeleton=skeleton)
        notes = "" if gender in _GENDERS else f"gender {gender[:20]!r} counts as neutral"
        if not gender:
            notes = "gender is not said and counts as neutral"
        return [Performance(motion=y_up(motion), performer=_performer(path), notes=notes)]


def _rate(arrays: dict[str, Any], path: Path, recipe: Recipe) -> float:
    """Give the frame rate that a file says, Hz, or else the recipe."""
    for name in _RATES:
        if name in arrays:
            return rate_hz(arrays[name], name, path)
    rate = recipe.frame_rate(path.name)
    if rate is None:
        remedy = "give the true rate under frame_rates_hz in a recipe"
        raise InputError(f"has no array {_RATES[0]}", where=path, remedy=remedy)
    return rate


def _body(arrays: dict[str, Any], path: Path) -> tuple[Floats, bool]:
    """Give the rotation vectors of 22 joints, shape (frame, 66), rad, and whether they are of SMPL-X.

    Files that do not name their model are told by their arrays: only SMPL-X has jaw and eyes (165 numbers),
    and AMASS has SMPL-H in one array.
    """
    model = _word(arrays.get("surface_model_type"))
    if "poses" in arrays:
        width = arrays["poses"].shape[-1] if arrays["poses"].ndim == 2 else 0
        is_wide = width == _SMPLX_WIDTH
        poses = numbers(arrays["poses"], "poses", path, shape=(None, width if is_wide else 156))
        return poses[:, : _BODY_JOINTS * 3], is_wide or model == "smplx"
    root = numbers(part(arrays, "root_orient", path), "root_orient", path, shape=(None, 3))
    body = numbers(part(arrays, "pose_body", path), "pose_body", path, shape=(None, 63))
    same_length(root, body, "root_orient and pose_body", path)
    return np.concatenate((root, body), axis=1), model not in _MODELS or model == "smplx"


def _performer(path: Path) -> str:
    """Name a subject such as "ACCAD Female1General_c3d"; by its folder alone if that is in no collection."""
    subject = path.absolute().parent
    if ".." in subject.parts:
        subject = subject.resolve()
    collection = subject.parent.name
    return f"{collection} {subject.name}" if collection in COLLECTIONS else subject.name


def y_up(motion: Motion) -> Motion:
    """Turn a movement with Z up by a quarter about X, so that Y is up and left stays left."""
    return _tipped(motion, _QUARTER_TURN)


def z_up(motion: Motion) -> Motion:
    """Undo `y_up`."""
    return _tipped(motion, rotation.inverse(_QUARTER_TURN))


def _tipped(motion: Motion, turn: Floats) -> Motion:
    rotations = np.array(motion.rotations)
    rotations[:, 0] = rotation.multiply(turn, rotations[:, 0])
    return Motion(
        skeleton=motion.skeleton,
        rotations=rotations,
        root_positions=rotation.rotate(turn, motion.root_positions),
        frame_rate_hz=motion.frame_rate_hz,
    )


def _joints_24(vectors: Floats) -> Floats:
    """Fill up 22 joints with SMPL's hands, which are not turned."""
    return np.concatenate((vectors, np.zeros((len(vectors), 6))), axis=1).reshape(-1, 24, 3)


def _word(value: Any) -> str:
    """Give a word stored as text, as bytes, or as bytes that were made text ("b'male'"); empty if none is."""
    if value is None or value.size != 1 or value.dtype.kind not in "SU":
        return ""
    one = value.reshape(-1)[0]
    text = (bytes(one).decode("latin-1") if value.dtype.kind == "S" else str(one)).strip().lower()
    written_bytes = re.fullmatch(r"""b(['"])(.*)\1""", text)
    return written_bytes[2].strip() if written_bytes else text
