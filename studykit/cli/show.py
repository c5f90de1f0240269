"""What commands print: progress on the way, then what was made."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from studykit.core.progress import Item


def progress(items: Iterable[Item], *, label: str, total: int) -> Iterable[Item]:
    """Pass items through behind a progress bar on the error stream."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    if not total:
        yield from items
        return
    columns = (TextColumn("{task.description:<28}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task(label, total=total)
        for item in items:
            yield item
            bar.advance(task)


def say(text: str = "") -> None:
    """Print a line."""
    print(text)


def note(text: str) -> None:
    """Print a line beside the results, on the error stream."""
    print(text, file=sys.stderr)


def as_json(value: Mapping[str, Any] | Sequence[Any]) -> None:
    """Print plain values for a machine."""
    json.dump(value, sys.stdout, indent=1, ensure_ascii=False)
    say()


def table(rows: Sequence[Mapping[Any, Any]]) -> None:
    """Print rows of equal keys as aligned columns."""
    heads = list(rows[0])
    cells = [[str(row[head]) for head in heads] for row in rows]
    widths = [max(len(head), *(len(row[n]) for row in cells)) for n, head in enumerate(heads)]
    for line in (heads, *cells):
        say("  ".join(f"{cell:<{width}}" for cell, width in zip(line, widths, strict=True)).rstrip())
