"""A report as plain data: sections, paragraphs, tables, figures and a flow, which two writers set.

Whatever a text says is shown as text; the only marks are those put in by `italic`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

Kind = Literal["plain", "result", "warning", "note"]


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch of text in one look."""

    text: str
    look: Literal["", "italic", "bold"] = ""


Words = str | tuple[str | Piece, ...]
"""Text, or pieces of it."""


def italic(text: str) -> Piece:
    """Set the symbol of a statistic."""
    return Piece(text, "italic")


def bold(text: str) -> Piece:
    """Set what must be seen."""
    return Piece(text, "bold")


def pieces(words: Words) -> tuple[Piece, ...]:
    """Give text as pieces."""
    parts = (words,) if isinstance(words, str) else words
    return tuple(part if isinstance(part, Piece) else Piece(part) for part in parts)


def plain(words: Words) -> str:
    """Give text without looks."""
    return "".join(piece.text for piece in pieces(words))


@dataclass(frozen=True, kw_only=True, slots=True)
class Paragraph:
    """A paragraph; results, warnings and notes look their part."""

    words: Words
    kind: Kind = "plain"


@dataclass(frozen=True, kw_only=True, slots=True)
class Table:
    """A table.

    Parameters
    ----------
    title : str
        What it shows.
    head : tuple of Words
        Names of the columns, with their units.
    rows : tuple of tuple of Words
        Cells; the first of a row names it.
    text_columns : frozenset of int
        Columns that hold words and stand on the left; the first always does.
    note : Words
        What must be known to read it.
    number : int
        Given by the document.
    """

    title: str
    head: tuple[Words, ...]
    rows: tuple[tuple[Words, ...], ...]
    text_columns: frozenset[int] = frozenset()
    note: Words = ""
    number: int = 0


@dataclass(frozen=True, kw_only=True, slots=True)
class Figure:
    """A figure, or why it could not be drawn.

    Parameters
    ----------
    name : str
        Of its file, without ending.
    title, caption : str
        In a few words, and what must be known to read it.
    svg : bytes
        Empty if it could not be drawn.
    width_mm : float
    problem : str
        Why not, if so.
    number : int
        Given by the document.
    """

    name: str
    title: str
    caption: str
    svg: bytes = field(default=b"", repr=False)
    width_mm: float = 0.0
    problem: str = ""
    number: int = 0


@dataclass(frozen=True, kw_only=True, slots=True)
class Stage:
    """A box of a flow, and what was lost before the next one."""

    text: str
    count: str
    lost: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, slots=True)
class Flow:
    """Boxes from above to below: how many came, and how many went on."""

    title: str
    stages: tuple[Stage, ...]
    number: int = 0


Block = Paragraph | Table | Figure | Flow


@dataclass(frozen=True, kw_only=True, slots=True)
class Section:
    """A part of a report, with parts of its own."""

    title: str
    blocks: tuple[Block, ...] = ()
    sections: tuple[Section, ...] = ()
    number: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class Document:
    """A whole report.

    Parameters
    ----------
    title, subtitle : str
    banners : tuple of str
        What must be seen first, such as that data were simulated.
    summary : tuple of Block
        Before the first section.
    sections : tuple of Section
    """

    title: str
    subtitle: str
    banners: tuple[str, ...]
    summary: tuple[Block, ...]
    sections: tuple[Section, ...]

    def blocks(self) -> Iterator[Block]:
        """Give all blocks in order."""
        yield from self.summary
        yield from (block for section in self.sections for block in _blocks(section))

    def numbered(self) -> Document:
        """Give it with sections, tables and figures numbered in order; a flow counts as a figure."""
        counts = {"table": 0, "figure": 0}

        def counted(block: Block) -> Block:
            if isinstance(block, Paragraph):
                return block
            kind = "table" if isinstance(block, Table) else "figure"
            counts[kind] += 1
            return replace(block, number=counts[kind])

        def section(one: Section, number: str) -> Section:
            return replace(
                one,
                number=number,
                blocks=tuple(counted(block) for block in one.blocks),
                sections=tuple(section(part, f"{number}.{n}") for n, part in enumerate(one.sections, 1)),
            )

        return replace(
            self,
            summary=tuple(counted(block) for block in self.summary),
            sections=tuple(section(one, str(n)) for n, one in enumerate(self.sections, 1)),
        )


def _blocks(section: Section) -> Iterator[Block]:
    yield from section.blocks
    yield from (block for part in section.sections for block in _blocks(part))


def listed(words: Sequence[str]) -> str:
    """Write a list in a sentence.

    Examples
    --------
    >>> listed(["a", "b", "c"]), listed(["a"])
    ('a, b and c', 'a')
    """
    return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)
