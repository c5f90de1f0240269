"""What every part of a protocol shares: it cannot be changed, and it knows no unknown field."""

from __future__ import annotations

from collections.abc import Iterable

from pydantic import BaseModel, ConfigDict

from studykit.core.errors import InputError


class Part(BaseModel):
    """Base of everything that a person writes in a protocol file."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


def refuse_repeats(names: Iterable[str], *, what: str, where: str = "") -> None:
    """Refuse a list in which something stands twice.

    Raises
    ------
    InputError
        Naming the first that is repeated.
    """
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise InputError(f'the {what} "{name}" stands twice', where=where, remedy="remove one of them")
        seen.add(name)
