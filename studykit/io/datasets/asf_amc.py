"""ASF/AMC takes of any performer."""

from __future__ import annotations

from pathlib import Path

from studykit.core.errors import InputError
from studykit.io.asf_amc import read_asf_amc
from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.smpl_arrays import plain_stem
from studykit.io.packed import LEFT_BESIDE, PACKED, files_ending
from studykit.io.skeleton_map import to_smpl


class AsfAmcFiles:
    """Takes as AMC text beside the ASF skeletons of their performers.

    01_01.amc belongs to 01.asf, or to the only skeleton of its folder. Lengths are settled by the skeleton,
    so `units_m` stays 1. The rate is that of the recipe, else what the file says,
    else 120 Hz, as in the CMU database, whose files do not say.
    """

    name = "asf-amc"
    citation = ""
    licence = ""
    native_format = "AMC text (.amc) with the skeleton (.asf) beside it, plain or packed"

    def recognises(self, folder: Path) -> bool:
        """Tell whether a folder has takes with skeletons."""
        return bool(files_ending(folder, ".amc") and files_ending(folder, ".asf"))

    def items(self, folder: Path) -> list[Path]:
        """List the .amc files of a folder and those below it."""
        return files_ending(folder, ".amc")

    def companions(self, path: Path) -> list[Path]:
        """Give the skeleton that belongs to a take, if there is one."""
        skeletons = _skeletons(path)
        return skeletons if len(skeletons) == 1 else []

    def read(self, path: Path, recipe: Recipe) -> list[Performance]:
        """Read one take and carry it over to SMPL's joints."""
        skeletons = _skeletons(path)
        if len(skeletons) != 1:
            own = f"{_subject(path)}.asf"
            raise InputError(
                f"{len(skeletons) or 'no'} skeletons lie beside it, and none is called {own}",
                where=path,
                remedy=f"put the skeleton of its performer beside it as {own}",
            )
        rate = recipe.frame_rate(path.name)  # the recipe is settled for this one file
        take = read_asf_amc(path, skeletons[0], frame_rate_hz=rate)
        motion = to_smpl(take, recipe.skeleton or "cmu-asf", units_m=recipe.units_m)
        return [Performance(motion=motion, performer=plain_stem(skeletons[0]))]


def _subject(path: Path) -> str:
    """Give the part of a take's name that tells its performer: "01" of 01_01.amc."""
    return plain_stem(path).split("_")[0]


def _skeletons(path: Path) -> list[Path]:
    """Give the one skeleton with the name of the performer, else all that lie beside a take."""
    endings = tuple(f".asf{packed}" for packed in ("", *PACKED))
    for ending in endings:
        own = path.with_name(f"{_subject(path)}{ending}")
        if own.is_file():
            return [own]
    return sorted(
        one
        for one in path.parent.iterdir()
        if one.name.lower().endswith(endings) and not one.name.startswith(LEFT_BESIDE)
    )
