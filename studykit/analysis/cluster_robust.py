"""Say how sure an estimate is when people may differ in how they respond, and not only in their level."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from studykit.analysis.random_intercept import Coefficient, RandomIntercept, Term
from studykit.core.arrays import Floats, Integers

# What share of a direction must be left of a participant's trials, once the others have had no say in it.
_LEFT = 1e-8
# How far the expected variance may lie from the working model's before it counts as another.
_SAME = 1e-6
# Variances below this share of the working model's are rounding.
_ROUNDING = 1e-14


class ClusterRobust:
    """Standard errors and tests that hold whatever the trials of one participant have in common.

    Parameters
    ----------
    fit : RandomIntercept
        Whose estimates are judged, and whose variances are the working model.

    Notes
    -----
    The covariance of the estimates is the sum over participants of what each of them pulls, squared, with
    residuals adjusted so that it is unbiased if the working model is right: bias-reduced linearisation, CR2
    (Bell & McCaffrey 2002; Pustejovsky & Tipton 2018, doi 10.1080/07350015.2016.1247004). One coefficient has
    t with Satterthwaite's degrees of freedom under the working model; several together have HTZ, Hotelling's
    T-squared on the Wishart distribution whose total variance is that of their covariance (as R's
    clubSandwich). With complete data and nothing else in the way, two conditions are compared by the paired t
    test of the participants' own differences.

    Each participant's block is padded to the longest with trials that nobody danced: rows of zeros with an
    identity for covariance, which add nothing. Covariances are in units of the variance within participants.
    """

    def __init__(self, fit: RandomIntercept) -> None:
        self._fit = fit
        blocks, is_trial = _blocks(np.column_stack((fit.design, fit.residuals)), fit.people)
        design, residuals = blocks[..., :-1], blocks[..., -1]
        sizes = is_trial.sum(axis=1)
        spread = 1.0 + fit.between / fit.within * sizes  # variance along what a participant's trials share
        together = is_trial[:, :, None] * is_trial[:, None, :] / sizes[:, None, None]
        covariance, root, inverse = (
            np.eye(is_trial.shape[1]) + (spread**power - 1.0)[:, None, None] * together
            for power in (1.0, 0.5, -0.5)
        )
        white = inverse @ design
        own = white @ (fit.covariance / fit.within)
        left = np.eye(is_trial.shape[1]) - own @ white.swapaxes(1, 2)
        weights = root @ _adjustment(left, covariance) @ own
        turned = weights.swapaxes(1, 2)
        self._pulls = np.einsum("ijp,ij->ip", weights, residuals)
        self._variances = fit.within * turned @ covariance @ weights
        self._reach = turned @ design @ np.linalg.cholesky(fit.covariance)

    def coefficient(self, name: str, direction: Floats, *, confidence: float) -> Coefficient | None:
        """Estimate one combination of the columns' coefficients.

        Parameters
        ----------
        name : str
            What to call it.
        direction : ndarray, shape (column,)
            Weight of each column's coefficient.
        confidence : float
            Coverage of the interval, 0 to 1.

        Returns
        -------
        Coefficient or None
            None if its uncertainty cannot be estimated: one participant alone decides a part of it, or all
            respond exactly alike.
        """
        scale = float(np.sqrt(direction @ self._fit.covariance @ direction))
        freedom = self._freedom(direction[None] / scale)
        variance = float(np.sum((self._pulls @ direction / scale) ** 2))
        if freedom is None or variance < _ROUNDING:
            return None
        return Coefficient.of(
            name,
            estimate=float(direction @ self._fit.estimates),
            standard_error=scale * float(np.sqrt(variance)),
            degrees_of_freedom=freedom,
            confidence=confidence,
        )

    def term(self, name: str, columns: Sequence[int]) -> Term | None:
        """Test whether the coefficients of some columns are all zero.

        Parameters
        ----------
        name : str
            What to call it.
        columns : sequence of int
            Their numbers.

        Returns
        -------
        Term or None
            None if there are too few participants for a test of so many coefficients.
        """
        from scipy.special import fdtrc

        count = len(columns)
        variances, vectors = np.linalg.eigh(self._fit.covariance[np.ix_(columns, columns)])
        directions = np.zeros((count, len(self._fit.estimates)))
        directions[:, columns] = (vectors / np.sqrt(variances)).T
        freedom = self._freedom(directions)
        if freedom is None or freedom <= count - 1:
            return None
        pulls = self._pulls @ directions.T
        covariance = pulls.T @ pulls
        if np.linalg.eigvalsh(covariance)[0] < _ROUNDING:
            return None
        away = directions @ self._fit.estimates
        squared = float(away @ np.linalg.solve(covariance, away))
        denominator = freedom - count + 1.0
        f = denominator / (freedom * count) * squared
        p = float(fdtrc(count, denominator, f))
        return Term(name=name, f=f, numerator_df=count, denominator_df=denominator, p=p)

    def _freedom(self, directions: Floats) -> float | None:
        """Degrees of freedom of the covariance along directions that are independent of variance 1.

        None if it cannot be unbiased: one participant alone decides a part of it. The pulls i and j along
        s and t have the covariance (i = j) own[i, s, t] - reach[i, s] . reach[j, t]; the variance of the sum
        over i of the products of pulls along s and t is that of normal values (Isserlis 1918), summed here
        without ever writing down a participant by participant matrix.
        """
        count = len(directions)
        own = directions @ self._variances @ directions.T
        reach = directions @ self._reach
        overlap = reach @ reach.swapaxes(1, 2)
        if np.abs((own - overlap).sum(axis=0) - np.eye(count)).max() > _SAME:
            return None
        gram = np.tensordot(reach, reach, axes=(0, 0))  # direction, column, direction, column
        traces, overlaps = np.trace(own, axis1=1, axis2=2), np.trace(overlap, axis1=1, axis2=2)
        total = np.sum(traces * (traces - 2.0 * overlaps)) + np.sum(own * (own - 2.0 * overlap))
        total += np.sum(gram * (gram + gram.swapaxes(1, 3)))
        return count * (count + 1.0) / float(total)


def _blocks(rows: Floats, people: Integers) -> tuple[Floats, Floats]:
    """Give the rows of each person, padded with zeros, and which of them are real."""
    sizes = np.bincount(people)
    order = np.argsort(people, kind="stable")
    place = np.arange(len(people)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    blocks = np.zeros((len(sizes), sizes.max(), rows.shape[1]))
    is_trial = np.zeros(blocks.shape[:2])
    blocks[people[order], place] = rows[order]
    is_trial[people[order], place] = 1.0
    return blocks, is_trial


def _adjustment(left: Floats, covariance: Floats) -> Floats:
    """Give (R Q R)^(-1/2), Q = R left R the covariance of residuals, R R that of the trials (generalised).

    R Q R is F'F with F = left^(1/2) R R: the singular values of F are as exact as R R is well conditioned,
    where the eigenvalues of R Q R would lose twice the digits.
    """
    shares, vectors = np.linalg.eigh(left)
    is_left = shares > _LEFT
    half = (vectors * np.sqrt(np.where(is_left, shares, 0.0))[:, None]) @ vectors.swapaxes(1, 2)
    _, lengths, axes = np.linalg.svd(half @ covariance)
    is_kept = np.arange(lengths.shape[1]) < is_left.sum(axis=1)[:, None]
    inverse = np.divide(1.0, lengths, out=np.zeros_like(lengths), where=is_kept)
    whole: Floats = axes.swapaxes(1, 2) @ (inverse[:, :, None] * axes)
    return whole
