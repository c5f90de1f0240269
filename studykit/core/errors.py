"""What can go wrong that a person can put right."""

from __future__ import annotations

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
