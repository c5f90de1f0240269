"""Tables of optical markers as tab-separated text, as Qualisys and the MoCap Toolbox write them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.io.bvh import LARGEST, MOST_NUMBERS
from studykit.io.gaps import filled
from studykit.io.packed import read_text

MOST_MARKERS = 1000

_AGAIN = "export the take again as TSV"
_LONGEST_HEADER = 50


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
        As the file says.
    gaps : dict of str to int
        How many frames were filled for each marker that was ever lost.
    """

    names: tuple[str, ...]
    positions: Floats
    frame_rate_hz: float
    gaps: dict[str, int]


def read_marker_table(path: Path) -> MarkerTable:
    """Read a table of markers (.tsv), plain or packed.

    A marker was lost where its cells are empty or NaN, or all three are 0.

    Raises
    ------
    InputError
        If the table is broken or a marker is lost for too long; names the file and the line.
    """
    lines = read_text(path).splitlines()
    header, first = _header(path, lines)
    names = header["MARKER_NAMES"][0]
    rate = _number(path, header, "FREQUENCY")
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
    values = np.array([_row(path, number, line, 3 * len(names)) for number, line in rows])
    positions = values.reshape(len(rows), len(names), 3)
    positions[np.all(positions == 0.0, axis=-1)] = np.nan
    blind = np.flatnonzero(np.all(np.isnan(positions).any(axis=-1), axis=1))
    if len(blind):
        raise InputError("no marker was seen", where=f"{path}, line {rows[blind[0]][0]}", remedy=_AGAIN)
    positions, gaps = filled(positions, names, rate, path)
    return MarkerTable(names=names, positions=positions, frame_rate_hz=rate, gaps=gaps)


def _header(path: Path, lines: list[str]) -> tuple[dict[str, tuple[tuple[str, ...], int]], int]:
    """Read the lines up to the names of the markers; give their cells by keyword, and where rows begin."""
    header: dict[str, tuple[tuple[str, ...], int]] = {}
    for number, line in enumerate(lines[:_LONGEST_HEADER], start=1):
        keyword, *cells = line.rstrip("\t\r").split("\t")
        header[keyword.strip()] = (tuple(cell.strip() for cell in cells), number)
        if keyword.strip() == "MARKER_NAMES":
            return header, number
    raise InputError("no table of markers: no line begins with MARKER_NAMES", where=path, remedy=_AGAIN)


def _number(path: Path, header: dict[str, tuple[tuple[str, ...], int]], keyword: str) -> float:
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
