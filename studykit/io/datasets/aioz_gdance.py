"""AIOZ-GDANCE: groups of two to seven dancers on one time line, fitted with SMPL."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.smpl_arrays import movement, numbers, part
from studykit.io.packed import files_ending
from studykit.io.restricted_pickle import read_pickle
from studykit.motion.skeleton import NEUTRAL_BODY, NEUTRAL_PELVIS

FRAME_RATE_HZ = 30.0
_BODY_NUMBERS = 69


class AiozGdance:
    """The group dances of AIOZ-GDANCE: folder `motions_smpl`, one pickle a group.

    A file has `smpl_poses` (dancer, frame, 72) in rad and `root_trans` (dancer, frame, 3) in metres, Y up.
    Some have `smpl_poses` without the root, and perhaps without the hands, and the root in `smpl_orients`;
    joints that are not there are not turned. No gender is stated: the neutral body is taken, as in the
    authors' own skeleton. The files do not say the style; rules of a recipe do.
    """

    name = "aioz-gdance"
    citation = "AIOZ-GDANCE: N. Le, T. Pham, T. Do, E. Tjiputra, Q. D. Tran, A. Nguyen, CVPR 2023."
    licence = "Research only, no distribution: neither the files nor what is made of them may be passed on"
    native_format = "Pickles of SMPL parameters of several dancers, motions_smpl/*.pkl, 30 frames a second"

    def recognises(self, folder: Path) -> bool:
        """Tell whether a folder has pickles in a folder `motions_smpl`, or is that."""
        base = folder if folder.name == "motions_smpl" else folder / "motions_smpl"
        return bool(files_ending(base, ".pkl"))

    def items(self, folder: Path) -> list[Path]:
        """List the groups."""
        base = folder / "motions_smpl"
        return files_ending(base if base.is_dir() else folder, ".pkl")

    def companions(self, path: Path) -> list[Path]:  # noqa: ARG002
        """List nothing: a file stands alone."""
        return []

    def read(self, path: Path, recipe: Recipe) -> list[Performance]:  # noqa: ARG002
        """Read one group: a performance for each dancer."""
        values = read_pickle(path)
        poses = _poses(values, path)
        places = numbers(
            part(values, "root_trans", path), "root_trans", path, shape=(None, None, 3), frame_axis=1
        )
        if poses.shape[:2] != places.shape[:2]:
            problem = f"smpl_poses and root_trans have the shapes {poses.shape} and {places.shape}"
            raise InputError(problem, where=path, remedy="export the file again")
        return [
            Performance(
                motion=movement(
                    vectors.reshape(-1, 24, 3),
                    root + np.array(NEUTRAL_PELVIS),
                    rate=FRAME_RATE_HZ,
                    skeleton=NEUTRAL_BODY,
                ),
                dancer=f"dancer-{number}",
            )
            for number, (vectors, root) in enumerate(zip(poses, places, strict=True), start=1)
        ]


def _poses(values: Any, path: Path) -> Floats:
    """Give the rotation vectors of all dancers, shape (dancer, frame, 72), rad."""
    stored = part(values, "smpl_poses", path)
    if "smpl_orients" not in values:
        return numbers(stored, "smpl_poses", path, shape=(None, None, 72), frame_axis=1)
    body = numbers(stored, "smpl_poses", path, shape=(None, None, None), frame_axis=1)
    root = numbers(values["smpl_orients"], "smpl_orients", path, shape=(None, None, 3), frame_axis=1)
    if body.shape[2] == _BODY_NUMBERS + 3:
        return body
    if body.shape[2] > _BODY_NUMBERS or body.shape[2] % 3 or body.shape[:2] != root.shape[:2]:
        problem = f"smpl_poses and smpl_orients have the shapes {body.shape} and {root.shape}"
        raise InputError(problem, where=path, remedy="check that it belongs to the data set")
    missing = np.zeros((*body.shape[:2], _BODY_NUMBERS - body.shape[2]))
    return np.concatenate((root, body, missing), axis=2)
