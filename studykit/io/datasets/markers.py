"""Tables of optical markers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.fitted_body import fitted_motion, upright
from studykit.io.datasets.recipe import Recipe
from studykit.io.marker_map import joints_of, marker_map
from studykit.io.marker_table import read_marker_table
from studykit.io.packed import files_ending

MOST_ERROR_M = 0.03
"""Skin moves on bone and joints lie within: a body fits markers to some millimetres at best."""


class MarkerTables:
    """Where optical markers on a dancer were; the recipe says which set of markers it is.

    The body has the bone lengths of the dancer, the median over the take.
    """

    name = "markers"
    citation = ""
    licence = ""
    native_format = "Qualisys tables of markers (.tsv), plain or packed: header lines, then a row a frame"

    def recognises(self, folder: Path) -> bool:  # noqa: ARG002
        """Give False: a recipe must say which markers they are, and their unit."""
        return False

    def items(self, folder: Path) -> list[Path]:
        """List the .tsv files of a folder and those below it."""
        return files_ending(folder, ".tsv")

    def companions(self, path: Path) -> list[Path]:  # noqa: ARG002
        """Give nothing: a table stands alone."""
        return []

    def read(self, path: Path, recipe: Recipe) -> list[Performance]:
        """Read one table and fit a body to it."""
        chosen = marker_map(recipe.skeleton)
        rate = recipe.frame_rate(path.name)  # the recipe is settled for this one file
        table = read_marker_table(path, used=chosen.markers, frame_rate_hz=rate)
        joints, body = joints_of(table, chosen, path)
        positions = upright(joints * recipe.units_m, recipe.up)
        body = replace(body, offsets=body.offsets * recipe.units_m)
        motion = fitted_motion(
            positions, body, rate_hz=table.frame_rate_hz, path=path, most_error_m=MOST_ERROR_M
        )
        lost = ", ".join(f"{marker} {frames}" for marker, frames in table.gaps.items() if frames)
        return [Performance(motion=motion, notes=f"frames filled in: {lost}" if lost else "")]
