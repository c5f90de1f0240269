"""What every part of a protocol shares: it cannot be changed, and it knows no unknown field."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

from pydantic import BaseModel, ConfigDict

from studykit.core.errors import InputError


class Part(BaseModel):
    """Base of everything that a person writes in a protocol file."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


def nearest(word: str, known: Iterable[str]) -> str:
    """Say which of the known words was probably meant.

    Parameters
    ----------
    word : str
        What was written.
    known : iterable of str
        What could have been written.

    Returns
    -------
    str
        An imperative without a full stop.

    Examples
    --------
    >>> nearest("dtw", ["dtw_m", "smoothness_rating"])
    'write "dtw_m" if that was meant'
    """
    names = list(known)
    close = get_close_matches(word, names, n=1, cutoff=0.6)
    return f'write "{close[0]}" if that was meant' if close else f"use one of: {', '.join(names)}"


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
