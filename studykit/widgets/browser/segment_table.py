"""The segments of a library as a table that can be filtered, sorted and read a page at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Final

import numpy as np

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.arrays import Floats, Integers
from studykit.core.errors import InputError
from studykit.motion.body import DEFAULT_BODY_MASS_KG

CHOICES: Final = ("genre", "performer", "data_set")
"""The columns of which one value can be asked for."""
COLUMNS: Final = (
    ("take", "take", False),
    ("start_s", "start, s", True),
    ("genre", "genre", False),
    ("performer", "performer", False),
    ("data_set", "data set", False),
    ("linear_j", "linear, J", True),
    ("rotational_j", "rotational, J", True),
    ("licence", "licence", False),
)
"""Name, words at its head, and whether it holds numbers."""
DIRECTIONS: Final = ("ascending", "descending")


@dataclass(frozen=True, kw_only=True, slots=True)
class Filters:
    """Which segments are asked for; an empty word or no number asks for all.

    Parameters
    ----------
    genre, performer, data_set : str
        Only segments with exactly this.
    least_j, most_j : float or None, J
        Only segments whose linear energy lies between these, for a body of 73.5 kg.

    Raises
    ------
    InputError
        If a value is of another kind.
    """

    genre: str = ""
    performer: str = ""
    data_set: str = ""
    least_j: float | None = None
    most_j: float | None = None

    def __post_init__(self) -> None:
        for name in CHOICES:
            if not isinstance(getattr(self, name), str):
                raise InputError(
                    f"{getattr(self, name)!r} is asked for",
                    where=name,
                    remedy="ask for a word, or for ''",
                )
        for name in ("least_j", "most_j"):
            value = getattr(self, name)
            is_number = isinstance(value, int | float) and np.isfinite(value) and value >= 0.0
            if value is not None and not is_number:
                raise InputError(
                    f"the bound is {value!r}", where=name, remedy="give joules, 0 or more, or None"
                )

    @classmethod
    def read(cls, values: Mapping[str, Any]) -> Filters:
        """Take filters from a dictionary; what is not named asks for all."""
        known = {field.name for field in fields(cls)}
        unknown = sorted(set(values) - known)
        if unknown:
            raise InputError(
                f"there is no filter {unknown[0]!r}", where="filters", remedy=f"use {sorted(known)}"
            )
        return cls(**values)


class SegmentTable:
    """A library's segments with their energies in the paper's unit.

    Parameters
    ----------
    library : DanceLibrary
        Whose segments.
    """

    def __init__(self, library: DanceLibrary) -> None:
        segments = library.segments
        self.columns: dict[str, Any] = {
            name: segments[name].astype(str).to_numpy(dtype=object)
            for name in ("take", "genre", "performer", "data_set", "licence")
        }
        self.columns["start_s"] = segments["start_s"].to_numpy(dtype=np.float64)
        self.columns["linear_j"] = _joules(library.linear_energies)
        self.columns["rotational_j"] = _joules(library.rotational_energies)
        plain = np.zeros(len(segments), dtype=bool)
        self._is_mirrored = segments["mirrored"].to_numpy(bool) if "mirrored" in segments else plain
        self.choices = {name: sorted(set(self.columns[name])) for name in CHOICES}

    def __len__(self) -> int:
        return len(self.columns["take"])

    def found(self, filters: Filters, sort: Sequence[str]) -> Integers:
        """Give the numbers of the segments that are asked for, in the order that is asked for.

        Parameters
        ----------
        filters : Filters
            Which segments.
        sort : (str, {"ascending", "descending"})
            The column to sort by; equals stay in the order of the library.

        Raises
        ------
        InputError
            If there is no such column or direction.
        """
        column, direction = check_sort(sort)
        is_wanted = np.ones(len(self), dtype=bool)
        for name in CHOICES:
            if wanted := getattr(filters, name):
                is_wanted &= self.columns[name] == wanted
        linear = self.columns["linear_j"]
        if filters.least_j is not None:
            is_wanted &= linear >= filters.least_j
        if filters.most_j is not None:
            is_wanted &= linear <= filters.most_j
        rows = np.flatnonzero(is_wanted)
        values = self.columns[column][rows]
        if direction == "ascending":
            return np.asarray(rows[np.argsort(values, kind="stable")])
        # Sorted backwards from behind, equals keep the order of the library.
        return np.asarray(rows[::-1][np.argsort(values[::-1], kind="stable")][::-1])

    def rows(self, segments: Integers) -> list[dict[str, Any]]:
        """Give segments as they stand in the table: their number and the text of each cell."""
        return [
            {"id": int(segment), "cells": [self.cell(name, int(segment)) for name, _, _ in COLUMNS]}
            for segment in segments
        ]

    def cell(self, name: str, segment: int) -> str:
        """Give one value as it is written."""
        value = self.columns[name][segment]
        if name == "take" and self._is_mirrored[segment]:
            return f"{value}, mirrored"
        return value if isinstance(value, str) else f"{value:.1f}"


def check_sort(sort: Any) -> tuple[str, str]:
    """Check what to sort by and in which direction.

    Raises
    ------
    InputError
        If there is no such column or direction.
    """
    names = [name for name, _, _ in COLUMNS]
    try:
        column, direction = sort
        is_fine = column in names and direction in DIRECTIONS
    except (TypeError, ValueError):
        is_fine = False
    if not is_fine:
        raise InputError(
            f"cannot sort by {sort!r}", where="sort", remedy=f"give one of {names} and one of {DIRECTIONS}"
        )
    return column, direction


def _joules(energies: Floats) -> Floats:
    """Sum joint energies per mass and give them for the mean body of the paper, shape (segment,), J."""
    joules: Floats = np.asarray(energies, dtype=np.float64).sum(axis=1) * DEFAULT_BODY_MASS_KG
    return joules
