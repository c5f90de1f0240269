"""What a library is built from: files of takes, each with what reading it depends on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from studykit.core.provenance import sha256_of_file, sha256_of_value
from studykit.io.datasets.known import DATASETS
from studykit.io.datasets.read import files_in, plain_path, read_takes, take_name
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.take import Take

# What a recipe says of other files, too: a new rule for one take must not read the others again.
_NOT_OF_ONE_FILE = {"takes", "frame_rates_hz", "groups", "recognised_by", "citation", "skeleton"}


class Source(Protocol):
    """Something that gives takes; small, so that it can be sent to another process or machine."""

    @property
    def name(self) -> str:
        """What its takes' names begin with."""
        ...

    @property
    def data_set(self) -> str:
        """The data set that it belongs to."""
        ...

    def digest(self) -> str:
        """Give the digest of everything that its takes depend on."""
        ...

    def takes(self) -> list[Take]:
        """Read the takes."""
        ...


@dataclass(frozen=True, kw_only=True, slots=True)
class TakeFile:
    """One file of a folder of takes.

    Parameters
    ----------
    path : Path
        The file.
    folder : Path
        The folder that was given.
    recipe : Recipe
        How it is read.
    """

    path: Path
    folder: Path
    recipe: Recipe

    @property
    def name(self) -> str:
        """The path within the folder, without its endings."""
        return take_name(self.path, self.folder)

    @property
    def data_set(self) -> str:
        """The data set of the recipe."""
        return self.recipe.data_set

    def digest(self) -> str:
        """Digest the file, what is read along with it, and what the recipe says of it."""
        recipe, plain = self.recipe, plain_path(self.path, self.folder)
        rule, own_map = recipe.rule(plain), Path(recipe.skeleton)
        companions = DATASETS[recipe.format].companions(self.path)
        return sha256_of_value(
            {
                "name": self.name,
                "file": sha256_of_file(self.path),
                "companions": {one.name: sha256_of_file(one) for one in companions if one.exists()},
                "recipe": recipe.model_dump(mode="json", exclude=_NOT_OF_ONE_FILE),
                "skeleton": sha256_of_file(own_map) if own_map.is_file() else recipe.skeleton,
                "rule": [rule.model_dump(mode="json") if rule else None, recipe.frame_rate(plain)],
                "groups": [
                    group
                    for group in recipe.groups
                    if any(name == self.name or name.startswith(f"{self.name}/") for name in group)
                ],
            }
        )

    def takes(self) -> list[Take]:
        """Read the file."""
        return read_takes(self.path, self.folder, self.recipe)


def take_files(folder: Path, recipe: Recipe) -> list[TakeFile]:
    """List the files of a folder that a recipe means; see `files_in`."""
    return [TakeFile(path=path, folder=folder, recipe=recipe) for path in files_in(folder, recipe)]
