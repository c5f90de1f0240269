"""Compare two conditions that each person has tried, by ranks: Wilcoxon's signed-rank test."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from studykit.core.arrays import Floats

Zeros = Literal["drop", "pratt"]
PValue = Literal["exact", "normal", "normal_continuity"]
Alternative = Literal["two-sided", "greater", "less"]

_ZEROS_WORDS = {"drop": "zeros dropped", "pratt": "zeros ranked, then dropped (Pratt)"}
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


def _signed_ranks(differences: Floats, zeros: Zeros) -> tuple[Floats, Floats]:
    """Give the ranks of the positive and of the negative differences."""
    from scipy.stats import rankdata

    kept = differences[differences != 0.0] if zeros == "drop" else differences
    ranks = np.asarray(rankdata(np.abs(kept)), dtype=np.float64)
    return ranks[kept > 0.0], ranks[kept < 0.0]


def _exact_p(ranks: Floats, w_plus: float, alternative: Alternative) -> float:
    """Give the p of w_plus when each rank's sign is a fair coin.

    The distribution of w_plus is the convolution of one coin a rank; ties make halves, so ranks are doubled.
    """
    doubled = np.rint(2.0 * ranks).astype(np.int64)
    chances = np.zeros(int(doubled.sum()) + 1)
    chances[0] = 1.0
    for rank in doubled:
        shifted = np.zeros_like(chances)
        shifted[rank:] = chances[: len(chances) - rank]
        chances = 0.5 * (chances + shifted)
    found = round(2.0 * w_plus)
    p = {"greater": chances[found:].sum(), "less": chances[: found + 1].sum()}
    p["two-sided"] = 2.0 * min(p.values())
    return min(1.0, float(p[alternative]))


def _normal(differences: Floats, zeros: Zeros, **options: Any) -> Any:
    from scipy import stats

    test: Any = stats.wilcoxon  # its stubs know no method="asymptotic" without further arguments
    return test(
        differences, zero_method="wilcox" if zeros == "drop" else zeros, method="asymptotic", **options
    )


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
    zeros : {"drop", "pratt"}
        Leave people without a difference out before ranking, or after it (Pratt 1959).
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
    differences = np.asarray(a, dtype=np.float64) - np.asarray(b, dtype=np.float64)
    if differences.ndim != 1 or not differences.size or not np.all(np.isfinite(differences)):
        raise ValueError("a and b must be two finite lists of the same length")
    positive, negative = _signed_ranks(differences, zeros)
    w_plus, w_minus = float(positive.sum()), float(negative.sum())
    nonzero = len(positive) + len(negative)
    z, probability = 0.0, 1.0
    if nonzero:
        z = float(np.copysign(_normal(differences, zeros).zstatistic, w_plus - w_minus))
        if p == "exact":
            probability = _exact_p(np.concatenate((positive, negative)), w_plus, alternative)
        else:
            corrected = p == "normal_continuity"
            probability = float(
                _normal(differences, zeros, correction=corrected, alternative=alternative).pvalue
            )
    return Wilcoxon(
        n=len(differences),
        n_nonzero=nonzero,
        w_plus=w_plus,
        w_minus=w_minus,
        z=z,
        p=probability,
        rank_biserial=(w_plus - w_minus) / (w_plus + w_minus) if nonzero else 0.0,
        variant=f"{_P_WORDS[p]}; {_ZEROS_WORDS[zeros]}; {alternative}",
    )


def rank_biserial_interval(
    rank_biserial: float, n_nonzero: int, *, confidence: float = 0.95
) -> tuple[float, float] | None:
    """Give a range of plausible values of the rank-biserial correlation of `wilcoxon`.

    Parameters
    ----------
    rank_biserial : float
        -1 to 1.
    n_nonzero : int
        People with a difference.
    confidence : float
        Coverage meant, 0 to 1.

    Returns
    -------
    tuple of float or None
        None if nobody differs or all differ the same way: then the method cannot tell.

    Notes
    -----
    Fisher's z with the deviation sqrt(n (n + 1)(2n + 1) / 6) / (n (n + 1) / 2) of the signed-rank sum, as the
    R package effectsize does.
    """
    from scipy.stats import norm

    if not n_nonzero or abs(rank_biserial) >= 1.0:
        return None
    n = float(n_nonzero)
    deviation = np.sqrt(n * (n + 1.0) * (2.0 * n + 1.0) / 6.0) / (n * (n + 1.0) / 2.0)
    reach = norm.ppf(0.5 + confidence / 2.0) * deviation
    centre = np.arctanh(rank_biserial)
    return float(np.tanh(centre - reach)), float(np.tanh(centre + reach))
