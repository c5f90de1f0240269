"""Which values a statistic can take at all, given how many people there are.

Counts are whole, ranks are whole, answers on a scale are whole: what comes of them lies on a grid, and a
printed number between the points of its grid cannot be right.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from studykit.core.arrays import Floats

_SLACK = 1e-9


@lru_cache(maxsize=64)
def signed_rank_probabilities(n: int) -> Floats:
    """Give how likely each sum of positive signed ranks is if signs are left to chance and nobody ties.

    Parameters
    ----------
    n : int
        People who differ.

    Returns
    -------
    array, shape (n (n + 1) / 2 + 1,)
        Of the sums 0, 1, 2 ...; Wilcoxon's null distribution.
    """
    chances = np.zeros(n * (n + 1) // 2 + 1)
    chances[0] = 1.0
    for rank in range(1, n + 1):
        chances[rank:] = 0.5 * (chances[rank:] + chances[:-rank])
        chances[:rank] *= 0.5
    return chances


def signed_rank_p(sum_of_ranks: float, n: int) -> float:
    """Give Wilcoxon's exact two-sided p of a sum of signed ranks without ties.

    Parameters
    ----------
    sum_of_ranks : float
        Of either sign, 0 to n (n + 1) / 2.
    n : int
        People who differ.

    Examples
    --------
    >>> signed_rank_p(0, 6)
    0.03125
    """
    smaller = math.floor(min(sum_of_ranks, n * (n + 1) / 2 - sum_of_ranks))
    return float(min(1.0, 2.0 * signed_rank_probabilities(n)[: smaller + 1].sum()))


def signed_rank_normal_p(sum_of_ranks: float, n: int, *, continuity: bool) -> float:
    """Give Wilcoxon's two-sided p by the normal approximation without ties."""
    from scipy.stats import norm

    away = abs(sum_of_ranks - n * (n + 1) / 4.0) - (0.5 if continuity else 0.0)
    spread = math.sqrt(n * (n + 1) * (2 * n + 1) / 24.0)
    return float(min(1.0, 2.0 * norm.sf(max(0.0, away) / spread)))


def most_against(n: int, p_below: float) -> int | None:
    """Give how many of n people may differ the other way at most while the exact p stays below a bound.

    They are taken to have the smallest differences. None if even nobody leaves p too large.
    """
    counts = [d for d in range(n + 1) if d <= n / 2 and signed_rank_p(d * (d + 1) / 2.0, n) < p_below]
    return max(counts, default=None)


def friedman_without_ties(n: int, k: int, low: float, high: float) -> bool:
    """Tell whether ranks of n people without ties can give a Friedman chi-squared between two values.

    Chi-squared is 12 S / (n k (k + 1)) with S the sum of squared deviations of the rank sums from their
    mean. For 3 and 4 conditions every possible set of rank sums is tried; for more, S keeps only to its
    parity and its greatest value, which leaves gaps near that value unnoticed; so it does for 4 conditions
    and more than 40 people.

    Parameters
    ----------
    n, k : int
        People and conditions.
    low, high : float
        The interval of chi-squared.
    """
    scale = n * k * (k + 1) / 12.0
    lowest, highest = low * scale - _SLACK * scale, high * scale + _SLACK * scale
    if k in (3, 4) and 2 <= n <= 160 // k:
        sums = _rank_sum_deviations(n, k)
        return bool(np.any((sums >= lowest) & (sums <= highest)))
    mean = n * (k + 1) / 2.0
    offset = (k * mean * (1.0 - mean)) % 2.0
    first = offset + 2.0 * math.ceil(max(0.0, lowest - offset) / 2.0)
    return first <= min(highest, n * n * k * (k * k - 1) / 12.0 + _SLACK)


@lru_cache(maxsize=16)
def _rank_sum_deviations(n: int, k: int) -> Floats:
    """Give S of every set of rank sums that n people (2 or more) without ties can have, k 3 or 4.

    These are the whole numbers of the right total whose j smallest add up to n times 1 + ... + j or more:
    for two people or more each of them is a sum of orders.
    """
    free = np.indices((n * (k - 1) + 1,) * (k - 1)).reshape(k - 1, -1) + n
    last = n * k * (k + 1) // 2 - free.sum(axis=0)
    sums = np.vstack([free, last[None]])
    sums = sums[:, np.all(np.diff(sums, axis=0) >= 0, axis=0)]
    least = n * np.cumsum(np.arange(1, k + 1))
    sums = sums[:, np.all(np.cumsum(sums, axis=0) >= least[:, None], axis=0)]
    deviations: Floats = np.unique(((sums - n * (k + 1) / 2.0) ** 2).sum(axis=0))
    return deviations


def separated_chi_squared(n: int, first: int, second: int) -> float:
    """Give the smallest Friedman chi-squared if everybody's one group of conditions lies above the other.

    Examples
    --------
    >>> separated_chi_squared(20, 2, 2)
    48.0
    """
    k = first + second
    deviations = np.repeat([-second / 2.0, first / 2.0], [first, second]) * n
    return float(12.0 * (deviations**2).sum() / (n * k * (k + 1)))


def whole_totals(low: float, high: float, count: int) -> range:
    """Give the whole totals whose mean over `count` answers lies between two values (the GRIM test).

    References
    ----------
    Brown, N. J. L., & Heathers, J. A. J. (2017). The GRIM test. Social Psychological and Personality
    Science, 8(4). doi:10.1177/1948550616673876
    """
    slack = _SLACK * max(1.0, abs(low), abs(high)) * count
    return range(math.ceil(low * count - slack), math.floor(high * count + slack) + 1)


def whole_squares(total: int, n: int, items: int, deviations: tuple[float, float]) -> bool:
    """Tell whether whole answers with this total can have a standard deviation in an interval (GRIMMER).

    The sum of squares of whole numbers is whole, as odd or even as their sum, and no smaller than that of
    numbers as equal as can be.

    Parameters
    ----------
    total : int
        Sum of all answers of all people.
    n, items : int
        People, and items of which each person's mean is taken.
    deviations : tuple of float
        The interval of the standard deviation (n - 1) of the people's means.

    References
    ----------
    Allard, A. (2018). Analytic-GRIMMER: a new way of testing the possibility of standard deviations.
    """
    low, high = ((n - 1) * (items * max(0.0, deviation)) ** 2 + total**2 / n for deviation in deviations)
    each, left = divmod(total, n)
    least = (n - left) * each**2 + left * (each + 1) ** 2
    slack = _SLACK * max(1.0, high)
    first = max(least, math.ceil(low - slack))
    first += (first - total) % 2
    return first <= high + slack


def p_of_ranks(ranks: Floats, sum_of_positive: float) -> float:
    """Give Wilcoxon's exact two-sided p of any ranks, ties included, over all signs they could have.

    Parameters
    ----------
    ranks : array, shape (person,)
        Of the sizes of the differences; whole or half.
    sum_of_positive : float
        Of those whose difference is positive.

    Examples
    --------
    >>> p_of_ranks(np.array([1.5, 1.5, 3.0]), 6.0)
    0.25
    """
    doubled = np.round(2.0 * ranks).astype(np.int64)
    chances = np.zeros(int(doubled.sum()) + 1)
    chances[0] = 1.0
    for weight in doubled.tolist():
        moved = np.zeros_like(chances)
        moved[weight:] = chances[: len(chances) - weight]
        chances = 0.5 * (chances + moved)
    smaller = min(round(2.0 * sum_of_positive), len(chances) - 1 - round(2.0 * sum_of_positive))
    return float(min(1.0, 2.0 * chances[: smaller + 1].sum()))
