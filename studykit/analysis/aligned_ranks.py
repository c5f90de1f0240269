"""Test every factor and interaction by ranks, when everybody danced all combinations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from typing import TYPE_CHECKING

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError, nearest

if TYPE_CHECKING:
    import pandas as pd

VARIANT = (
    "aligned rank transform, repeated-measures analysis of variance of the ranks, each effect against its "
    "own interaction with participants"
)
CONTRAST_VARIANT = (
    "aligned rank transform for contrasts (ART-C), paired t of the ranks, each pair against its own "
    "variation between participants; p not corrected for the number of pairs"
)


@dataclass(frozen=True, kw_only=True, slots=True)
class FactorialEffect:
    """Whether one factor, or several in combination, have an effect.

    Parameters
    ----------
    effect : str
        Such as ``intensity`` or ``intensity:variety``.
    f : float
    df : tuple of int
        Of the effect and of its error: (levels - 1, multiplied) and that times (participants - 1).
    p : float
    partial_eta_squared : float
        Share of the ranks' variation (effect + its error) that the effect makes, 0 to 1.
    epsilon : float
        Greenhouse & Geisser's: 1 where the differences between levels vary alike, or with two levels.
    p_greenhouse_geisser : float
        p with both degrees of freedom times epsilon.
    n : int
        Participants.
    left_out : tuple of str
        Participants without a value in every combination.
    variant : str
        How it was computed.
    """

    effect: str
    f: float
    df: tuple[int, int]
    p: float
    partial_eta_squared: float
    epsilon: float
    p_greenhouse_geisser: float
    n: int
    left_out: tuple[str, ...]
    variant: str = VARIANT


@dataclass(frozen=True, kw_only=True, slots=True)
class RankContrast:
    """Whether two levels, or two combinations of levels, differ.

    Parameters
    ----------
    a, b : str
        What is compared, such as ``intense, hard``; positive t means that a ranks higher.
    mean_rank_difference : float
        Of the aligned ranks.
    t : float
    df : int
        Participants - 1.
    p : float
        Two-sided, not corrected for the number of pairs.
    variant : str
        How it was computed.
    """

    a: str
    b: str
    mean_rank_difference: float
    t: float
    df: int
    p: float
    variant: str = CONTRAST_VARIANT


@dataclass(frozen=True, kw_only=True, slots=True)
class _Cells:
    """Everybody's values in every combination: shape (participant, level of factor 1, of factor 2, ...)."""

    values: Floats
    factors: tuple[str, ...]
    levels: tuple[tuple[str, ...], ...]
    left_out: tuple[str, ...]


def aligned_ranks(trials: pd.DataFrame, outcome: str, factors: Sequence[str]) -> tuple[FactorialEffect, ...]:
    """Test each factor and each interaction without assuming that values are normally distributed.

    Parameters
    ----------
    trials : pandas.DataFrame
        One row a valid trial, columns as in `tables.TRIALS`; several trials of a combination are averaged.
    outcome : str
        Column of the values.
    factors : sequence of str
        Columns of two or more levels each, all varied within participants.

    Returns
    -------
    tuple of FactorialEffect
        Main effects first. Only participants with a value in every combination count; each result names the
        others.

    Raises
    ------
    InputError
        If a column is missing, a factor has one level, fewer than two people are complete, the values do not
        vary or an effect is the same in everybody.

    Notes
    -----
    Wobbrock et al. 2011 (doi 10.1145/1978942.1978963): for each effect the values are stripped of all others
    (residual from the combination's mean + the estimated effect), ranked over all trials with midranks, and
    tested for that effect only. The error of an effect is its interaction with participants, as in
    ``aov(rank ~ A * B + Error(participant / (A * B)))``: a random intercept alone, or
    ``Error(participant)``, would pool all errors and claim too many degrees of freedom.
    """
    cells = _cells(trials, outcome, factors)
    contrasts = {effect: _contrasts(cells, effect) for effect in _effects(len(factors))}
    found = []
    for effect, own in contrasts.items():
        aligned = align(cells.values, effect)
        _refuse_misaligned(aligned, [other for name, other in contrasts.items() if name != effect])
        if np.ptp(aligned) <= 1e-9 * np.abs(cells.values).max():
            raise InputError("the values do not vary", where=outcome, remedy="choose another outcome")
        found.append(_tested(cells, effect, own))
    return tuple(found)


