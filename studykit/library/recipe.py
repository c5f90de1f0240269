"""How the takes of a folder are read: rates, skeletons, performers, genres."""

from __future__ import annotations

from fnmatch import fnmatch
from importlib.resources import files
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from studykit.core.errors import InputError
from studykit.io.skeleton_map import SKELETON_MAPS
from studykit.io.toml_file import read_model

FILE_NAME = "library.toml"


class TakeRule(BaseModel):
    """What is true of the takes whose path matches."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    match: str
    """Pattern of the path within the folder, without .xz or .gz, such as "salsa/*"."""
    genre: str
    performer: str
    frame_rate_hz: Annotated[float, Field(gt=0)] | None = None
    """The true rate where the one in the file is wrong."""


class Recipe(BaseModel):
    """How a folder of takes becomes a library."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    data_set: str
    licence: str
    skeleton: str
    units_m: Annotated[float, Field(gt=0)]
    """The unit of length of the files, in metres."""
    skip_frames: Annotated[int, Field(ge=0)] = 0
    """Frames to leave out at the start of each file, such as an added T-pose."""
    recognised_by: tuple[str, ...] = ()
    """Files by which a folder without a library.toml is known as this data set."""
    frame_rates_hz: dict[str, Annotated[float, Field(gt=0)]] = Field(default_factory=dict)
    """True rates by pattern; they go before those of the takes."""
    takes: tuple[TakeRule, ...]

    def frame_rate(self, name: str) -> float | None:
        """Give the true rate of a take, Hz, or None where that in its file is right."""
        rates = [rate for pattern, rate in self.frame_rates_hz.items() if fnmatch(name, pattern)]
        rule = self.rule(name)
        return rates[0] if rates else (rule.frame_rate_hz if rule else None)

    def rule(self, name: str) -> TakeRule | None:
        """Give the first rule that matches a take's path, or None if the take is not meant."""
        return next((rule for rule in self.takes if fnmatch(name, rule.match)), None)


def built_in_recipes() -> dict[str, Path]:
    """Name the recipes that come with studykit."""
    folder = Path(str(files("studykit.library") / "recipes"))
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}


def find_recipe(folder: Path) -> Recipe:
    """Find how to read a folder: its own library.toml, or a built-in recipe that knows its files.

    Raises
    ------
    InputError
        If there is no such folder, it has neither, or the recipe has a mistake.
    """
    if not folder.is_dir():
        raise InputError("there is no such folder", where=folder, remedy="check the path")
    own = folder / FILE_NAME
    if own.exists():
        return _checked(read_model(own, Recipe), own)
    for path in built_in_recipes().values():
        recipe = _checked(read_model(path, Recipe), path)
        if recipe.recognised_by and all(any(folder.glob(f"{name}*")) for name in recipe.recognised_by):
            return recipe
    raise InputError(
        "nothing says how to read these takes",
        where=folder,
        remedy=f"put a {FILE_NAME} beside them or give --skeleton (and --fps where a file's rate is wrong)",
    )


def _checked(recipe: Recipe, path: Path) -> Recipe:
    if recipe.skeleton not in SKELETON_MAPS:
        raise InputError(
            f"skeleton: there is no {recipe.skeleton!r}",
            where=path,
            remedy=f"choose {' or '.join(SKELETON_MAPS)}",
        )
    return recipe
