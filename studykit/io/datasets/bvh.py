"""BVH files of any skeleton that a map knows."""

from __future__ import annotations

from pathlib import Path

from studykit.io.bvh import read_bvh
from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.recipe import Recipe
from studykit.io.packed import files_ending
from studykit.io.skeleton_map import to_smpl


class BvhFiles:
    """Takes as BVH text; the recipe says whose joints they have and which rates are wrong."""

    name = "bvh"
    citation = ""
    licence = ""
    native_format = "BVH text, plain or packed (.xz, .gz): one file a take, angles in degrees"

    def recognises(self, folder: Path) -> bool:  # noqa: ARG002
        """Give False: any skeleton may be in a BVH file, so a recipe must say which."""
        return False

    def items(self, folder: Path) -> list[Path]:
        """List the .bvh files of a folder and those below it."""
        return files_ending(folder, ".bvh")

    def companions(self, path: Path) -> list[Path]:  # noqa: ARG002
        """Give nothing: a BVH file says all of itself."""
        return []

    def read(self, path: Path, recipe: Recipe) -> list[Performance]:
        """Read one take and carry it over to SMPL's joints."""
        return [Performance(motion=to_smpl(read_bvh(path), recipe.skeleton, units_m=recipe.units_m))]
