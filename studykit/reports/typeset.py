"""Two writers of one document: a page for the browser and a PDF, both needing nothing else."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

from studykit.reports.document import (
    Block,
    Document,
    Figure,
    Flow,
    Paragraph,
    Section,
    Table,
    Words,
    pieces,
    plain,
)
from studykit.reports.page import embedded, filled

# Letters that fit on a line of a table, and those after which words of a cell are broken.
_LINE, _WIDEST = 100, 44.0
# Letters that a head broken into three lines may take.
_HEAD = 16.0


def page(document: Document) -> str:
    """Set a document as one HTML page with its figures inside; whatever it says is shown as text."""
    filters: dict[str, Callable[..., Any]] = {
        "pieces": pieces,
        "embedded": embedded,
        "plain": plain,
        "kind": lambda block: type(block).__name__,
    }
    return filled("document.html.jinja", filters=filters, document=document)


def pdf(document: Document) -> bytes:
    """Set a document as PDF with searchable text, without a date: equal documents give equal bytes."""
    import typst

    template = resources.files("studykit.reports").joinpath("document.typ").read_bytes()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "document.typ").write_bytes(template)
        (folder / "document.json").write_text(json.dumps(_plain(document)), encoding="utf-8")
        for block in document.blocks():
            if isinstance(block, Figure) and block.svg:
                (folder / f"figure-{block.number}.svg").write_bytes(block.svg)
        made = typst.compile(
            folder / "document.typ", root=folder, ignore_system_fonts=True, format="pdf", timestamp=0
        )
    if not isinstance(made, bytes):
        raise TypeError("the typesetter gave no single file")
    return made


def _plain(document: Document) -> dict[str, Any]:
    return {
        "title": document.title,
        "subtitle": document.subtitle,
        "banners": document.banners,
        "summary": [_block(block) for block in document.summary],
        "sections": [_section(section) for section in document.sections],
    }


def _section(section: Section) -> dict[str, Any]:
    return {
        "title": section.title,
        "number": section.number,
        "blocks": [_block(block) for block in section.blocks],
        "sections": [_section(part) for part in section.sections],
    }


def _block(block: Block) -> dict[str, Any]:
    entry: dict[str, Any] = {"kind": type(block).__name__}
    if isinstance(block, Paragraph):
        return entry | {"style": block.kind, "words": _words(block.words)}
    entry |= {"number": block.number, "title": block.title}
    if isinstance(block, Table):
        rows = [[{"pieces": _words(cell)} for cell in row] for row in block.rows]
        head = [_words(cell) for cell in block.head]
        left = sorted(block.text_columns)
        return entry | {
            "head": head, "rows": rows, "left": left, "note": _words(block.note), "widths": _widths(block)
        }  # fmt: skip
    if isinstance(block, Flow):
        return entry | {
            "stages": [{"text": one.text, "count": one.count, "lost": one.lost} for one in block.stages]
        }
    return entry | {
        "caption": block.caption,
        "problem": block.problem,
        "file": f"figure-{block.number}.svg",
        "width_mm": block.width_mm,
    }


def _widths(table: Table) -> list[float]:
    """Give each column its share of the width by what it holds; 0 for as wide as it needs where all fits."""
    whole, broken = [], []
    for place, head in enumerate(table.head):
        cells = max((len(plain(row[place])) for row in table.rows), default=0)
        length, longest = len(plain(head)), max(map(len, plain(head).split()), default=1)
        whole.append(max(cells, length))
        broken.append(max(cells, longest, min(length / 3.0, _HEAD)))
    if sum(whole) + 2 * len(whole) <= _LINE:
        return [0.0] * len(whole)
    return [min(width, _WIDEST) + 2.0 for width in broken]


def _words(words: Words) -> list[dict[str, str]]:
    return [{"text": piece.text, "look": piece.look} for piece in pieces(words) if piece.text]
