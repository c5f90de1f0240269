"""Fit a straight-line model to people who were measured repeatedly, each with a level of their own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from studykit.core.arrays import Floats, Integers

# Below the first ratio of the variances people do not differ (lme4 draws the line there too); above the
# second the trials of one person do not.
_SMALLEST_RATIO, _LARGEST_RATIO = 1e-8, 1e8
# What share of a column must be new for it to count as not aliased with the columns before it.
_NEW = 1e-8


@dataclass(frozen=True, kw_only=True, slots=True)
class Coefficient:
    """One number that the model estimates, with its uncertainty.

    Parameters
    ----------
    name : str
        Such as ``intensity[intense]``.
    estimate, standard_error : float
        In the outcome's unit.
    degrees_of_freedom : float
        Of t.
    t, p : float
        Two-sided test of no effect.
    interval : tuple of float
        Plausible values, in the outcome's unit.
    """

    name: str
    estimate: float
    standard_error: float
    degrees_of_freedom: float
    t: float
    p: float
    interval: tuple[float, float]

    @classmethod
    def of(
        cls,
        name: str,
        *,
        estimate: float,
        standard_error: float,
        degrees_of_freedom: float,
        confidence: float,
    ) -> Self:
        """Test an estimate against zero, and give its interval.

        Parameters
        ----------
        name : str
            What to call it.
        estimate, standard_error : float
            In the outcome's unit.
        degrees_of_freedom : float
            Of t.
        confidence : float
            Coverage of the interval, 0 to 1.
        """
        from scipy.special import stdtr, stdtrit

        t = estimate / standard_error
        reach = standard_error * float(stdtrit(degrees_of_freedom, 0.5 + confidence / 2.0))
        return cls(
            name=name,
            estimate=estimate,
            standard_error=standard_error,
            degrees_of_freedom=degrees_of_freedom,
            t=t,
            p=float(2.0 * stdtr(degrees_of_freedom, -abs(t))),
            interval=(estimate - reach, estimate + reach),
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Term:
    """Whether one term of the model has any effect, beside all the others.

    Parameters
    ----------
    name : str
        Such as ``intensity:variety``.
    f : float
        Type III: each term is tested with all others in the model.
    numerator_df, denominator_df : float
        Degrees of freedom.
    p : float
    """

    name: str
    f: float
    numerator_df: int
    denominator_df: float
    p: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Columns:
    """The columns that one term brings into the model.

    Parameters
    ----------
    term : str
        What they stand for together.
    names : tuple of str
        One a column.
    values : ndarray, shape (trial, column)
    """

    term: str
    names: tuple[str, ...]
    values: Floats


def independent(design: Floats) -> list[int]:
    """Find the columns that say something which the columns before them do not.

    Parameters
    ----------
    design : ndarray, shape (trial, column)

    Returns
    -------
    list of int
        Numbers of the columns kept, in order.
    """
    basis = np.empty((len(design), 0))
    kept = []
    for number, column in enumerate(design.T):
        new = column - basis @ (basis.T @ column)
        new -= basis @ (basis.T @ new)  # twice is enough (Kahan): rounding of the first pass is taken off
        length = np.linalg.norm(new)
        if length > _NEW * np.linalg.norm(column):
            basis = np.column_stack((basis, new / length))
            kept.append(number)
    return kept


class RandomIntercept:
    """A linear model with one random level a person, fitted by restricted maximum likelihood.

    Parameters
    ----------
    design : ndarray, shape (trial, column)
        Independent columns (see `independent`).
    values : ndarray, shape (trial,)
        The outcome.
    people : ndarray of int, shape (trial,)
        Who each trial is of, counted from 0.

    Raises
    ------
    ValueError
        If there are too few trials, the data cannot tell differences between people from those within them,
        or the model leaves nothing unexplained.

    Notes
    -----
    What the columns do not reach of the outcome falls into independent parts: one for every eigenvector of
    what they do not reach of the people's membership, with the variance within + between d for its
    eigenvalue d, and the rest, with the variance within alone. The restricted likelihood is a sum over them,
    and with the ratio between / within profiled its maximum is the root of one function of one number
    (Patterson & Thompson 1971; Kang et al. 2008, doi 10.1534/genetics.107.080101). Degrees of freedom:
    Satterthwaite 1946 with the observed information of the two variances, for several directions Fai &
    Cornelius 1996 (doi 10.1080/00949659608811740), as in lmerTest (Kuznetsova et al. 2017,
    doi 10.18637/jss.v082.i13).
    """

    def __init__(self, design: Floats, values: Floats, people: Integers) -> None:
        self.design, self.people = design, people
        membership = (people[:, None] == np.arange(people.max() + 1)).astype(np.float64)
        self._divide(design, values, membership)
        ratio = self._best_ratio()
        self.within = float(np.sum(self._squares / (1.0 + ratio * self._d)) / self._counts.sum())
        self.between = ratio * self.within
        self.is_singular = ratio == 0.0
        self._estimate(design, values, membership)

    def _divide(self, design: Floats, values: Floats, membership: Floats) -> None:
        """Find the parts: sum of squares, number of contrasts and eigenvalue of each; the rest is first."""
        reached = np.linalg.qr(design)[0]
        residual = values - reached @ (reached.T @ values)
        around = membership - reached @ (reached.T @ membership)
        eigenvalues, vectors = np.linalg.eigh(around.T @ around)
        between = eigenvalues > 1e-9
        axes = around @ (vectors[:, between] / np.sqrt(eigenvalues[between]))
        along = axes.T @ residual
        rest = residual - axes @ along
        self._d = np.concatenate(([0.0], eigenvalues[between]))
        self._squares = np.concatenate(([rest @ rest], along**2))
        left = len(values) - design.shape[1]
        self._counts = np.concatenate(([left - len(along)], np.ones(len(along))))
        if left < 1:
            raise ValueError(f"the model has as many terms as there are trials, {len(values)}")
        if not len(along) or not self._counts[0]:
            raise ValueError("differences between people cannot be told from differences within them")
        if residual @ residual <= 1e-20 * float(values @ values):
            raise ValueError("the model leaves nothing unexplained")

    def _score(self, ratio: float) -> float:
        """Slope of -2 log likelihood over the ratio of the variances."""
        share = self._d / (1.0 + ratio * self._d)
        weighted = self._squares / (1.0 + ratio * self._d)
        return float(share.sum() - self._counts.sum() * (weighted @ share) / weighted.sum())

    def _best_ratio(self) -> float:
        from scipy.optimize import brentq

        # The profile may have more than one turn in unbalanced data: look for the lowest one on a grid first.
        grid = np.concatenate(([0.0], np.geomspace(_SMALLEST_RATIO, _LARGEST_RATIO, 161)))
        spread = 1.0 + grid[:, None] * self._d
        weighted = (self._squares / spread).sum(axis=1)
        lowest = int(np.argmin(np.log(spread).sum(axis=1) + self._counts.sum() * np.log(weighted)))
        if lowest == len(grid) - 1:
            raise ValueError("the model leaves nothing unexplained within people")
        low, high = grid[max(lowest - 1, 0)], grid[lowest + 1]
        if not self._score(low) < 0.0 < self._score(high):
            return 0.0  # the profile rises from zero on, or is so flat there that rounding decides
        ratio = float(brentq(self._score, low, high, xtol=1e-15, rtol=1e-13))
        return ratio if ratio > _SMALLEST_RATIO else 0.0

    def _estimate(self, design: Floats, values: Floats, membership: Floats) -> None:
        sizes = membership.sum(axis=0)
        # Inverse of the covariance: within every person (I - share J) / within.
        shares = self.between / (self.within + self.between * sizes)
        sums = membership.T @ design
        precision = (design.T @ design - sums.T @ (shares[:, None] * sums)) / self.within
        self.covariance = np.linalg.inv(precision)
        self.estimates = self.covariance @ (
            (design.T @ values - sums.T @ (shares * (membership.T @ values))) / self.within
        )
        self.residuals = values - design @ self.estimates
        # Derivatives of the estimates' covariance: C X'W (dV) W X C, W X = (X - share of the sums) / within.
        weighted = (design - membership @ (shares[:, None] * sums)) / self.within
        weighted_sums = membership.T @ weighted
        slopes = [weighted.T @ weighted, weighted_sums.T @ weighted_sums]
        self._slopes = [self.covariance @ slope @ self.covariance for slope in slopes]
        variances = self.within + self.between * self._d
        curvature = (2.0 * self._squares / variances - self._counts) / variances**2
        powers = np.vstack((np.ones_like(self._d), self._d))
        information = 0.5 * (powers * curvature) @ powers.T
        if self.is_singular:
            # On the boundary only the variance within people is estimated.
            self._uncertainty = np.diag([1.0 / information[0, 0], 0.0])
        else:
            self._uncertainty = np.linalg.inv(information)

    def _degrees_of_freedom(self, direction: Floats) -> float:
        gradient = np.array([direction @ slope @ direction for slope in self._slopes])
        variance = float(direction @ self.covariance @ direction)
        return float(2.0 * variance**2 / (gradient @ self._uncertainty @ gradient))

    def coefficient(self, name: str, direction: Floats, *, confidence: float) -> Coefficient:
        """Estimate one combination of the columns' coefficients, as if all people responded alike.

        Parameters
        ----------
        name : str
            What to call it.
        direction : ndarray, shape (column,)
            Weight of each column's coefficient.
        confidence : float
            Coverage of the interval, 0 to 1.
        """
        return Coefficient.of(
            name,
            estimate=float(direction @ self.estimates),
            standard_error=float(np.sqrt(direction @ self.covariance @ direction)),
            degrees_of_freedom=self._degrees_of_freedom(direction),
            confidence=confidence,
        )

    def term(self, name: str, columns: Sequence[int]) -> Term:
        """Test whether the coefficients of some columns are all zero, as if all people responded alike.

        Parameters
        ----------
        name : str
            What to call it.
        columns : sequence of int
            Their numbers.
        """
        from scipy.special import fdtrc

        block = self.covariance[np.ix_(columns, columns)]
        variances, vectors = np.linalg.eigh(block)
        directions = np.zeros((len(columns), len(self.estimates)))
        directions[:, columns] = vectors.T
        statistic = float(np.mean((directions @ self.estimates) ** 2 / variances))
        freedom = _pooled(np.array([self._degrees_of_freedom(direction) for direction in directions]))
        return Term(
            name=name,
            f=statistic,
            numerator_df=len(columns),
            denominator_df=freedom,
            p=float(fdtrc(len(columns), freedom, statistic)),
        )


def _pooled(freedoms: Floats) -> float:
    """Degrees of freedom of a mean of squared t values (Fai & Cornelius 1996)."""
    if np.ptp(freedoms) < 1e-8:
        return float(freedoms.mean())
    if np.any(freedoms <= 2.0):
        return 2.0
    expected = float(np.sum(freedoms / (freedoms - 2.0)))
    return 2.0 * expected / (expected - len(freedoms))
