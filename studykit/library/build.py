"""Building a dance library: files of takes in, clean segments with all their measures out.

Every source becomes a shard on its own, on as many processes or machines as there are; then the index is
written over them. Nothing of an older library is lost before the new one is whole.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.errors import InputError
from studykit.core.parallel import spread
from studykit.core.progress import Progress, silent
from studykit.core.provenance import sha256_of_value
from studykit.io.datasets.known import DATASETS
from studykit.io.datasets.read import find_recipe
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.take import Take
from studykit.library import index, review, shard, store
from studykit.library.measure import Decision, Measured, Settings, measured
from studykit.library.origin import Origin
from studykit.library.review import Decisions
from studykit.library.source import Source, take_files

Words = Mapping[str, Mapping[str, list[Decision]]]
"""Decisions on the takes of one source: by take, then by the reading that they were made on."""

MEASURES = 2
"""Raised when takes are read, cleaned or measured otherwise, so that older shards are made again."""


def build(
    sources: Mapping[Path, Recipe] | Iterable[str | Path] | str | Path,
    out: str | Path,
    *,
    settings: Settings | None = None,
    workers: int | None = None,
    progress: Progress = silent,
) -> DanceLibrary:
    """Build one library from folders of takes and how each is read, or bring it up to date.

    Parameters
    ----------
    sources : mapping of Path to Recipe, paths, or one path
        Folders of takes, and how each is read where `find_recipe` cannot tell. A library that is there
        already must have been built from some of them.
    out : str or Path
        The folder of the library.
    settings : Settings, optional
        The noise rule, the stride, whether mirrored segments are added; the seed of the calibration.
    workers : int, optional
        Processes; if not given, what joblib's `parallel_config` says, for example a Dask cluster.
    progress : Progress
        Told of each file.

    Raises
    ------
    InputError
        If something else is in `out`, it cannot be written, or too little is left after cleaning. A take that
        cannot be used is left out and listed in the library's table of takes with the reason.
    """
    if isinstance(sources, str | Path):
        sources = [sources]
    if not isinstance(sources, Mapping):
        sources = {Path(folder): find_recipe(Path(folder)) for folder in sources}
    folders = {Path(folder).resolve(): recipe for folder, recipe in sources.items()}
    _require_apart(Path(out).resolve(), folders)
    files = [file for folder, recipe in folders.items() for file in take_files(folder, recipe)]
    recipes = folders.values()
    origin = Origin(
        name="+".join(dict.fromkeys(recipe.data_set for recipe in recipes)),
        data_sets=tuple(dict.fromkeys(recipe.data_set for recipe in recipes)),
        citations={
            recipe.data_set: recipe.citation or DATASETS[recipe.format].citation for recipe in recipes
        },
    )
    library = build_from(files, out, origin, settings=settings, workers=workers, progress=progress)
    store.write_folders(Path(out), {str(folder): recipe for folder, recipe in folders.items()})
    return library


def _require_apart(out: Path, folders: Iterable[Path]) -> None:
    """Refuse a library within a folder of takes, or around one: what is recorded stays apart."""
    for folder in folders:
        if out == folder or out in folder.parents or folder in out.parents:
            raise InputError(
                f"the takes of {folder} and the library would lie in one another",
                where=out,
                remedy="choose a folder for the library apart from the takes",
            )


def build_from(
    sources: Sequence[Source],
    out: str | Path,
    origin: Origin,
    *,
    settings: Settings | None = None,
    workers: int | None = None,
    progress: Progress = silent,
) -> DanceLibrary:
    """Build a library from sources of any kind; see `build`.

    Parameters
    ----------
    origin : Origin
        What is written down of where the library comes from.
    """
    out = Path(out)
    settings = settings or Settings()
    names = _names(sources)
    with store.folder_to_build(out, origin):
        decisions = review.read_decisions(out)
        outcomes = progress(
            _outcomes(sources, out, settings, decisions, workers), label="Reading takes", total=len(sources)
        )
        rows = [
            told | {"name": prefix + source.name, "prefix": prefix, "data_set": source.data_set}
            for source, prefix, told in zip(sources, names, outcomes, strict=True)
        ]
        strays = _strays(decisions, rows)
        index.write(out, _without_copies(rows), origin, settings, strays=strays, progress=progress)
    return store.open_library(out)


def _outcomes(
    sources: Sequence[Source],
    out: Path,
    settings: Settings,
    decisions: Decisions,
    workers: int | None,
) -> Iterable[dict[str, Any]]:
    jobs = (
        (source, out.resolve(), settings, review.decisions_of(decisions, source.data_set, source.name))
        for source in sources
    )
    return spread(make_shard, jobs, workers=workers)


def make_shard(source: Source, out: Path, settings: Settings, decisions: Words) -> dict[str, Any]:
    """Read, clean and measure one source, unless that was done before; give what became of its takes.

    Whatever is wrong with a file is told in `refused`, so that the build can go on with the others.
    """
    try:
        key = sha256_of_value(
            {
                "measures": MEASURES,
                "source": source.digest(),
                "settings": settings.of_a_take(),
                "decisions": decisions,
            }
        )[:32]
        told = shard.outcome(out, key)
        takes = source.takes() if told is None else []
    except InputError as error:
        return _refused(error, source)
    except OSError as error:
        problem = f"cannot be read ({error.strerror or error})"
        where = str(getattr(source, "path", source.name))
        return _refused(InputError(problem, where=where, remedy="check the disk"), source)
    except Exception as error:
        error.add_note(f"while reading {source.name} of {source.data_set}")
        raise
    if told is None:
        try:
            told = shard.write(out, key, [(take, _measured(take, settings, decisions)) for take in takes])
        except OSError as error:
            raise InputError(
                f"cannot be written ({error.strerror or error})",
                where=out,
                remedy="make room and run the same build again: it goes on where it was",
            ) from error
    return told | {"key": key}


def _strays(decisions: Decisions, outcomes: Sequence[dict[str, Any]]) -> int:
    """Count the decisions on takes that are not there."""
    takes = {(told["data_set"], take["name"]) for told in outcomes for take in told["takes"]}
    return sum(len(said) for key, words in decisions.items() if key not in takes for said in words.values())


def _without_copies(outcomes: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Leave out what is the same recording as another: no movement may pass for two."""
    first: dict[str, str] = {}
    kept = []
    for told in outcomes:
        digest = told["takes"][0]["basis"] if told["takes"] else told["name"]
        other = first.setdefault(digest, told["name"])
        if other != told["name"]:
            problem = f"is the same recording as {other}"
            refused = {"problem": problem, "where": told["name"], "remedy": "remove one of them"}
            told = {name: told[name] for name in ("name", "prefix", "data_set")} | {  # noqa: PLW2901
                "refused": refused,
                "refused_at": told["name"],
                "takes": [],
            }
        kept.append(told)
    return kept


