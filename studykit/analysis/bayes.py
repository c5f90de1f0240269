"""Weigh how much the data speak for a difference between two conditions, or for none."""

from __future__ import annotations

import numpy as np

from studykit.core.arrays import Floats

VARIANT = "paired Bayes factor, Jeffreys-Zellner-Siow prior with scale 0.707 (Rouder et al. 2009)"


def bayes_factor(a: Floats, b: Floats) -> float:
    """Give how many times likelier the data are if two conditions differ than if they do not.

    Parameters
    ----------
    a, b : array_like, shape (participant,)
        The two conditions of people who danced both.

    Returns
    -------
    float
        Above 1 the data speak for a difference, below 1 for none; see `evidence`.

    Raises
    ------
    ValueError
        If the lists differ in length, hold fewer than two values, are not finite or all differ by the same.

    Notes
    -----
    Rouder et al. 2009 (doi 10.3758/PBR.16.2.225), by pingouin: the standardised difference has a Cauchy prior
    of scale 0.707 around zero if there is one. The factor depends on that choice.
    """
    import pingouin
    from scipy.stats import ttest_1samp

    differences = np.asarray(a, dtype=np.float64) - np.asarray(b, dtype=np.float64)
    if differences.ndim != 1 or len(differences) < 2 or not np.all(np.isfinite(differences)):
        raise ValueError("a and b must be two finite lists of the same length, two values or more")
    if np.ptp(differences) <= 1e-12 * np.abs(differences).max():
        raise ValueError("all differences are alike")
    t = float(ttest_1samp(differences, 0.0).statistic)
    return float(pingouin.bayesfactor_ttest(t, len(differences), paired=True, r=0.707))


def evidence(factor: float) -> str:
    """Say in words how strongly a Bayes factor speaks, and for what.

    Parameters
    ----------
    factor : float
        As `bayes_factor` gives it.

    Notes
    -----
    The words of Lee & Wagenmakers 2013 after Jeffreys 1961. They are conventions, not thresholds.

    Examples
    --------
    >>> evidence(17.2), evidence(0.25)
    ('strong evidence for a difference', 'moderate evidence for no difference')
    """
    for_what = "a difference" if factor >= 1.0 else "no difference"
    strength = max(factor, 1.0 / factor) if factor > 0.0 else np.inf
    words = ("anecdotal", "moderate", "strong", "very strong", "extreme")
    return f"{words[int(np.searchsorted([3.0, 10.0, 30.0, 100.0], strength))]} evidence for {for_what}"
