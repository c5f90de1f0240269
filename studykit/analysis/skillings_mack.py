"""Compare several conditions by ranks when some people lack a value in some of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from studykit.analysis.friedman import monte_carlo_p
from studykit.core.arrays import Booleans, Floats

SKILLINGS_MACK_VARIANT = "chi-squared approximation, corrected for ties"

_CHUNK = 1_000_000
"""Ranks drawn at a time."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SkillingsMack:
    """Whether several conditions differ, judged by the ranks of whatever values each person has.

    Parameters
    ----------
    statistic : float
        Skillings and Mack's; Friedman's chi-squared where nothing is missing.
    degrees_of_freedom : int
        Conditions - 1; fewer where nobody links some conditions to the others.
    p : float
        From the chi-squared distribution.
    permutation_p : float
        (hits + 1) / (draws + 1): how often random orders of each person's ranks reach the statistic.
    permutation_p_interval : tuple of float
        Where the exact share lies, with 95 % confidence.
    n : int
        People with two values or more; the others tell nothing and are left out.
    cells_missing : int
        Values that these people lack.
    variant : str
        How `p` was found.
    """

    statistic: float
    degrees_of_freedom: int
    p: float
    permutation_p: float
    permutation_p_interval: tuple[float, float]
    n: int
    cells_missing: int
    variant: str = SKILLINGS_MACK_VARIANT


def skillings_mack(table: Floats, *, rng: np.random.Generator, draws: int = 9_999) -> SkillingsMack:
    """Test whether several conditions differ when people have tried most of them, not all.

    Parameters
    ----------
    table : array_like, shape (person, condition)
        NaN where a value is missing, for reasons that have nothing to do with the value.
    rng : numpy.random.Generator
        Draws the orders for the permutation p.
    draws : int
        How many it draws.

    Raises
    ------
    ValueError
        If there are fewer than three conditions or two people with two values, a value is infinite, a
        condition has no value that can be compared or everybody's values are all equal.

    Notes
    -----
    Skillings & Mack 1981, doi:10.1080/00401706.1981.10486261: each person's ranks, less their mean, count by
    sqrt(12 / (values + 1)); the sums are weighed by the generalised inverse of their covariance. Ties have
    mid-ranks, and the covariance is that of the ranks people really have: without it the statistic would be
    too small, and not Friedman's where nothing is missing.

    Examples
    --------
    >>> nan = np.nan
    >>> minutes = [[3.2, 4.1, 3.8, 4.2], [3.1, 3.9, 3.4, 4.0], [4.3, 3.5, 4.6, 4.8], [3.5, 3.6, 3.9, 4.0],
    ...            [3.6, 4.2, 3.7, 3.9], [4.5, 4.7, 3.7, nan], [nan, 4.2, 3.4, nan], [4.3, 4.6, 4.4, 4.9],
    ...            [3.5, nan, 3.7, 3.9]]
    >>> result = skillings_mack(minutes, rng=np.random.default_rng(1))
    >>> round(result.statistic, 3), result.degrees_of_freedom, round(result.p, 5)
    (15.493, 3, 0.00144)
    """
    from scipy.stats import chi2

    scores, has = _scores(table)
    covariance = _covariance(scores, has)
    inverse = np.linalg.pinv(covariance, hermitian=True)
    df = int(np.linalg.matrix_rank(covariance, hermitian=True))
    sums = scores.sum(axis=0)
    statistic = float(sums @ inverse @ sums)
    hits, size = 0, max(1, _CHUNK // scores.size)
    for start in range(0, draws, size):
        drawn = _reordered(scores, has, min(size, draws - start), rng)
        # Equal statistics differ by rounding: what reaches it but for a billionth counts.
        reached = np.sum(drawn @ inverse * drawn, axis=1) >= statistic - 1e-9
        hits += int(np.count_nonzero(reached))
    permutation_p, interval = monte_carlo_p(hits, draws)
    return SkillingsMack(
        statistic=statistic,
        degrees_of_freedom=df,
        p=float(chi2.sf(statistic, df)),
        permutation_p=permutation_p,
        permutation_p_interval=interval,
        n=len(scores),
        cells_missing=int(np.count_nonzero(~has)),
    )


def _scores(table: Floats) -> tuple[Floats, Booleans]:
    """Give each person's weighed ranks less their mean, 0 where a value is missing; and where none is."""
    from scipy.stats import rankdata

    values = np.asarray(table, dtype=np.float64)
    if values.ndim != 2 or values.shape[1] < 3:
        raise ValueError(f"the table has the shape {values.shape}, expected 3 or more conditions")
    if np.any(np.isinf(values)):
        raise ValueError("the table must not hold infinite values")
    values = values[np.count_nonzero(~np.isnan(values), axis=1) >= 2]
    has = ~np.isnan(values)
    if len(values) < 2:
        raise ValueError(f"{len(values)} people have two values or more, expected 2 or more people")
    if not has.any(axis=0).all():
        raise ValueError(
            f"column {int(np.argmin(has.any(axis=0)))} has no value of anybody with a value elsewhere"
        )
    many = has.sum(axis=1, keepdims=True)
    ranks = rankdata(values, axis=1, nan_policy="omit")
    scores = np.where(has, np.sqrt(12.0 / (many + 1.0)) * (ranks - (many + 1.0) / 2.0), 0.0)
    if not scores.any():
        raise ValueError("every person has the same value in all conditions")
    return scores, has


def _covariance(scores: Floats, has: Booleans) -> Floats:
    """Give the covariance of the sums of scores when chance orders each person's."""
    many = has.sum(axis=1)
    variance = np.sum(scores**2, axis=1) / (many - 1.0)
    between = (has * (variance / many)[:, None]).T @ has
    return np.asarray(np.diag(variance @ has) - between)


def _reordered(scores: Floats, has: Booleans, times: int, rng: np.random.Generator) -> Floats:
    """Give the sums of scores of random orders of each person's, shape (draw, condition)."""
    sums = np.zeros((times, scores.shape[1]))
    for person, own in zip(scores, has, strict=True):
        sums[:, own] += rng.permuted(np.broadcast_to(person[own], (times, int(own.sum()))), axis=1)
    return sums
