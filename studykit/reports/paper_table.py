"""A table as it is printed in a paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

Cell = str | float | int | bool | None


@dataclass(frozen=True, kw_only=True, slots=True)
class Heading:
    """One column of a table.

    Parameters
    ----------
    key : str
        Its name in CSV.
    words : str
        Its name on paper.
    decimals : int or None
        Of its numbers on paper; None for words.
    """

    key: str
    words: str
    decimals: int | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class PaperTable:
    """A table as it is printed.

    Parameters
    ----------
    name : str
        Stem of its files.
    caption : str
        What it shows.
    headings : tuple of Heading
    rows : tuple of mapping of str to str, number or None
        By the keys of the headings.
    note : str
        What else a reader must know.
    """

    name: str
    caption: str
    headings: tuple[Heading, ...]
    rows: tuple[Mapping[str, Cell], ...]
    note: str = ""