def contrasts_of_aligned_ranks(
    trials: pd.DataFrame, outcome: str, factors: Sequence[str], *, of: Sequence[str]
) -> tuple[RankContrast, ...]:
    """Compare all pairs of levels of a factor, or of combinations of several factors' levels.

    Parameters
    ----------
    trials, outcome, factors
        As for `aligned_ranks`.
    of : sequence of str
        The factors whose levels, or combinations of levels, are compared; the others are averaged over.

    Returns
    -------
    tuple of RankContrast
        p is not corrected for the number of pairs: see `multiplicity.holm`.

    Raises
    ------
    InputError
        As for `aligned_ranks`, and if `of` names no factor.

    Notes
    -----
    Elkin et al. 2021 (doi 10.1145/3472749.3474784): the factors compared are made into one, and the values
    are aligned for its main effect. Ranks aligned for an interaction would be wrong for such pairs.
    """
    from scipy.stats import ttest_rel

    cells = _cells(trials, outcome, factors)
    for name in of:
        if name not in factors:
            raise InputError(f'there is no factor "{name}"', where="of", remedy=nearest(name, factors))
    places = sorted(factors.index(name) for name in of)
    if not places:
        raise InputError("no factor is compared", where="of", remedy=f"name one of: {', '.join(factors)}")
    ranks = _ranked(_aligned_for_combinations(cells.values, places))
    others = tuple(place + 1 for place in range(len(factors)) if place not in places)
    means = ranks.mean(axis=others).reshape(len(ranks), -1)
    names = [", ".join(levels) for levels in product(*(cells.levels[place] for place in places))]
    found = []
    for a, b in combinations(range(len(names)), 2):
        difference = means[:, a] - means[:, b]
        if np.ptp(difference) == 0.0:
            raise InputError(
                f"{names[a]} and {names[b]} differ by the same in everybody",
                where=outcome,
                remedy="look at the values themselves",
            )
        test = ttest_rel(means[:, a], means[:, b])
        found.append(
            RankContrast(
                a=names[a],
                b=names[b],
                mean_rank_difference=float(difference.mean()),
                t=float(test.statistic),
                df=len(difference) - 1,
                p=float(test.pvalue),
            )
        )
    return tuple(found)


def align(values: Floats, effect: Iterable[int]) -> Floats:
    """Take everything off the values but one effect and what no effect explains.

    Parameters
    ----------
    values : ndarray, shape (participant, level of factor 1, ...)
    effect : iterable of int
        The factors that interact in it, counted from 0; one for a main effect.

    Returns
    -------
    ndarray
        Residual from the combination's mean, plus the effect's estimate; sums to zero.
    """
    means = values.mean(axis=0)
    estimate = means
    for axis in range(means.ndim):
        average = estimate.mean(axis=axis, keepdims=True)
        # Of a factor in the effect only the deviation counts, of any other only the mean.
        estimate = estimate - average if axis in set(effect) else np.broadcast_to(average, means.shape)
    return np.asarray(values - means + estimate)


def _aligned_for_combinations(values: Floats, places: Sequence[int]) -> Floats:
    means = values.mean(axis=0)
    others = tuple(axis for axis in range(means.ndim) if axis not in places)
    return np.asarray(values - means + means.mean(axis=others, keepdims=True) - means.mean())


def _ranked(aligned: Floats) -> Floats:
    from scipy.stats import rankdata

    # What is equal but for rounding is tied.
    step = 1e-9 * float(np.abs(aligned).max() or 1.0)
    return np.asarray(rankdata(np.rint(aligned / step)), dtype=np.float64).reshape(aligned.shape)


def _effects(factors: int) -> Iterator[tuple[int, ...]]:
    for size in range(1, factors + 1):
        yield from combinations(range(factors), size)


