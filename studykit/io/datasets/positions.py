"""Tables of where SMPL's joints are."""

from __future__ import annotations

import re
import warnings
from contextlib import suppress
from pathlib import Path

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.io.bvh import LARGEST, MOST_NUMBERS
from studykit.io.datasets.aistpp import genre_of, performer_of
from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.fitted_body import fitted_motion, upright
from studykit.io.datasets.recipe import Recipe
from studykit.io.packed import files_ending, read_text
from studykit.motion.inverse_kinematics import measured_body
from studykit.motion.skeleton import AIST_BODY, JOINT_NAMES, NEUTRAL_BODY, Skeleton

FRAME_RATE_HZ = 30.0
"""Files do not say; a recipe may."""
MOST_ERROR_M = 0.02
"""Joints of SMPL are those of a body: one with the right bones fits them closely."""
BODIES: dict[str, Skeleton] = {"": NEUTRAL_BODY, "smpl": NEUTRAL_BODY, "aist": AIST_BODY}
"""The rest poses that a recipe's `skeleton` may name; the lengths of bones are measured in any case."""

_SEQUENCE = re.compile(r"g[A-Z]{2}_s[A-Z]{2}_c[A-Za-z0-9]+_d\d{2}_m[A-Z]{2}\d_ch\d{2}")
_COLUMNS = 3 * len(JOINT_NAMES)
_AGAIN = f"write {_COLUMNS} numbers a row: x, y, z of SMPL's {len(JOINT_NAMES)} joints"


class JointTables:
    """Positions of SMPL's 24 joints, a row a frame, without header; turns are found from them.

    The recipe says the unit, which axis is up, the frame rate if it is not 30 Hz and, as `skeleton`, the body
    ("aist" for the one of AIST++). What positions cannot show, the twist of forearms and of the head, stays
    as it is at rest. File names of AIST tell dancer and genre.
    """

    name = "positions"
    citation = ""
    licence = ""
    native_format = "Comma-separated rows of 24 joints x (x, y, z) without header (.csv), 30 frames a second"

    def recognises(self, folder: Path) -> bool:  # noqa: ARG002
        """Give False: a recipe must say unit and axes."""
        return False

    def items(self, folder: Path) -> list[Path]:
        """List the .csv files of a folder and those below it."""
        return files_ending(folder, ".csv")

    def companions(self, path: Path) -> list[Path]:  # noqa: ARG002
        """Give nothing: a table stands alone."""
        return []

    def read(self, path: Path, recipe: Recipe) -> list[Performance]:
        """Read one table and fit a body to it."""
        if recipe.skeleton not in BODIES:
            remedy = f"choose {' or '.join(name for name in BODIES if name)}"
            raise InputError(f"no body called {recipe.skeleton!r}", where="skeleton", remedy=remedy)
        rate = recipe.frame_rate(path.name) or FRAME_RATE_HZ
        positions = upright(_table(path) * recipe.units_m, recipe.up)
        body = measured_body(positions, BODIES[recipe.skeleton])
        motion = fitted_motion(positions, body, rate_hz=rate, path=path, most_error_m=MOST_ERROR_M)
        sequence = _SEQUENCE.search(path.name)
        if sequence is None:
            return [Performance(motion=motion)]
        name = Path(sequence[0])
        return [Performance(motion=motion, performer=performer_of(name), genre=genre_of(name))]


def _table(path: Path) -> Floats:
    """Read the rows, shape (frame, 24, 3), in the file's unit and axes."""
    rows = [
        (number, line) for number, line in enumerate(read_text(path).splitlines(), start=1) if line.strip()
    ]
    if not rows:
        raise InputError("the file is empty", where=path, remedy=_AGAIN)
    if len(rows) * _COLUMNS > MOST_NUMBERS:
        raise InputError("more frames than a take has", where=path, remedy="cut it into several")
    values = np.empty(0)
    with suppress(ValueError, DeprecationWarning), warnings.catch_warnings(action="error"):
        values = np.fromstring(",".join(line for _, line in rows), sep=",", dtype=np.float64)
    if (
        values.size != len(rows) * _COLUMNS
        or any(line.count(",") != _COLUMNS - 1 for _, line in rows)
        or not np.all(np.abs(values) <= LARGEST)
    ):
        values = np.array([_row(path, number, line) for number, line in rows])  # such as digits of Arabic
    return values.reshape(len(rows), len(JOINT_NAMES), 3)


def _row(path: Path, number: int, line: str) -> list[float]:
    try:
        values = [float(cell) for cell in line.split(",")]
    except ValueError:
        values = []
    if len(values) != _COLUMNS or not all(abs(value) <= LARGEST for value in values):
        problem = f"not {_COLUMNS} finite numbers between commas"
        raise InputError(problem, where=f"{path}, line {number}", remedy=_AGAIN)
    return values
