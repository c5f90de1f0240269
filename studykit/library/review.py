"""A reviewer's words on what the noise rules flagged, kept beside a library and obeyed by its next build."""

from __future__ import annotations

import csv
import io
import math
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from studykit.core.errors import InputError
from studykit.io.datasets.take import Take
from studykit.library import shard, store
from studykit.library.measure import Decision
from studykit.library.origin import Origin
from studykit.library.source import Source, take_files

if TYPE_CHECKING:
    import pandas as pd

Decisions = Mapping[tuple[str, str], dict[str, list[Decision]]]
"""The words on each take, by data set and name, then by the reading of the take that they were said on."""

COLUMNS = ("data_set", "take", "basis", "start_s", "stop_s", "decision", "note", "reviewer")
_WORDS = ("keep", "cut", "")


def decisions_path(library: Path) -> Path:
    """Name the file of a library's decisions: beside it, so that it outlives the folder."""
    return store.beside(library, "decisions.csv")


def read_decisions(library: Path) -> Decisions:
    """Read the decisions in force, in the order in which they were made.

    Raises
    ------
    InputError
        If a line cannot be understood; names it.
    """
    found: dict[tuple[str, str], dict[str, list[Decision]]] = {}
    for row in _rows(decisions_path(library)):
        words = found.setdefault((row["data_set"], row["take"]), {}).setdefault(row["basis"], [])
        start_s, stop_s = float(row["start_s"]), float(row["stop_s"])
        words[:] = [one for one in words if (one.start_s, one.stop_s) != (start_s, stop_s)]
        if row["decision"]:
            words.append(Decision(start_s, stop_s, "keep" if row["decision"] == "keep" else "cut"))
    return {key: said for key, said in found.items() if any(said.values())}


def decisions_of(decisions: Decisions, data_set: str, source: str) -> dict[str, dict[str, list[Decision]]]:
    """Give the decisions on the takes of one source, by the name of the take."""
    return {
        take: words
        for (own, take), words in decisions.items()
        if own == data_set and (take == source or take.startswith(f"{source}/"))
    }


def _rows(path: Path) -> list[dict[str, str]]:
    if not path.exists():
        return []
    # What follows the last line end is half a line that a power cut left; it was never confirmed.
    text = path.read_text(encoding="utf-8-sig")
    rows = list(csv.DictReader(io.StringIO(text[: text.rfind("\n") + 1], newline="")))
    for number, row in enumerate(rows, 2):
        try:
            start_s, stop_s = float(row["start_s"]), float(row["stop_s"])
            good = set(row) == set(COLUMNS) and None not in row.values() and row["decision"] in _WORDS
            good = good and -math.inf < start_s < stop_s < math.inf
        except (KeyError, TypeError, ValueError):
            good = False
        if not good:
            raise InputError(
                "no decision",
                where=f"{path}, line {number}",
                remedy=f"write {', '.join(COLUMNS)}, with keep or cut as the decision",
            )
    return rows


def decide(  # noqa: PLR0913 - the words of one decision
    library: str | Path,
    *,
    take: str,
    start_s: float,
    stop_s: float,
    decision: Literal["keep", "cut", ""],
    note: str = "",
    reviewer: str = "",
) -> None:
    """Write down a decision on a stretch of a take; the next build obeys it.

    Parameters
    ----------
    library : str or Path
        The folder of the library.
    take : str
        Name of the take, as the library has it.
    start_s, stop_s : float, s
        From the beginning of what was cleaned.
    decision : {"keep", "cut", ""}
        Keep what a rule flagged, cut what none did; "" takes an earlier decision on the same stretch back.
    note, reviewer : str
        Why, and who says so.

    Raises
    ------
    InputError
        If the library has no such take, or the stretch is empty.
    """
    library = Path(library)
    if not -math.inf < start_s < stop_s < math.inf or decision not in _WORDS:
        raise InputError(
            f"{decision!r} from {start_s:g} s to {stop_s:g} s is no decision",
            where=take,
            remedy="say keep or cut, and end after the beginning",
        )
    own = _told(library, take)
    path = decisions_path(library)
    _rows(path)  # a file that cannot be read is not written to
    line = io.StringIO()
    times = (f"{start_s:.6f}", f"{stop_s:.6f}")
    csv.writer(line, lineterminator="\n").writerow(
        (own["source"]["data_set"], own["name"], own["basis"], *times, decision, note, reviewer)
    )
    with path.open("a+b") as file:
        file.seek(0)
        written = file.read()
        file.truncate(written.rfind(b"\n") + 1)
        file.write(("" if written else ",".join(COLUMNS) + "\n").encode() + line.getvalue().encode())
        file.flush()
        os.fsync(file.fileno())


