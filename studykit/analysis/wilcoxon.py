"""Compare two conditions that each person has tried, by ranks: whether they differ, and by how much."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from studykit.core.arrays import Floats, Integers

Zeros = Literal["drop", "pratt", "split"]
PValue = Literal["exact", "normal", "normal_continuity"]
Alternative = Literal["two-sided", "greater", "less"]

_ZEROS_WORDS = {
    "drop": "zeros dropped",
    "pratt": "zeros ranked, then dropped (Pratt)",
    "split": "zeros ranked, half of their ranks to each side",
}
_P_WORDS = {
    "exact": "exact permutation distribution, ties kept",
    "normal": "normal approximation without continuity correction, corrected for ties",
    "normal_continuity": "normal approximation with continuity correction, corrected for ties",
}


@dataclass(frozen=True, kw_only=True, slots=True)
class Wilcoxon:
    """Whether two conditions differ, judged by the signed ranks of each person's difference a - b.

    Parameters
    ----------
    n, n_nonzero : int
        People, and those whose difference is not zero.
    w_plus, w_minus : float
        Sum of the ranks of the positive and of the negative differences.
    z : float
        Standardised w_plus, corrected for ties, without continuity correction; 0 if all differences are zero.
    p : float
        See `variant`.
    rank_biserial : float
        Effect size (w_plus - w_minus) / (w_plus + w_minus), -1 to 1; 0 if all differences are zero.
    variant : str
        How zeros were treated and how p was found.
    """

    n: int
    n_nonzero: int
    w_plus: float
    w_minus: float
    z: float
    p: float
    rank_biserial: float
    variant: str


@dataclass(frozen=True, kw_only=True, slots=True)
class Shift:
    """By how much one condition exceeds another, over people.

    Parameters
    ----------
    estimate : float
        Hodges and Lehmann's: the median of the means of every two differences, in the outcome's unit.
    interval : tuple of float
        Plausible values, in the outcome's unit.
    confidence : float
        What the interval achieves: at least what was asked, unless there are too few people for that.
    method : str
        How the interval was found.
    """

    estimate: float
    interval: tuple[float, float]
    confidence: float
    method: str


def wilcoxon(
    a: Floats,
    b: Floats,
    *,
    zeros: Zeros = "drop",
    p: PValue = "exact",
    alternative: Alternative = "two-sided",
) -> Wilcoxon:
    """Test whether two conditions differ when each person has tried both.

    Parameters
    ----------
    a, b : array_like, shape (person,)
        The two conditions; differences are a - b, ties and zeros as floating-point arithmetic finds them.
    zeros : {"drop", "pratt", "split"}
        Leave people without a difference out before ranking, or after it (Pratt 1959), or give half of their
        ranks to either side. The last two have the same z and p; they differ in the effect size.
    p : {"exact", "normal", "normal_continuity"}
        From all 2^n signs of the ranks (ties and zeros allowed), or from the normal approximation without
        or with continuity correction.
    alternative : {"two-sided", "greater", "less"}
        "greater" asks whether a exceeds b.

    Raises
    ------
    ValueError
        If the lists differ in length, are empty or not finite.

    Examples
    --------
    >>> result = wilcoxon([9, 7, 8, 6, 9, 7], [5, 6, 6, 7, 5, 4])
    >>> result.w_plus, result.w_minus, result.p
    (19.5, 1.5, 0.09375)
    """
    differences = _differences(a, b)
    ranks, to_either_side = _signed_ranks(differences, zeros)
    w_plus = float(ranks[ranks > 0.0].sum()) + to_either_side
    w_minus = float(-ranks[ranks < 0.0].sum()) + to_either_side
    spread = float(np.sqrt(np.sum(ranks**2)))
    z, probability = 0.0, 1.0
    if spread:
        z = (w_plus - w_minus) / spread
        continuity = p == "normal_continuity"
        probability = (
            _exact_p(ranks, alternative)
            if p == "exact"
            else _normal_p(ranks, alternative, continuity=continuity)
        )
    return Wilcoxon(
        n=len(differences),
        n_nonzero=len(ranks),
        w_plus=w_plus,
        w_minus=w_minus,
        z=z,
        p=probability,
        rank_biserial=_rank_biserial(differences, zeros),
        variant=f"{_P_WORDS[p]}; {_ZEROS_WORDS[zeros]}; {alternative}",
    )


def rank_biserial_interval(
    a: Floats, b: Floats, *, zeros: Zeros = "drop", confidence: float = 0.95
) -> tuple[float, float] | None:
    """Give a range of plausible values of the rank-biserial correlation of `wilcoxon`.

    Parameters
    ----------
    a, b : array_like, shape (person,)
        The two conditions.
    zeros : {"drop", "pratt", "split"}
        As for `wilcoxon`.
    confidence : float
        Coverage meant, 0 to 1.

    Returns
    -------
    tuple of float or None
        None if nobody differs.

    Raises
    ------
    ValueError
        As `wilcoxon` does.

    Notes
    -----
    Fisher's z with the standard error that the jackknife over people finds. The deviation that the
    signed-rank sum has where nothing differs, often used instead, makes the range too narrow where something
    does: for 20 people and normal differences with means of 0, 0.3, 0.5, 0.8 and 1.2 standard deviations it
    covers 94, 91, 90, 82 and 72 %, this one 97, 97, 95, 95 and 90 %.

    Where all who differ do so the same way, the jackknife has nothing to go by. The share of such people is
    at least s, Clopper and Pearson's limit; two of them point that way together with a chance of at least
    s^2; so the correlation of all people is at least s^2 - (1 - s^2).
    """
    from scipy.stats import norm

    differences = _differences(a, b)
    found = _rank_biserial(differences, zeros)
    tail = (1.0 - confidence) / 2.0
    nonzero = int(np.count_nonzero(differences))
    if not nonzero:
        return None
    if abs(found) >= 1.0:
        least = 2.0 * tail ** (2.0 / nonzero) - 1.0
        return (least, 1.0) if found > 0.0 else (-1.0, -least)
    people = len(differences)
    without = np.array([_rank_biserial(np.delete(differences, person), zeros) for person in range(people)])
    error = np.sqrt((people - 1.0) * np.var(without))
    reach = norm.isf(tail) * error / (1.0 - found**2)
    centre = np.arctanh(found)
    return float(np.tanh(centre - reach)), float(np.tanh(centre + reach))


def hodges_lehmann(differences: Floats, *, confidence: float = 0.95) -> Shift:
    """Estimate by how much one condition exceeds the other, without assuming a normal distribution.

    Parameters
    ----------
    differences : array_like, shape (person,)
        Each person's difference, in the outcome's unit; zeros stay in.
    confidence : float
        Coverage wanted, 0 to 1.

    Raises
    ------
    ValueError
        If there are no differences, one is not finite or the confidence is not between 0 and 1.

    Notes
    -----
    Hodges & Lehmann 1963; the limits are the means of two differences (Walsh averages) that the signed-rank
    test of the same level does not refuse (Tukey 1949): the shortest of them with at least the confidence
    wanted. That is 95.2 % for 20 people where 95 % are asked. Where differences are symmetrical about the
    shift the confidence is exact if they have no ties; with ties or zeros it is at least this, the limits
    being part of the interval (Noether 1967).

    Examples
    --------
    >>> shift = hodges_lehmann([1.0, 2.5, 3.0, 4.5, 6.0, 7.5])
    >>> shift.estimate, shift.interval, shift.confidence
    (4.25, (1.0, 7.5), 0.96875)
    """
    values = _differences(differences, 0.0)
    if not 0.0 < confidence < 1.0:
        raise ValueError(f"the confidence is {confidence}, expected between 0 and 1")
    people = len(values)
    first, second = np.triu_indices(people)
    walsh = np.sort((values[first] + values[second]) / 2.0)
    at_most = np.cumsum(_sign_distribution(np.arange(1, people + 1)))
    # The rounding of the sums must not cost a rank where a level is met exactly.
    beyond = max(1, int(np.searchsorted(at_most, (1.0 - confidence) / 2.0 + 1e-12, side="right")))
    tied = len(np.unique(np.abs(values))) < people or not values.all()
    return Shift(
        estimate=float(np.median(walsh)),
        interval=(float(walsh[beyond - 1]), float(walsh[len(walsh) - beyond])),
        confidence=float(1.0 - 2.0 * at_most[beyond - 1]),
        method="Hodges-Lehmann estimate, interval from the exact signed-rank distribution"
        + ("; with ties or zeros the confidence is at least this" if tied else ""),
    )


def _differences(a: Floats, b: Floats | float) -> Floats:
    differences = np.asarray(a, dtype=np.float64) - np.asarray(b, dtype=np.float64)
    if differences.ndim != 1 or not differences.size or not np.all(np.isfinite(differences)):
        raise ValueError("a and b must be two finite lists of the same length")
    return differences


def _signed_ranks(differences: Floats, zeros: Zeros) -> tuple[Floats, float]:
    """Give the ranks of those who differ, signed as they differ, and what zeros add to each side's sum."""
    from scipy.stats import rankdata

    kept = differences[differences != 0.0] if zeros == "drop" else differences
    ranks = np.asarray(rankdata(np.abs(kept)), dtype=np.float64)
    of_zeros = float(ranks[kept == 0.0].sum()) / 2.0 if zeros == "split" else 0.0
    return (np.sign(kept) * ranks)[kept != 0.0], of_zeros


