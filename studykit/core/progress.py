"""Progress of long work, told to whoever wants to know."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import Protocol, TypeVar

Item = TypeVar("Item")


class Progress(Protocol):
    """Something that passes items through and shows how far it got."""

    def __call__(self, items: Iterable[Item], *, label: str, total: int) -> Iterable[Item]:
        """Pass `items` through while showing `label` and the share of `total` done."""
        ...


def silent(items: Iterable[Item], *, label: str, total: int) -> Iterable[Item]:  # noqa: ARG001
    """Pass items through and show nothing."""
    return items


def notice(text: str) -> None:
    """Tell somebody at a notebook or a prompt why they wait; commands and scripts speak for themselves."""
    if hasattr(sys, "ps1"):  # only where lines are typed in
        sys.stdout.write(f"{text}\n")
        sys.stdout.flush()
