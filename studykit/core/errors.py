"""What can go wrong that a person can put right."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Any


class InputError(ValueError):
    """Something given to studykit cannot be used; the message says what, where and what to do.

    Parameters
    ----------
    problem : str
        What is wrong, in words, without a full stop.
    remedy : str
        What the reader can do about it, as an imperative without a full stop.
    where : str or Path, optional
        The file, line or field that is meant.

    Examples
    --------
    >>> str(InputError("no frames", where="salsa/01.bvh", remedy="export the take again"))
    'salsa/01.bvh: no frames; export the take again.'
    """

    def __init__(self, problem: str, *, remedy: str, where: str | Path = "") -> None:
        self.problem = problem
        self.remedy = remedy
        self.where = str(where)
        place = f"{self.where}: " if self.where else ""
        # What is quoted from a file may have line ends in it.
        super().__init__(" ".join(f"{place}{problem}; {remedy}.".splitlines()))

    def __reduce__(self) -> tuple[Any, ...]:
        # An error comes back from another process whole.
        return partial(InputError, self.problem, remedy=self.remedy, where=self.where), ()


class MistakesError(InputError):
    """Several things that cannot be used, told at once, one line each; the first stands for all.

    Parameters
    ----------
    errors : sequence of InputError
        In the order in which they are told, at least one.

    Examples
    --------
    >>> first = InputError("no name", where="line 2", remedy="give one")
    >>> print(MistakesError([first, InputError("no age", where="line 3", remedy="give one")]))
    line 2: no name; give one.
    line 3: no age; give one.
    """

    def __init__(self, errors: Sequence[InputError]) -> None:
        self.errors = tuple(errors)
        super().__init__(errors[0].problem, remedy=errors[0].remedy, where=errors[0].where)

    def __str__(self) -> str:
        return "\n".join(map(str, self.errors))

    def __reduce__(self) -> tuple[Any, ...]:
        return MistakesError, (self.errors,)


def nearest(word: str, known: Iterable[str]) -> str:
    """Say which of the known words was probably meant: a remedy.

    Parameters
    ----------
    word : str
        What was written.
    known : iterable of str
        What could have been written.

    Examples
    --------
    >>> nearest("right elbow", ["left_elbow", "right_elbow"])
    'write "right_elbow" if that was meant'
    """
    names = list(known)
    close = get_close_matches(word, names, n=1, cutoff=0.6)
    return f'write "{close[0]}" if that was meant' if close else f"use one of: {', '.join(names)}"
