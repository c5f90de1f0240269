"""How the takes of a folder are read: format, rates, skeletons, performers, genres."""

from __future__ import annotations

from fnmatch import fnmatch
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

FILE_NAME = "library.toml"

Rate = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class TakeRule(BaseModel):
    """What is true of the takes whose path matches."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    match: str
    """Pattern of the path within the folder, without .xz or .gz, such as "salsa/*"."""
    genre: str = ""
    """What was danced; empty where the data set itself says."""
    performer: str = ""
    """Who danced; empty where the data set itself says."""
    frame_rate_hz: Rate | None = None
    """The true rate where the one in the file is wrong."""


class Recipe(BaseModel):
    """How a folder of takes becomes a library."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    data_set: str
    format: str = "bvh"
    """Name of the importer, see `studykit.io.datasets.known.DATASETS`."""
    licence: str = ""
    """Terms of use; those of the importer's data set if not given."""
    citation: str = ""
    skeleton: str = ""
    """Whose joints or markers the files have: a built-in map, or a map file beside the recipe."""
    units_m: Annotated[float, Field(ge=1e-6, le=1000.0, allow_inf_nan=False)] = 1.0
    """The unit of length of the files, in metres."""
    up: Literal["Y", "Z"] = "Y"
    """Which axis of the files points up, where the format leaves it open."""
    is_synthetic: bool = False
    """Whether nobody danced these takes."""
    skip_frames: Annotated[int, Field(ge=0)] = 0
    """Frames to leave out at the start of each file, such as an added T-pose."""
    recognised_by: tuple[str, ...] = ()
    """Files by which a folder without a library.toml is known as this data set."""
    frame_rates_hz: dict[str, Rate] = Field(default_factory=dict)
    """True rates by pattern; they go before those of the takes."""
    groups: tuple[tuple[str, ...], ...] = ()
    """Names of takes danced together on one time line, such as ["salsa/01", "salsa/16"]."""
    takes: tuple[TakeRule, ...] = ()
    """The takes that are meant; the first match counts. All of them if there is no rule."""

    def frame_rate(self, path: str) -> float | None:
        """Give the true rate of a take, Hz, or None where that in its file is right."""
        rates = [rate for pattern, rate in self.frame_rates_hz.items() if fnmatch(path, pattern)]
        rule = self.rule(path)
        return rates[0] if rates else (rule.frame_rate_hz if rule else None)

    def rule(self, path: str) -> TakeRule | None:
        """Give the first rule that matches a take's path, or None if the take is not meant."""
        if not self.takes:
            return TakeRule(match="*")
        return next((rule for rule in self.takes if fnmatch(path, rule.match)), None)

    def settled(self, path: str) -> Recipe:
        """Give the recipe as it holds for one take, so that its importer needs no place in the folder."""
        rate = self.frame_rate(path)
        return self.model_copy(update={"takes": (), "frame_rates_hz": {} if rate is None else {"*": rate}})

    def partners(self, name: str) -> tuple[str, ...]:
        """Name the takes danced together with one."""
        return tuple(other for group in self.groups if name in group for other in group if other != name)


def built_in_recipes() -> dict[str, Path]:
    """Name the recipes that come with studykit."""
    folder = Path(str(files("studykit.io.datasets") / "recipes"))
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}