def _contrasts(cells: _Cells, effect: Sequence[int]) -> Floats:
    """Give orthonormal contrasts of an effect, shape (combination, contrast)."""
    contrasts = np.ones((1, 1))
    for place, levels in enumerate(cells.levels):
        count = len(levels)
        mean = np.full((count, 1), count**-0.5)
        # An orthonormal basis whose first column is the mean: the others are the contrasts.
        basis = np.linalg.qr(np.column_stack((mean, np.eye(count)[:, 1:])))[0]
        contrasts = np.kron(contrasts, basis[:, 1:] if place in effect else mean)
    return contrasts


def _refuse_misaligned(aligned: Floats, others: Sequence[Floats]) -> None:
    """Check that aligned values sum to zero and hold nothing of the other effects."""
    size = float(np.abs(aligned).sum()) or 1.0
    flat = aligned.reshape(len(aligned), -1)
    left = max((float(np.abs((flat @ other).mean(axis=0)).max()) for other in others), default=0.0)
    if abs(aligned.sum()) > 1e-8 * size or left > 1e-8 * size:
        raise ArithmeticError("the aligned values still hold other effects than the one they are aligned for")


def _tested(cells: _Cells, effect: Sequence[int], contrasts: Floats) -> FactorialEffect:
    """Test one effect in its ranks, by its contrasts of every participant."""
    from scipy.stats import f as fisher

    ranks = _ranked(align(cells.values, effect))
    scores = ranks.reshape(len(ranks), -1) @ contrasts
    people, width = scores.shape
    mean = scores.mean(axis=0)
    spread = (scores - mean).T @ (scores - mean)
    between, within = people * float(mean @ mean), float(np.trace(spread))
    freedom = (width, width * (people - 1))
    name = ":".join(cells.factors[place] for place in effect)
    if within <= 1e-12 * float(np.sum(ranks**2)):
        raise InputError(
            "the effect is the same in everybody", where=name, remedy="look at the values themselves"
        )
    f = (between / freedom[0]) / (within / freedom[1])
    epsilon = within**2 / (width * float(np.sum(spread**2)))
    return FactorialEffect(
        effect=name,
        f=f,
        df=freedom,
        p=float(fisher.sf(f, *freedom)),
        partial_eta_squared=between / (between + within),
        epsilon=epsilon,
        p_greenhouse_geisser=float(fisher.sf(f, epsilon * freedom[0], epsilon * freedom[1])),
        n=people,
        left_out=cells.left_out,
    )


def _cells(trials: pd.DataFrame, outcome: str, factors: Sequence[str]) -> _Cells:
    for name in (outcome, "participant", *factors):
        if name not in trials.columns:
            raise InputError(
                f'there is no column "{name}"', where="trials", remedy=nearest(name, map(str, trials.columns))
            )
    usable = trials[np.isfinite(trials[outcome].to_numpy(dtype=np.float64))]
    levels = tuple(tuple(sorted(trials[name].unique())) for name in factors)
    for name, found in zip(factors, levels, strict=True):
        if len(found) < 2:
            raise InputError(f"{name} has one level only", where=name, remedy="leave this factor out")
    table = usable.pivot_table(index="participant", columns=list(factors), values=outcome, aggfunc="mean")
    wanted = list(product(*levels)) if len(factors) > 1 else list(levels[0])
    table = table.reindex(columns=wanted)
    complete = table.dropna()
    if len(complete) < 2:
        raise InputError(
            f"participants with a value in all {len(wanted)} combinations of {', '.join(factors)}: "
            f"{len(complete)}",
            where=outcome,
            remedy="record two such participants or more, or use a mixed model, which allows missing trials",
        )
    return _Cells(
        values=complete.to_numpy(dtype=np.float64).reshape(-1, *(len(found) for found in levels)),
        factors=tuple(factors),
        levels=tuple(tuple(map(str, found)) for found in levels),
        left_out=tuple(sorted(set(trials["participant"].astype(str)) - set(complete.index.astype(str)))),
    )