def _refused(error: InputError, source: Source) -> dict[str, Any]:
    """Write down why a file is left out; a library tells its place from the folder of takes on."""
    folder = str(getattr(source, "folder", ""))
    inside = error.where.removeprefix(folder).lstrip("/\\") if folder else error.where
    refused = {"problem": error.problem, "where": inside, "remedy": error.remedy}
    return {"refused": refused, "refused_at": error.where, "takes": []}


def _measured(take: Take, settings: Settings, decisions: Words) -> Measured:
    """Measure a take with the decisions that were made on this reading of it; count the others."""
    words = decisions.get(take.name, {})
    own = shard.basis(take)
    found = measured(take.motion, settings, words.get(own, []))
    ignored = sum(len(said) for other, said in words.items() if other != own)
    return replace(found, outcome=found.outcome | {"decisions_ignored": ignored})


def _names(sources: Sequence[Source]) -> list[str]:
    """Give what the names of each source's takes begin with where takes are of several data sets."""
    several = len({source.data_set for source in sources}) > 1
    seen: dict[tuple[str, str], Source] = {}
    for source in sources:
        other = seen.setdefault((source.data_set, source.name), source)
        if other is not source:
            raise InputError(
                f"two takes are called {source.name}",
                where=f"{getattr(other, 'path', '')} and {getattr(source, 'path', '')}",
                remedy="remove one, or give their folders a data_set each in a library.toml",
            )
    return [f"{source.data_set}/" if several else "" for source in sources]