def _rank_biserial(differences: Floats, zeros: Zeros) -> float:
    ranks, to_either_side = _signed_ranks(differences, zeros)
    everything = float(np.sum(np.abs(ranks))) + 2.0 * to_either_side
    return float(ranks.sum()) / everything if everything else 0.0


def _sign_distribution(weights: Integers) -> Floats:
    """Give how likely each sum of weights is when a fair coin decides which of them count, from 0 upwards."""
    chances = np.zeros(int(weights.sum()) + 1)
    chances[0] = 1.0
    for weight in weights:
        chances[weight:] += chances[: len(chances) - weight].copy()
        chances *= 0.5
    return chances


def _exact_p(ranks: Floats, alternative: Alternative) -> float:
    """Give the p of signed ranks when each sign is a fair coin; ties make halves, so ranks are doubled."""
    doubled = np.rint(2.0 * ranks).astype(np.int64)
    chances = _sign_distribution(np.abs(doubled))
    found = int(doubled[doubled > 0].sum())
    p = {"greater": chances[found:].sum(), "less": chances[: found + 1].sum()}
    p["two-sided"] = 2.0 * min(p.values())
    return min(1.0, float(p[alternative]))


def _normal_p(ranks: Floats, alternative: Alternative, *, continuity: bool) -> float:
    from scipy.stats import norm

    distance = float(ranks.sum()) / 2.0
    if continuity:
        distance -= 0.5 * {"two-sided": np.sign(distance), "greater": 1.0, "less": -1.0}[alternative]
    z = 2.0 * distance / np.sqrt(np.sum(ranks**2))
    p = {"greater": norm.sf(z), "less": norm.cdf(z), "two-sided": 2.0 * norm.sf(abs(z))}
    return float(p[alternative])
