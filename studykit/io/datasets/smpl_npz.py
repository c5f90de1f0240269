"""SMPL archives: studykit's own dances, and other programs' archives of the same few arrays."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from studykit.io.array_files import names_in, read_npz
from studykit.io.datasets.amass import Amass
from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.smpl_arrays import movement, numbers, part, rate_hz, rotation_vectors, same_length
from studykit.io.packed import files_ending
from studykit.motion.skeleton import NEUTRAL_BODY, NEUTRAL_PELVIS

_NEEDED = ("poses", "trans", "mocap_framerate")


class SmplNpz:
    """Archives of `poses` (frame, 72) in rad, `trans` (frame, 3) in m and `mocap_framerate`; Y is up."""

    name = "smpl-npz"
    citation = ""
    licence = ""
    native_format = "NumPy archives of poses (frame, 72), trans and mocap_framerate, Y up, one a dance"

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
        arrays = read_npz(path, _NEEDED)
        vectors = rotation_vectors(part(arrays, "poses", path), "poses", path)
        places = numbers(part(arrays, "trans", path), "trans", path, shape=(None, 3))
        same_length(vectors, places, "poses and trans", path)
        rate = rate_hz(part(arrays, "mocap_framerate", path), "mocap_framerate", path)
        motion = movement(vectors, places + np.array(NEUTRAL_PELVIS), rate=rate, skeleton=NEUTRAL_BODY)
        return [Performance(motion=motion)]
