"""How closely two measurements go together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from studykit.core.arrays import Floats

POOLED_WARNING = (
    "Every trial counts as if it came from a different person. Trials of one person are alike, so this p and "
    "interval claim more certainty than the data hold; the repeated-measures correlation does not."
)


@dataclass(frozen=True, kw_only=True, slots=True)
class Correlation:
    """A correlation with its uncertainty.

    Parameters
    ----------
    r : float
        -1 to 1.
    p : float
        Two-sided, from Student's t with `degrees_of_freedom`.
    n : int
        Pairs of values.
    participants : int or None
        People they come from; None where that was not asked.
    degrees_of_freedom : int
    interval : tuple of float or None
        Plausible values of r (Fisher's z); None with too few values to tell.
    method : str
        Which correlation this is, in words.
    warning : str or None
        What to beware of.
    """

    r: float
    p: float
    n: int
    participants: int | None
    degrees_of_freedom: int
    interval: tuple[float, float] | None
    method: str
    warning: str | None


def pearson(
    x: Sequence[float] | Floats, y: Sequence[float] | Floats, *, confidence: float = 0.95
) -> Correlation:
    """Correlate all values with each other, whoever they come from (Pearson).

    Parameters
    ----------
    x, y : array_like, shape (trial,)
    confidence : float
        Coverage of the interval, 0 to 1.

    Returns
    -------
    Correlation
        With a warning: it ignores that people were measured repeatedly.

    Raises
    ------
    ValueError
        With fewer than three pairs, values that are not finite, or if x or y is constant.
    """
    across, up = _pairs(x, y)
    return _correlation(
        float(_residual(across, across.mean(), "x") @ _residual(up, up.mean(), "y")),
        n=len(across),
        degrees_of_freedom=len(across) - 2,
        confidence=confidence,
        participants=None,
    )


def repeated_measures(
    participants: Sequence[str],
    x: Sequence[float] | Floats,
    y: Sequence[float] | Floats,
    *,
    confidence: float = 0.95,
) -> Correlation:
    """Correlate how two measurements change within each person, leaving differences between people out.

    Parameters
    ----------
    participants : sequence of str, length trial
        Who each pair of values comes from.
    x, y : array_like, shape (trial,)
    confidence : float
        Coverage of the interval, 0 to 1.

    Raises
    ------
    ValueError
        With too few pairs, values that are not finite, or if x or y is constant within every person.

    Notes
    -----
    Bakdash & Marusich 2017 (doi 10.3389/fpsyg.2017.00456): one slope and an intercept a person. That is the
    correlation of the values with each person's means taken off, with n - people - 1 degrees of freedom.

    Examples
    --------
    Two people whose levels differ but who both rise together:

    >>> result = repeated_measures(["a", "a", "a", "b", "b", "b"], [1, 2, 3, 1, 2, 3], [5, 6, 8, 1, 2, 4])
    >>> round(result.r, 3), result.degrees_of_freedom
    (0.982, 3)
    """
    across, up = _pairs(x, y)
    people, who = np.unique(np.asarray(participants), return_inverse=True)
    if len(who) != len(across):
        raise ValueError("participants, x and y must be of the same length")
    counts = np.bincount(who)
    within_x = _residual(across, (np.bincount(who, across) / counts)[who], "x within people")
    within_y = _residual(up, (np.bincount(who, up) / counts)[who], "y within people")
    return _correlation(
        float(within_x @ within_y),
        n=len(across),
        degrees_of_freedom=len(across) - len(people) - 1,
        confidence=confidence,
        participants=len(people),
    )


def _pairs(x: Sequence[float] | Floats, y: Sequence[float] | Floats) -> tuple[Floats, Floats]:
    across, up = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    if across.ndim != 1 or across.shape != up.shape or len(across) < 3:
        raise ValueError("x and y must be two lists of the same length, three values or more")
    if not (np.all(np.isfinite(across)) and np.all(np.isfinite(up))):
        raise ValueError("x and y must be finite")
    return across, up


def _residual(values: Floats, means: Floats | float, name: str) -> Floats:
    """Take means off, and refuse what is constant but for rounding."""
    residual = values - means
    if np.linalg.norm(residual) <= 1e-12 * np.linalg.norm(values):
        raise ValueError(f"{name} does not vary")
    return np.asarray(residual / np.linalg.norm(residual))


def _correlation(
    r: float, *, n: int, degrees_of_freedom: int, confidence: float, participants: int | None
) -> Correlation:
    from scipy.stats import norm, t

    r = min(1.0, max(-1.0, r))
    if degrees_of_freedom < 1:
        raise ValueError("there are too few values for a correlation")
    interval = None
    if degrees_of_freedom > 1 and abs(r) < 1.0:
        reach = norm.ppf(0.5 + confidence / 2.0) / np.sqrt(degrees_of_freedom - 1.0)
        interval = (float(np.tanh(np.arctanh(r) - reach)), float(np.tanh(np.arctanh(r) + reach)))
    with np.errstate(divide="ignore"):
        statistic = abs(r) * np.sqrt(degrees_of_freedom / np.float64(1.0 - r * r))
    pooled = participants is None
    return Correlation(
        r=r,
        p=float(2.0 * t.sf(statistic, degrees_of_freedom)),
        n=n,
        participants=participants,
        degrees_of_freedom=degrees_of_freedom,
        interval=interval,
        method="Pearson, all trials pooled" if pooled else "repeated measures (Bakdash & Marusich 2017)",
        warning=POOLED_WARNING if pooled else None,
    )
