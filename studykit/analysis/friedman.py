"""Compare several conditions that each person has tried, by ranks: Friedman's test and Kendall's W."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from studykit.core.arrays import Floats

FRIEDMAN_VARIANT = "chi-squared approximation, corrected for ties"


@dataclass(frozen=True, kw_only=True, slots=True)
class Friedman:
    """Whether several conditions differ, judged by ranks within each person.

    Parameters
    ----------
    chi_squared : float
        Friedman's statistic, corrected for ties.
    degrees_of_freedom : int
        Conditions - 1.
    p : float
        From the chi-squared distribution.
    kendalls_w : float
        Agreement of the people's rankings, 0 (none) to 1 (all alike): chi_squared / (n (k - 1)).
    n : int
        People.
    mean_ranks : tuple of float
        One a condition; 1 is the lowest.
    variant : str
        How p was found.
    """

    chi_squared: float
    degrees_of_freedom: int
    p: float
    kendalls_w: float
    n: int
    mean_ranks: tuple[float, ...]
    variant: str = FRIEDMAN_VARIANT


def _ranks(table: Floats) -> Floats:
    from scipy.stats import rankdata

    return np.asarray(rankdata(table, axis=1), dtype=np.float64)


def _w_of_ranks(ranks: Floats) -> Floats:
    """Give Kendall's W of ranks (..., person, condition), corrected for ties; NaN where all are tied."""
    people, conditions = ranks.shape[-2:]
    expected = (conditions + 1) / 2.0
    between = np.sum((ranks.sum(axis=-2) - people * expected) ** 2, axis=-1)
    # The spread that the ranks really have: what the correction for ties amounts to.
    within = np.sum((ranks - expected) ** 2, axis=(-2, -1))
    with np.errstate(invalid="ignore"):
        return np.asarray(between / (people * within))


def friedman(table: Floats) -> Friedman:
    """Test whether several conditions differ when each person has tried all of them.

    Parameters
    ----------
    table : array_like, shape (person, condition)
        One value each; at least two people and three conditions.

    Raises
    ------
    ValueError
        If the shape is wrong, a value is not finite or every person's values are all equal.

    Notes
    -----
    Friedman 1937 with the correction for ties; Kendall's W = chi_squared / (n (k - 1)).

    Examples
    --------
    Seven students' pulse before, right after and five minutes after exercise (Sprent & Smeeton):

    >>> pulse = [[72, 120, 76], [96, 120, 95], [88, 132, 104], [92, 120, 96], [74, 101, 84], [76, 96, 72],
    ...          [82, 112, 76]]
    >>> result = friedman(pulse)
    >>> round(result.chi_squared, 3), round(result.p, 4), round(result.kendalls_w, 3)
    (10.571, 0.0051, 0.755)
    """
    from scipy.stats import friedmanchisquare

    values = np.asarray(table, dtype=np.float64)
    if values.ndim != 2 or values.shape[0] < 2 or values.shape[1] < 3:
        raise ValueError(
            f"the table has the shape {values.shape}, expected 2 or more people, 3 or more conditions"
        )
    if not np.all(np.isfinite(values)):
        raise ValueError("the table must be finite")
    if np.all(values == values[:, :1]):
        raise ValueError("every person has the same value in all conditions")
    people, conditions = values.shape
    statistic, p = friedmanchisquare(*values.T)
    return Friedman(
        chi_squared=float(statistic),
        degrees_of_freedom=conditions - 1,
        p=float(p),
        kendalls_w=float(statistic) / (people * (conditions - 1)),
        n=people,
        mean_ranks=tuple(float(rank) for rank in _ranks(values).mean(axis=0)),
    )


def kendalls_w_interval(
    table: Floats, *, rng: np.random.Generator, confidence: float = 0.95, resamples: int = 2000
) -> tuple[float, float]:
    """Give a range of plausible values of Kendall's W, by drawing the people again and again.

    Parameters
    ----------
    table : array_like, shape (person, condition)
        As for `friedman`.
    rng : numpy.random.Generator
        Draws the people.
    confidence : float
        Coverage meant, 0 to 1.
    resamples : int
        How often the people are drawn.

    Returns
    -------
    tuple of float
        Percentiles of the bootstrap over people. W cannot be negative: with few people the range lies high.
    """
    ranks = _ranks(np.asarray(table, dtype=np.float64))
    people = rng.integers(len(ranks), size=(resamples, len(ranks)))
    drawn = _w_of_ranks(ranks[people])
    tail = 50.0 * (1.0 - confidence)
    low, high = np.nanpercentile(drawn, [tail, 100.0 - tail])
    return float(low), float(high)
