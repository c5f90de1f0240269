"""SMPL archives: studykit's own dances, and other programs' archives of the same few arrays."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studykit.core.arrays import Floats
from studykit.io.array_files import names_in, read_npz
from studykit.io.datasets.amass import Amass, y_up, z_up
from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.smpl_arrays import movement, numbers, part, rate_hz, rotation_vectors, same_length
from studykit.io.packed import files_ending
from studykit.motion import rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY, NEUTRAL_PELVIS

_NEEDED = ("poses", "trans", "mocap_framerate")

_SMPLH_JOINTS = 52
_BODY_JOINTS = 22
_KNUCKLES = {22: (22, 25, 28, 31), 23: (37, 40, 43, 46)}
"""SMPL turns all fingers of a hand at once: the first joints of the four fingers of SMPL-H."""


class SmplNpz:
    """Archives of `poses` in rad, `trans` (frame, 3) in m and `mocap_framerate`.

    Poses of 156 numbers are of SMPL-H with Z up, as in AMASS; a hand turns as its index finger does. Poses of
    72 are of SMPL's 24 joints with Y up.
    """

    name = "smpl-npz"
    citation = ""
    licence = ""
    native_format = (
        "NumPy archives of poses (frame, 156) with Z up or (frame, 72) with Y up, trans, mocap_framerate"
    )

    def recognises(self, folder: Path) -> bool:
        """Tell whether a folder itself has an archive with those arrays that is not one of AMASS."""
        first = next((path for path in sorted(folder.glob("*.npz")) if path.is_file()), None)
        return first is not None and not Amass().recognises(folder) and set(_NEEDED) <= names_in(first)

    def items(self, folder: Path) -> list[Path]:
        """List the archives of a folder and those below it."""
        return files_ending(folder, ".npz")

    def companions(self, path: Path) -> list[Path]:  # noqa: ARG002
        """List nothing: a file stands alone."""
        return []

    def read(self, path: Path, recipe: Recipe) -> list[Performance]:  # noqa: ARG002
        """Read one dance."""
        return [Performance(motion=read_smpl_npz(path))]


def read_smpl_npz(path: Path) -> Motion:
    """Read the movement of one archive; see `SmplNpz`.

    Raises
    ------
    InputError
        If the file is broken or an array is missing, of another shape or not of finite numbers.
    """
    arrays = read_npz(path, _NEEDED)
    poses = part(arrays, "poses", path)
    is_smplh = poses.shape[1:] == (3 * _SMPLH_JOINTS,)
    vectors = _of_smplh(poses, path) if is_smplh else rotation_vectors(poses, "poses", path)
    places = numbers(part(arrays, "trans", path), "trans", path, shape=(None, 3))
    same_length(vectors, places, "poses and trans", path)
    rate = rate_hz(part(arrays, "mocap_framerate", path), "mocap_framerate", path)
    motion = movement(vectors, places + np.array(NEUTRAL_PELVIS), rate=rate, skeleton=NEUTRAL_BODY)
    return y_up(motion) if is_smplh else motion


def _of_smplh(poses: NDArray[Any], path: Path) -> Floats:
    """Give the rotation vectors of SMPL's 24 joints from those of SMPL-H, shape (frame, 24, 3), rad."""
    vectors = numbers(poses, "poses", path, shape=(None, 3 * _SMPLH_JOINTS)).reshape(-1, _SMPLH_JOINTS, 3)
    return vectors[:, [*range(_BODY_JOINTS), *(fingers[0] for fingers in _KNUCKLES.values())]]


def amass_arrays(motion: Motion) -> dict[str, Any]:
    """Give a movement as the arrays of an AMASS archive (SMPL-H, neutral mean shape, Z up).

    Returns
    -------
    dict of str to ndarray
        `poses` (frame, 156), rad: root, 21 joints of the body, 15 of each hand, of which the first joints
        of the four fingers turn as the hand does; `trans` (frame, 3), m; `betas` (16,) and `dmpls`
        (frame, 8), all zero; `gender`; `mocap_framerate`, Hz.
    """
    standing = z_up(motion)
    vectors = rotation.log(standing.rotations)
    poses = np.zeros((len(motion), _SMPLH_JOINTS, 3))
    poses[:, :_BODY_JOINTS] = vectors[:, :_BODY_JOINTS]
    for hand, fingers in _KNUCKLES.items():
        poses[:, fingers] = vectors[:, hand, None]
    return {
        "poses": poses.reshape(len(motion), -1),
        "trans": standing.root_positions - np.array(NEUTRAL_PELVIS),
        "betas": np.zeros(16),
        "dmpls": np.zeros((len(motion), 8)),
        "gender": np.array("neutral"),
        "mocap_framerate": np.array(motion.frame_rate_hz),
    }