def findings(library: str | Path) -> pd.DataFrame:
    """List what the noise rule flagged and what was decided, take after take.

    Parameters
    ----------
    library : str or Path
        The folder of the library.

    Returns
    -------
    DataFrame
        `take, start_s, stop_s, rule, joint, decision, note, reviewer`; a stretch that only a reviewer marked
        has the rule "by hand".
    """
    import pandas as pd

    library = Path(library)
    rows, names = [], {}
    for called, take in _takes(library):
        rows += [{"take": called, **one} for one in take["findings"]]
        names[take["source"]["data_set"], take["name"], take["basis"]] = called
    table = pd.DataFrame(rows, columns=["take", "start_s", "stop_s", "rule", "joint"])
    last: dict[tuple[str, float, float], dict[str, str]] = {}
    for row in _rows(decisions_path(library)):
        name = names.get((row["data_set"], row["take"], row["basis"]))
        if name is not None:
            key = (name, float(row["start_s"]), float(row["stop_s"]))
            last.pop(key, None)
            last[key] = row
    words = pd.DataFrame(
        [
            {"take": take, "start_s": start, "stop_s": stop}
            | {name: row[name] for name in ("decision", "note", "reviewer")}
            for (take, start, stop), row in last.items()
            if row["decision"]
        ],
        columns=["take", "start_s", "stop_s", "decision", "note", "reviewer"],
    )
    place = ["take", "start_s", "stop_s"]
    # Times were written to the microsecond.
    for own in (table, words):
        own[place[1:]] = own[place[1:]].astype(float).round(6)
    both = table.merge(words, on=place, how="outer")
    both["rule"] = both["rule"].fillna("by hand")
    return both.fillna("").sort_values([*place, "rule"], ignore_index=True)


def take_again(library: str | Path, name: str) -> Take:
    """Read a take of a library from its source again, to look at it.

    Raises
    ------
    InputError
        If the library has no such take, or its source is no longer where it was.
    """
    library = Path(library)
    told = _told(library, name)
    own = told["name"]
    for source in _sources(library, told["source"]["data_set"]):
        if own == source.name or own.startswith(f"{source.name}/"):
            for take in source.takes():
                if take.name == own:
                    return take
    raise InputError(f"the source of {name} is gone", where=library, remedy="bring it back to where it was")


def _sources(library: Path, data_set: str) -> Iterator[Source]:
    from studykit.library.sample import synthetic_takes  # which builds, and building asks for decisions

    origin = Origin(**store.read_manifest(library)["origin"])
    if origin.synthetic is not None:
        yield from synthetic_takes(**origin.synthetic)
    for folder, recipe in store.read_folders(library).items():
        if recipe.data_set == data_set:
            yield from take_files(Path(folder), recipe)


def _takes(library: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    """Give every take of a library: its name there, and what its shard says of it."""
    for key, one in store.read_shards(store.index_folder(library)).items():
        for take in shard.told(library, key)["takes"]:
            yield one["prefix"] + take["name"], take


def _told(library: Path, take: str) -> dict[str, Any]:
    """Give what the shard of a take says of it."""
    for name, told in _takes(library):
        if name == take:
            return told
    raise InputError(
        f"there is no take {take!r}", where=library, remedy="see 'studykit library info --takes'"
    )
