"""What every importer is: one shape for all collections of recorded dances."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from studykit.io.datasets.recipe import Recipe
from studykit.motion.motion import Motion


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Performance:
    """What one file holds of one dancer.

    Parameters
    ----------
    motion : Motion
        All frames of the file: SMPL's 24 joints with the bone lengths of the data set's own body, metres,
        Y up, at the data set's true rate. The root is where the pelvis is.
    dancer : str
        Tells the dancers of one file apart, such as "dancer-1"; empty where there is one.
    performer, genre : str
        Who danced what, where the data set says; empty where only a recipe can.
    notes : str
        What had to be mended to read it, such as markers lost for a moment; empty where nothing was.
    """

    motion: Motion
    dancer: str = ""
    performer: str = ""
    genre: str = ""
    notes: str = ""


class Dataset(Protocol):
    """One native format: a published data set, or a file format whose recipe says the rest.

    Everything a data set has of its own (units, axes, rates, names) is settled in its importer, once.
    """

    name: str
    """As in `format` of a recipe, such as "aistpp"."""
    citation: str
    """What its authors ask to be cited; empty for a mere file format."""
    licence: str
    """Its terms of use in one line; empty for a mere file format."""
    native_format: str
    """What its files are, in one sentence."""

    def recognises(self, folder: Path) -> bool:
        """Tell whether a folder looks like this data set as it is distributed."""
        ...

    def items(self, folder: Path) -> list[Path]:
        """List the files to read, in the order of their names; opens none of them."""
        ...

    def companions(self, path: Path) -> list[Path]:
        """List further files that reading one depends on, such as labels or a skeleton, there or not."""
        ...

    def read(self, path: Path, recipe: Recipe) -> list[Performance]:
        """Read one file: one performance for each dancer in it.

        Raises
        ------
        InputError
            If the file is not what it should be; names the file and the place in it, and the remedy.
        """
        ...
