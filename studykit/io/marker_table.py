"""Tables of optical markers as tab-separated text, as Qualisys and the MoCap Toolbox write them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.io.bvh import LARGEST, MOST_NUMBERS
from studykit.io.gaps import filled
from studykit.io.packed import read_lines

MOST_MARKERS = 1000

_AGAIN = "export the take again as TSV"
_LONGEST_HEADER = 50
_BEFORE_MARKERS = ("FRAME", "TIME")
"""Columns that may stand before those of the markers, where a line of headings names them."""

Header = dict[str, tuple[tuple[str, ...], int]]
"""The cells behind each keyword, and the number of their line."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MarkerTable:
    """Where every marker was, short gaps filled.

    Parameters
    ----------
    names : tuple of str
        The markers.
    positions : ndarray, shape (frame, marker, 3)
        In the unit and the axes of the file.
    frame_rate_hz : float
        As the file says, unless the caller knows better.
    gaps : dict of str to int
        How many frames were filled for each marker that was ever lost.
    """

    names: tuple[str, ...]
    positions: Floats
    frame_rate_hz: float
    gaps: dict[str, int]


def read_marker_table(
    path: Path, *, used: Collection[str] | None = None, frame_rate_hz: float | None = None
) -> MarkerTable:
    """Read a table of markers (.tsv), plain or packed.

    A marker was lost where its cells are empty or NaN, or all three are 0.

    Parameters
    ----------
    path : Path
        The file.
    used : collection of str, optional
        The markers to keep, so that gaps of others do no harm; all of them if not given.
    frame_rate_hz : float, optional
        The true rate; the file's own FREQUENCY is then not looked at.

    Raises
    ------
    InputError
        If the table is broken or a marker is lost for too long; names the file and the line.
    """
    lines = read_lines(path)
    header, first = _header(path, lines)
    names = header["MARKER_NAMES"][0]
    rate = _number(path, header, "FREQUENCY") if frame_rate_hz is None else frame_rate_hz
    frames = _number(path, header, "NO_OF_FRAMES")
    rows = [(number, line) for number, line in enumerate(lines[first:], start=first + 1) if line.strip()]
    place = f"{path}, line {header['MARKER_NAMES'][1]}"
    if not 1 <= len(names) <= MOST_MARKERS or len(set(names)) != len(names):
        problem = f"{len(names)} marker names, not all different or too many"
        raise InputError(problem, where=place, remedy=_AGAIN)
    if len(rows) != frames or not rows:
        raise InputError(f"{frames:.12g} frames promised, {len(rows)} found", where=path, remedy=_AGAIN)
    if len(rows) * 3 * len(names) > MOST_NUMBERS:
        raise InputError("more numbers than a take has", where=path, remedy=_AGAIN)
    before = _columns_before(header, rows[0][1], 3 * len(names))
    values = np.array([_row(path, number, line, before + 3 * len(names)) for number, line in rows])
    positions = values[:, before:].reshape(len(rows), len(names), 3)
    positions[np.all(positions == 0.0, axis=-1)] = np.nan
    blind = np.flatnonzero(np.all(np.isnan(positions).any(axis=-1), axis=1))
    if len(blind):
        raise InputError("no marker was seen", where=f"{path}, line {rows[blind[0]][0]}", remedy=_AGAIN)
    kept = [number for number, name in enumerate(names) if used is None or name in used]
    names = tuple(names[number] for number in kept)
    positions, gaps = filled(positions[:, kept], names, rate, path)
    return MarkerTable(names=names, positions=positions, frame_rate_hz=rate, gaps=gaps)


def _header(path: Path, lines: list[str]) -> tuple[Header, int]:
    """Read the lines before the first row of numbers; give their cells by keyword, and where rows begin."""
    header: Header = {}
    first = 0
    for number, line in enumerate(lines[:_LONGEST_HEADER], start=1):
        if "MARKER_NAMES" in header and _begins_with_number(line):
            break
        keyword, *cells = (cell.strip() for cell in line.rstrip("\t\r").split("\t"))
        header.setdefault(keyword, (tuple(cells), number))
        first = number
    if "MARKER_NAMES" not in header:
        raise InputError("no table of markers: no line begins with MARKER_NAMES", where=path, remedy=_AGAIN)
    return header, first


def _begins_with_number(line: str) -> bool:
    """Tell whether a line is a row, even one with decimal commas, which is refused as a row."""
    try:
        float(line.strip().split("\t")[0].replace(",", "."))
    except ValueError:
        return False
    return True


def _columns_before(header: Header, row: str, columns: int) -> int:
    """Count the columns before those of the markers: the number of the frame, the time, or both."""
    for keyword, (cells, _) in header.items():
        words = [cell.upper().split(maxsplit=1)[:1] for cell in (keyword, *cells)[: len(_BEFORE_MARKERS)]]
        if words[0] and words[0][0] in _BEFORE_MARKERS:
            named = 2 if len(words) > 1 and words[1] and words[1][0] in _BEFORE_MARKERS else 1
            return named if len(row.split("\t")) >= columns + named else 0
    return 0


def _number(path: Path, header: Header, keyword: str) -> float:
    cells, line = header.get(keyword, ((), 1))
    try:
        value = float(cells[0])
    except (IndexError, ValueError):
        value = np.nan
    if not 0.0 < value <= LARGEST:
        raise InputError(f"no {keyword} above zero", where=f"{path}, line {line}", remedy=_AGAIN)
    return value


def _row(path: Path, number: int, line: str, columns: int) -> Floats:
    cells = line.rstrip("\r\n").split("\t")
    if len(cells) > columns and not "".join(cells[columns:]).strip():
        cells = cells[:columns]  # a tab at the end
    try:
        values = np.array([cell.strip() or "nan" for cell in cells], dtype=np.float64)
    except ValueError:
        values = np.empty(0)
    if len(values) != columns or np.any(np.abs(values) > LARGEST):
        problem = f"not {columns} numbers"
        raise InputError(problem, where=f"{path}, line {number}", remedy=_AGAIN)
    return values
