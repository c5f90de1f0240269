"""From a table of trials to the numbers that a figure shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from studykit.core.arrays import Floats
from studykit.core.errors import InputError

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
    >>> mean_interval(np.array([1.0, 2.0, 3.0]))
    Interval(mean=2.0, low=-0.484..., high=4.484...)
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


def by_participant(trials: pd.DataFrame, outcome: str, conditions: Sequence[str]) -> pd.DataFrame:
    """Give one number a participant and condition, from the valid trials only.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`.
    outcome : str
        The column to show.
    conditions : sequence of str
        The conditions, in the order of the columns of the result.

    Returns
    -------
    DataFrame, shape (participant, condition)
        NaN where a participant has no valid trial of a condition.

    Raises
    ------
    InputError
        If no valid trial of these conditions has a number in the column.
    """
    kept = trials[trials["is_valid"].astype(bool) & trials["condition"].isin(conditions)]
    kept = kept[kept[outcome].notna()]
    if kept.empty:
        raise InputError(
            f"no valid trial has a value of {outcome}",
            where="trials",
            remedy="record at least one complete performance of these conditions, then draw again",
        )
    table = kept.pivot_table(index="participant", columns="condition", values=outcome, aggfunc="mean")
    return table.reindex(columns=list(conditions))


def beside_each_other(values: Floats, *, half_width: float, bins: int = 24) -> Floats:
    """Move points that would cover each other sideways, the same way every time.

    Parameters
    ----------
    values : ndarray, shape (point,)
        Their heights.
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
    span = float(np.nanmax(values) - np.nanmin(values)) or 1.0
    rows = np.floor((values - np.nanmin(values)) / span * (bins - 1e-9))
    counts = np.array([np.sum(rows == row) for row in rows])
    step = min(2.0 * half_width / max(counts.max() - 1, 1), half_width / 2.0)
    for row in np.unique(rows[np.isfinite(rows)]):
        (members,) = np.nonzero(rows == row)
        ordered = members[np.argsort(values[members], kind="stable")]
        shifts[ordered] = (np.arange(len(ordered)) - (len(ordered) - 1) / 2.0) * step
    return shifts
