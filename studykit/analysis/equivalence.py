"""Show that two conditions are as good as alike: that they differ by less than what matters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from studykit.analysis.wilcoxon import hodges_lehmann, wilcoxon
from studykit.core.arrays import Floats
from studykit.core.errors import InputError


@dataclass(frozen=True, kw_only=True, slots=True)
class WithinBounds:
    """Whether a difference lies within the bounds, by one pair of tests.

    Parameters
    ----------
    estimate : float
        Difference a - b, in the outcome's unit.
    interval : tuple of float
        Plausible values with a confidence of 1 - 2 alpha: equivalent when it lies within the bounds.
    p_low, p_high : float
        Of the tests that the difference exceeds the lower bound, and that it falls short of the upper.
    p : float
        The larger of the two.
    is_equivalent : bool
        Whether p is below alpha.
    method : str
        Which tests.
    """

    estimate: float
    interval: tuple[float, float]
    p_low: float
    p_high: float
    p: float
    is_equivalent: bool
    method: str


@dataclass(frozen=True, kw_only=True, slots=True)
class Equivalence:
    """Whether two conditions differ by less than what matters.

    Parameters
    ----------
    low, high : float
        The bounds, in the outcome's unit.
    alpha : float
        1 - confidence: the chance of calling conditions equivalent that differ by a bound.
    n : int
        Participants.
    by_t, by_ranks : WithinBounds
        From means and Student's t; from signed ranks. Say beforehand which one counts.
    """

    low: float
    high: float
    alpha: float
    n: int
    by_t: WithinBounds
    by_ranks: WithinBounds


def equivalence(a: Floats, b: Floats, *, low: float, high: float, confidence: float = 0.95) -> Equivalence:
    """Test whether two conditions differ by less than what matters, for people who danced both.

    Parameters
    ----------
    a, b : array_like, shape (participant,)
        The two conditions, in the outcome's unit; differences are a - b.
    low, high : float
        The largest differences that do not matter, chosen before the data are seen.
    confidence : float
        1 - alpha, 0.5 to 1.

    Raises
    ------
    InputError
        If the bounds are the wrong way round, or the differences do not vary.
    ValueError
        If the lists differ in length, hold fewer than two values, or are not finite.

    Notes
    -----
    Two one-sided tests (Schuirmann 1987, doi 10.1007/BF01068419): both must reject, so that p is the larger
    one, without correction. A large p does not show that conditions differ, only that too little is known.
    """
    if not low < high:
        raise InputError(
            f"the lower bound {low} is not below the upper bound {high}",
            where="low",
            remedy="give the smallest and the largest difference that do not matter",
        )
    differences = np.asarray(a, dtype=np.float64) - np.asarray(b, dtype=np.float64)
    if differences.ndim != 1 or len(differences) < 2 or not np.all(np.isfinite(differences)):
        raise ValueError("a and b must be two finite lists of the same length, two values or more")
    if np.ptp(differences) <= 1e-12 * np.abs(differences).max():
        raise InputError(
            "all participants have the same difference",
            where="outcome",
            remedy="look at the values themselves",
        )
    alpha = 1.0 - confidence
    return Equivalence(
        low=low,
        high=high,
        alpha=alpha,
        n=len(differences),
        by_t=_by_t(differences, low, high, alpha),
        by_ranks=_by_ranks(differences, low, high, alpha),
    )


def _by_t(differences: Floats, low: float, high: float, alpha: float) -> WithinBounds:
    from scipy.stats import t as student

    freedom = len(differences) - 1
    estimate = float(differences.mean())
    error = float(differences.std(ddof=1)) / np.sqrt(len(differences))
    reach = error * student.isf(alpha, freedom)
    p_low = float(student.sf((estimate - low) / error, freedom))
    p_high = float(student.cdf((estimate - high) / error, freedom))
    return WithinBounds(
        estimate=estimate,
        interval=(float(estimate - reach), float(estimate + reach)),
        p_low=p_low,
        p_high=p_high,
        p=max(p_low, p_high),
        is_equivalent=max(p_low, p_high) < alpha,
        method="two one-sided paired t tests",
    )


def _by_ranks(differences: Floats, low: float, high: float, alpha: float) -> WithinBounds:
    shift = hodges_lehmann(differences, confidence=1.0 - 2.0 * alpha)
    above = wilcoxon(_exact(differences, low), np.zeros_like(differences), alternative="greater")
    below = wilcoxon(_exact(differences, high), np.zeros_like(differences), alternative="less")
    return WithinBounds(
        estimate=shift.estimate,
        interval=shift.interval,
        p_low=above.p,
        p_high=below.p,
        p=max(above.p, below.p),
        is_equivalent=max(above.p, below.p) < alpha,
        method=f"two one-sided signed-rank tests ({above.variant.rsplit(';', 1)[0]}); {shift.method}",
    )


def _exact(differences: Floats, bound: float) -> Floats:
    """Take a bound off, so that what is tied but for rounding stays tied."""
    moved = differences - bound
    step = 1e-12 * float(np.abs(differences).max() + abs(bound))
    return np.asarray(np.rint(moved / step) * step)
