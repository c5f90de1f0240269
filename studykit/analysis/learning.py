"""Whether people get better when they dance the same condition again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from studykit.analysis.tables import DANCED_AGAIN

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, kw_only=True, slots=True)
class Learning:
    """How a measure changes from one repetition to the next.

    Parameters
    ----------
    outcome : str
        The column of trials.csv.
    slope : float
        Mean over people of the change with each repetition, in the outcome's unit.
    interval : tuple of float
        Where the mean slope lies with this confidence (Student's t).
    confidence : float
        0 to 1.
    p : float
        Of no change.
    n : int
        People who danced a condition more than once.
    """

    outcome: str
    slope: float
    interval: tuple[float, float]
    confidence: float
    p: float
    n: int


def learning(trials: pd.DataFrame, outcome: str = "dtw_m", *, confidence: float = 0.95) -> Learning | None:
    """Tell how a measure changes as people repeat a condition within a visit.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, the columns of `tables.TRIALS`; those that count and those that were danced again.
    outcome : str
        A measured column.
    confidence : float
        Of the interval.

    Returns
    -------
    Learning or None
        None if fewer than two people danced a condition more than once.

    Notes
    -----
    Each person's slope is the least-squares slope on the repetition with a mean for every condition (so that
    an easier condition is no learning); the slopes are then averaged over people.
    """
    used = trials[trials["is_valid"] | (trials["exclusion_reason"] == DANCED_AGAIN)].dropna(subset=[outcome])
    slopes = []
    for _, person in used.groupby("participant"):
        by_condition = person.groupby(["session", "condition"])
        repetition = person["repetition"] - by_condition["repetition"].transform("mean")
        change = person[outcome] - by_condition[outcome].transform("mean")
        squares = float((repetition**2).sum())
        if squares > 0.0:
            slopes.append(float((repetition * change).sum()) / squares)
    return None if len(slopes) < 2 else _of_slopes(np.array(slopes), outcome, confidence)


def _of_slopes(slopes: np.ndarray, outcome: str, confidence: float) -> Learning:
    from scipy import stats

    mean, error = float(slopes.mean()), float(slopes.std(ddof=1) / np.sqrt(len(slopes)))
    half = float(stats.t.ppf(0.5 + confidence / 2.0, len(slopes) - 1)) * error
    t = abs(mean) / error if error > 0.0 else np.inf if mean else 0.0
    return Learning(
        outcome=outcome,
        slope=mean,
        interval=(mean - half, mean + half),
        confidence=confidence,
        p=float(2.0 * stats.t.sf(t, len(slopes) - 1)),
        n=len(slopes),
    )
