"""Building a dance library: files of takes in, clean segments with all their measures out.

Every source becomes a shard on its own, on as many processes or machines as there are; then the index is
written over them. Nothing of an older library is lost before the new one is whole.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.core.provenance import sha256_of_value
from studykit.io.datasets.known import DATASETS
from studykit.io.datasets.read import find_recipe
from studykit.io.datasets.recipe import Recipe
from studykit.library import index, review, shard, store
from studykit.library.measure import Decision, Settings, measured
from studykit.library.origin import Origin
from studykit.library.review import Decisions
from studykit.library.source import Source, take_files

MEASURES = 1
"""Raised when takes are read, cleaned or measured otherwise, so that older shards are made again."""


def build(
    sources: Mapping[Path, Recipe] | Iterable[str | Path],
    out: str | Path,
    *,
    settings: Settings | None = None,
    workers: int | None = None,
    progress: Progress = silent,
) -> DanceLibrary:
    """Build one library from folders of takes and how each is read, or bring it up to date.

    Parameters
    ----------
    sources : mapping of Path to Recipe, or paths
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
    if not isinstance(sources, Mapping):
        sources = {Path(folder): find_recipe(Path(folder)) for folder in sources}
    files = [file for folder, recipe in sources.items() for file in take_files(Path(folder), recipe)]
    origin = Origin(
        name="+".join(dict.fromkeys(recipe.data_set for recipe in sources.values())),
        folders={
            str(Path(folder).resolve()): recipe.model_dump(mode="json", exclude_defaults=True)
            for folder, recipe in sources.items()
        },
        citations={
            recipe.data_set: recipe.citation or DATASETS[recipe.format].citation
            for recipe in sources.values()
        },
    )
    return build_from(files, out, origin, settings=settings, workers=workers, progress=progress)


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
    with store.folder_to_build(out, origin):
        decisions = review.read_decisions(out)
        outcomes = progress(
            _outcomes(sources, out, settings, decisions, workers), label="Reading takes", total=len(sources)
        )
        rows = _named(sources, outcomes)
        index.write(out, rows, origin, settings)
    return store.open_library(out)


def _outcomes(
    sources: Sequence[Source],
    out: Path,
    settings: Settings,
    decisions: Decisions,
    workers: int | None,
) -> Iterable[dict[str, Any]]:
    from joblib import Parallel, delayed

    jobs = (
        delayed(make_shard)(
            source, out.resolve(), settings, review.decisions_of(decisions, source.data_set, source.name)
        )
        for source in sources
    )
    outcomes: Iterable[dict[str, Any]] = Parallel(n_jobs=workers, return_as="generator")(jobs)
    return outcomes


def make_shard(
    source: Source, out: Path, settings: Settings, decisions: Mapping[str, list[Decision]]
) -> dict[str, Any]:
    """Read, clean and measure one source, unless that was done before; give what became of its takes.

    Whatever is wrong with a file is told in `refused`, so that the build can go on with the others.
    """
    try:
        key = sha256_of_value(
            {
                "measures": MEASURES,
                "source": source.digest(),
                "settings": settings.of_a_take(),
                "decisions": {take: [list(one) for one in words] for take, words in decisions.items()},
            }
        )[:32]
        told = shard.outcome(out, key)
        if told is None:
            takes = source.takes()
            told = shard.write(
                out,
                key,
                [(take, measured(take.motion, settings, decisions.get(take.name, []))) for take in takes],
            )
    except InputError as error:
        refused = {"problem": error.problem, "where": error.where, "remedy": error.remedy}
        return {"refused": refused, "takes": []}
    except Exception as error:
        error.add_note(f"while reading {source.name} of {source.data_set}")
        raise
    return told | {"key": key}


def _named(sources: Sequence[Source], outcomes: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Put the outcomes beside their sources; takes of several data sets are told apart by its name."""
    several = len({source.data_set for source in sources}) > 1
    out = []
    for source, told in zip(sources, outcomes, strict=True):
        prefix = f"{source.data_set}/" if several else ""
        out.append(told | {"prefix": prefix, "name": f"{prefix}{source.name}", "data_set": source.data_set})
    twice = [name for name, count in Counter(t["name"] for t in out).items() if count > 1]
    if twice:
        raise InputError(
            f"two files are called {twice[0]}",
            where="the folders of takes",
            remedy="give each folder a data_set of its own in its library.toml",
        )
    return out
