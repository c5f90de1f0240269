"""Finding and reading the files that say something about another file of a BIDS data set."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from studykit.core.errors import InputError
from studykit.recording.bids_file import MISSING

Row = dict[str, str | None]
"""One line of a table: column to cell; None where it says n/a."""


def entities(path: Path) -> dict[str, str]:
    """Give what the name of a file says about it.

    Examples
    --------
    >>> entities(Path("sub-07_task-dance_run-2_motion.tsv"))
    {'sub': '07', 'task': 'dance', 'run': '2'}
    """
    parts = path.name.split(".")[0].split("_")[:-1]
    return dict(part.split("-", 1) for part in parts if "-" in part)


def about(path: Path, root: Path, ending: str) -> tuple[Path, ...]:
    """Find the files that apply to another, by the inheritance principle of BIDS.

    Parameters
    ----------
    path : Path
        The file that is described.
    root : Path
        The data set.
    ending : str
        Suffix and extension wanted, such as ``channels.tsv``.

    Returns
    -------
    tuple of Path
        From the most general to the nearest, which counts most.
    """
    own = entities(path).items()
    folders = [root, *(path.parents[n] for n in range(len(path.relative_to(root).parents) - 2, -1, -1))]
    found: list[Path] = []
    for folder in folders:
        here = folder.glob(f"*{ending}")
        fitting = [p for p in here if entities(p).items() <= own and p.name.split("_")[-1] == ending]
        found += sorted(fitting, key=lambda p: (len(entities(p)), p.name))
    return tuple(found)


def description(path: Path, root: Path, ending: str) -> dict[str, Any]:
    """Give everything that the JSON files about another file say; nearer ones win."""
    told: dict[str, Any] = {}
    for source in about(path, root, ending):
        try:
            content = json.loads(source.read_text(encoding="utf-8"))
        except ValueError as error:
            raise InputError(f"this is no JSON ({error})", where=source, remedy="put it right") from error
        told |= content if isinstance(content, dict) else {}
    return told


def rows(path: Path) -> list[Row]:
    """Read a tab-separated table with a header.

    Raises
    ------
    InputError
        If it cannot be read, or a line has another number of cells than the header.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("the table cannot be read", where=path, remedy="put it back") from error
    if not lines:
        raise InputError("the table is empty", where=path, remedy="put its header and rows back")
    columns = lines[0].split("\t")
    table = []
    for number, line in enumerate(lines[1:], start=2):
        cells = line.split("\t")
        if len(cells) != len(columns):
            raise InputError(
                f"{len(cells)} cells stand below {len(columns)} columns",
                where=f"{path}, line {number}",
                remedy="separate them by single tabs and write n/a where nothing is known",
            )
        table.append(
            {c: None if cell in (MISSING, "") else cell for c, cell in zip(columns, cells, strict=True)}
        )
    return table


def number(row: Row, column: str, path: Path, *, line: int | None = None) -> float:
    """Give the number in a column of a row.

    Raises
    ------
    InputError
        If there is none; it names file, line and column.
    """
    try:
        return float(row[column] or "")
    except (KeyError, ValueError) as error:
        problem = f'"{column}" is missing' if row.get(column) is None else f'"{column}" is no number'
        raise InputError(
            problem,
            where=f"{path}, line {line}" if line else path,
            remedy=f"write a number in the column {column}",
        ) from error


def truth(text: str | None, *, default: bool) -> bool:
    """Read a yes or no, as written by hand or by a program."""
    return default if text is None else text.strip().lower() in ("true", "1", "1.0", "yes")
