"""From a table of trials to the numbers that a figure shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

ORDER = ("light-easy", "light-hard", "intense-easy", "intense-hard")
"""The four cells of intensity and variety, in the order in which figures show them."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Interval:
    """A mean and how precisely it is known.

    Parameters
    ----------
    mean, low, high : float
        The mean and the ends of its 95 % interval (Student's t over participants).
    """

    mean: float
    low: float
    high: float


def mean_interval(values: Floats) -> Interval:
    """Give the mean of a sample and its 95 % interval by Student's t.

    Parameters
    ----------
    values : ndarray, shape (participant,)
        One number a participant; NaN is left out. With fewer than two the interval is NaN.

    Examples
    --------
    >>> interval = mean_interval(np.array([1.0, 2.0, 3.0]))
    >>> interval.mean, round(interval.low, 3), round(interval.high, 3)
    (2.0, -0.484, 4.484)
    """
    from scipy.special import stdtrit

    sample = values[np.isfinite(values)]
    if len(sample) == 0:
        return Interval(mean=np.nan, low=np.nan, high=np.nan)
    mean = float(sample.mean())
    if len(sample) < 2:
        return Interval(mean=mean, low=np.nan, high=np.nan)
    half = float(stdtrit(len(sample) - 1, 0.975) * sample.std(ddof=1) / np.sqrt(len(sample)))
    return Interval(mean=mean, low=mean - half, high=mean + half)


def valid_trials(trials: pd.DataFrame, columns: Sequence[str], *, transition: str | None) -> pd.DataFrame:
    """Give the valid trials that have a number in every column asked for.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`.
    columns : sequence of str
        The columns needed.
    transition : {"on", "off"} or None
        Only trials with or without the transition cost; all if None.

    Raises
    ------
    InputError
        If there is none.
    """
    kept = trials[trials["is_valid"].astype(bool) & trials[list(columns)].notna().all(axis=1)]
    if transition is not None:
        kept = kept[kept["transition"] == transition]
    if kept.empty:
        raise InputError(
            f"no valid trial has a value of {' and '.join(columns)}",
            where="trials",
            remedy="record at least one complete performance, then draw again",
        )
    return kept


def by_participant(kept: pd.DataFrame, outcome: str) -> pd.DataFrame:
    """Give one number a participant and condition, shape (participant, condition).

    Conditions stand in the order of `ORDER`, each with transition cost before without; NaN where a
    participant has no valid trial of a condition.
    """
    table = kept.pivot_table(index="participant", columns="condition", values=outcome, aggfunc="mean")
    names = [f"{cell}-{transition}" for cell in ORDER for transition in ("on", "off")]
    return table[[name for name in names if name in table.columns]]


def beside_each_other(values: Floats, *, half_width: float, bins: int = 24) -> Floats:
    """Move points that would cover each other sideways, the same way every time.

    Parameters
    ----------
    values : ndarray, shape (point,)
        Their heights; NaN stays where it is.
    half_width : float
        The largest shift.
    bins : int
        Points within one of this many equal parts of the whole range count as covering each other.

    Returns
    -------
    ndarray, shape (point,)
        Sideways shifts, symmetric about zero.
    """
    shifts = np.zeros(len(values))
    (seen,) = np.nonzero(np.isfinite(values))
    if not len(seen):
        return shifts
    low = values[seen].min()
    span = float(values[seen].max() - low) or 1.0
    rows = np.floor((values[seen] - low) / span * (bins - 1e-9))
    _, counts = np.unique(rows, return_counts=True)
    step = min(2.0 * half_width / max(int(counts.max()) - 1, 1), half_width / 2.0)
    for row in np.unique(rows):
        members = seen[rows == row]
        ordered = members[np.argsort(values[members], kind="stable")]
        shifts[ordered] = (np.arange(len(ordered)) - (len(ordered) - 1) / 2.0) * step
    return shifts
