"""Tell what each factor does when everybody danced several conditions in an order that also matters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from studykit.analysis.cluster_robust import ClusterRobust
from studykit.analysis.random_intercept import Coefficient, Columns, RandomIntercept, Term, independent
from studykit.core.arrays import Floats, Integers
from studykit.core.errors import InputError, nearest

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Coefficient", "MixedModel", "Term", "mixed_model"]

VARIANT = (
    "linear mixed model with a random intercept a participant, estimated by restricted maximum likelihood; "
    "sum-to-zero contrasts; standard errors robust to participants who respond differently (CR2, clustered "
    "by participant); t with Satterthwaite's degrees of freedom, F of type III by Hotelling's T-squared, "
    "approximated (HTZ)"
)
SINGULAR = (
    "participants do not differ beyond what their trials do: the variance between them is estimated as zero"
)
BETWEEN = "; {} lies between participants and is tested by the variance between them (Wald F, Satterthwaite)"
UNSURE = "the participants are too few, or too much alike, to tell how uncertain these are, left out: {}"

# How many of the numbers left out are named.
_FEW = 6
# What says where in the study a trial stood: it is allowed for, and its levels are not compared in pairs.
_PLACES = frozenset({"period", "sequence"})


@dataclass(frozen=True, kw_only=True, slots=True)
class MixedModel:
    """What a linear mixed model with a level for every participant finds.

    Parameters
    ----------
    formula : str
        The model in the notation of lme4.
    coefficients : tuple of Coefficient
        Of sum-to-zero contrasts: ``intensity[intense]`` is how far that level lies from the mean of the
        levels. The last level of each factor is minus the sum of the others.
    differences : tuple of Coefficient
        Level minus level of every factor, the other factors' levels weighing alike, such as
        ``intensity: intense - light``.
    means : tuple of Coefficient
        Of every level of every factor and of every period, all else weighing alike, such as
        ``intensity: intense``.
    terms : tuple of Term
        One F test a term.
    between_sd, within_sd : float
        Standard deviation of the participants' levels and of trials within participants, in the outcome's
        unit.
    n, participants : int
        Trials and participants used.
    is_singular : bool
        Whether the variance between participants is estimated as zero.
    notes : tuple of str
        What was left out, could not be told apart or is on the boundary, in words.
    variant : str
        How it was computed.
    """

    formula: str
    coefficients: tuple[Coefficient, ...]
    differences: tuple[Coefficient, ...]
    means: tuple[Coefficient, ...]
    terms: tuple[Term, ...]
    between_sd: float
    within_sd: float
    n: int
    participants: int
    is_singular: bool
    notes: tuple[str, ...]
    variant: str


def mixed_model(
    trials: pd.DataFrame,
    outcome: str,
    *,
    factors: Sequence[str],
    with_period: bool = True,
    with_carry_over: bool = True,
    confidence: float = 0.95,
) -> MixedModel:
    """Estimate the effect of every factor, beside the order of the conditions and each person's own level.

    Parameters
    ----------
    trials : pandas.DataFrame
        One row a valid trial, columns as in `tables.TRIALS`; conditions and trials may be missing.
    outcome : str
        Column of the values; rows without one are left out, and counted in the notes.
    factors : sequence of str
        Columns whose levels are crossed; one with a single level is left out, with a note.
    with_period : bool
        Whether the place in the session counts.
    with_carry_over : bool
        Whether the condition before counts.
    confidence : float
        Coverage of the intervals, 0 to 1.

    Raises
    ------
    InputError
        If a column is missing or the data are too few.

    Notes
    -----
    Period is a category, not a slope: warming up and tiring need not be straight, a session of eight trials
    can afford the seven degrees of freedom, and the first period, in which nothing can carry over, then has a
    mean of its own. Carry-over is therefore coded as sum-to-zero contrasts of the condition before, all zero
    in the first period ("none"): whatever distinguishes "none" from the others is the first period's mean, so
    that the two are not aliased (Jones & Kenward 2014, ch. 5). Without period, "none" is a term of its own.

    People differ in their level, and also in how strongly a factor acts on them. The model knows the first
    alone, and its own interval of a factor would be too narrow; uncertainty is therefore taken from how the
    participants differ, whatever their trials have in common (`ClusterRobust`). What lies wholly between
    participants, the sequence, is the exception: it is tested against the variance between them, as ever.
    Orders are given by chance, so that people vary alike in all of them unless sequence matters, and two or
    three people a sequence are too few to estimate a variance of each.
    """
    used, notes = with_values(trials, outcome, [*factors, "participant", "period", "previous_condition"])
    blocks = factorial(used, factors, notes)
    formula = [" * ".join(block.term for block in blocks if ":" not in block.term)] if blocks else ["1"]
    if with_period:
        blocks.append(categories(used["period"], "period"))
        formula.append("period")
    if with_carry_over:
        if not with_period:
            blocks.append(_first_period(used))
        blocks.append(carry_over(used))
        formula.append("carry-over")
    return fitted(
        used,
        outcome,
        blocks,
        formula=" + ".join((*formula, "(1 | participant)")),
        notes=notes,
        confidence=confidence,
    )


def with_values(trials: pd.DataFrame, outcome: str, columns: Sequence[str]) -> tuple[pd.DataFrame, list[str]]:
    """Give the trials that have a finite value, and say how many have none.

    Parameters
    ----------
    trials : pandas.DataFrame
    outcome : str
        Column of the values.
    columns : sequence of str
        Further columns needed.

    Raises
    ------
    InputError
        If a column is missing or nothing is left.
    """
    for name in (outcome, *columns):
        if name not in trials.columns:
            raise InputError(
                f'there is no column "{name}"', where="trials", remedy=nearest(name, map(str, trials.columns))
            )
    finite = np.isfinite(trials[outcome].to_numpy(dtype=np.float64))
    if not finite.any():
        raise InputError("no trial has a value", where=outcome, remedy="choose an outcome that was measured")
    without = int(np.sum(~finite))
    return trials[finite], [f"{without} trials without a value are left out"] if without else []


def categories(values: pd.Series, term: str) -> Columns:
    """Give the sum-to-zero columns of a factor; values that are missing have zeros.

    Parameters
    ----------
    values : pandas.Series
        One level a trial.
    term : str
        What the factor is called.
    """
    levels = sorted(values[_is_given(values)].unique())
    ones = np.stack([(values == level).to_numpy() for level in levels]).astype(np.float64) if levels else None
    contrasts = np.empty((len(values), 0)) if ones is None else (ones[:-1] - ones[-1:]).T
    return Columns(term=term, names=tuple(f"{term}[{level}]" for level in levels[:-1]), values=contrasts)


def carry_over(trials: pd.DataFrame) -> Columns:
    """Give the columns of the condition before, zero where there was none.

    Parameters
    ----------
    trials : pandas.DataFrame
        With a column ``previous_condition``.
    """
    return categories(trials["previous_condition"], "carry-over")


def _is_given(values: pd.Series) -> pd.Series[bool]:
    return values.notna() & (values != "")


def _first_period(trials: pd.DataFrame) -> Columns:
    none = ~_is_given(trials["previous_condition"]).to_numpy(dtype=bool)
    term = "no condition before"
    return Columns(term=term, names=(term,), values=none.astype(np.float64)[:, None])


def factorial(trials: pd.DataFrame, factors: Sequence[str], notes: list[str]) -> list[Columns]:
    """Give the columns of all factors and of their interactions, main effects first.

    Parameters
    ----------
    trials : pandas.DataFrame
    factors : sequence of str
        Columns whose levels are crossed.
    notes : list of str
        Takes a word about every factor that has one level only.
    """
    mains = []
    for name in factors:
        block = categories(trials[name], name)
        if block.names:
            mains.append(block)
        else:
            notes.append(f"{name} has one level only and is left out")
    return [_product(blocks) for size in range(1, len(mains) + 1) for blocks in combinations(mains, size)]


def _product(blocks: Sequence[Columns]) -> Columns:
    values, names = blocks[0].values, blocks[0].names
    for block in blocks[1:]:
        values = (values[:, :, None] * block.values[:, None, :]).reshape(len(values), -1)
        names = tuple(f"{a}:{b}" for a in names for b in block.names)
    return Columns(term=":".join(block.term for block in blocks), names=names, values=values)


def fitted(
    trials: pd.DataFrame,
    outcome: str,
    blocks: Sequence[Columns],
    *,
    formula: str,
    notes: Sequence[str],
    confidence: float,
) -> MixedModel:
    """Fit the columns given, leaving out what cannot be told from the columns before it.

    Parameters
    ----------
    trials : pandas.DataFrame
        Each with a finite value.
    outcome : str
        Column of the values.
    blocks : sequence of Columns
        Terms, in the order in which they claim what they share.
    formula : str
        The right-hand side, in words.
    notes : sequence of str
        What was said before.
    confidence : float
        Coverage of the intervals, 0 to 1.

    Raises
    ------
    InputError
        If the data are too few.
    """
    people, who = np.unique(trials["participant"].to_numpy(dtype=str), return_inverse=True)
    design = np.column_stack((np.ones(len(trials)), *(block.values for block in blocks)))
    kept = independent(design)
    try:
        fit = RandomIntercept(design[:, kept], trials[outcome].to_numpy(dtype=np.float64), who)
    except ValueError as problem:
        raise InputError(
            str(problem), where=outcome, remedy="give several trials of two people or more, and fewer terms"
        ) from None
    unsure: list[str] = []
    between = _Judge(by=fit, confidence=confidence, unsure=unsure)
    robust = _Judge(by=ClusterRobust(fit), confidence=confidence, unsure=unsure)
    judges, names, said, variant = [robust], ["intercept"], list(notes), VARIANT
    terms, differences, means = [], [], []
    for block in blocks:
        places = range(len(names), len(names) + len(block.names))
        columns = [kept.index(place) for place in places if place in kept]
        judge = between if _is_between(block, who) else robust
        judges += [judge] * len(block.names)
        names += block.names
        if columns:
            terms += judge.term(block.term, columns)
        if columns and judge is between:
            variant += BETWEEN.format(block.term)
        if len(columns) < len(block.names) or not columns:
            said.append(_aliased(block, len(columns)))
        elif block.term in trials.columns:
            levels = _level_directions(trials[block.term], columns, len(kept))
            means += _means(judge, block.term, levels)
            differences += _differences(judge, block.term, levels)
    axes = zip(kept, np.eye(len(kept)), strict=True)
    coefficients = [one for place, axis in axes for one in judges[place].coefficient(names[place], axis)]
    if len(coefficients) < min(2, len(kept)):  # the intercept alone tells nothing that was asked
        raise InputError(
            "the participants are too few, or too much alike, to tell how uncertain anything is",
            where=outcome,
            remedy="give more participants, or fewer terms",
        )
    said += [SINGULAR] if fit.is_singular else []
    said += [UNSURE.format(_some(unsure))] if unsure else []
    return MixedModel(
        formula=f"{outcome} ~ {formula}",
        coefficients=tuple(coefficients),
        differences=tuple(differences),
        means=tuple(means),
        terms=tuple(terms),
        between_sd=float(np.sqrt(fit.between)),
        within_sd=float(np.sqrt(fit.within)),
        n=len(trials),
        participants=len(people),
        is_singular=fit.is_singular,
        notes=tuple(said),
        variant=variant,
    )


def _aliased(block: Columns, kept: int) -> str:
    if not block.names:
        return f"{block.term} does not vary and is left out"
    if not kept:
        return f"{block.term} cannot be told from the terms before it and is left out; they include it"
    lost = len(block.names) - kept
    return (
        f"{lost} of the {len(block.names)} contrasts of {block.term} cannot be told from the terms before "
        "it and are left out"
    )


def _level_directions(values: pd.Series, columns: Sequence[int], width: int) -> dict[object, Floats]:
    """Give what makes each level's distance from the mean: its contrast; for the last, minus all others."""
    unit = np.eye(width)[columns]
    levels = sorted(values.unique())
    return dict(zip(levels, (*unit, -unit.sum(axis=0)), strict=True))


def _means(judge: _Judge, term: str, levels: dict[object, Floats]) -> list[Coefficient]:
    return [
        one
        for level, away in levels.items()
        for one in judge.coefficient(f"{term}: {level}", np.eye(len(away))[0] + away)
    ]


def _differences(judge: _Judge, term: str, levels: dict[object, Floats]) -> list[Coefficient]:
    if term in _PLACES:
        return []
    return [
        one
        for a, b in combinations(levels, 2)
        for one in judge.coefficient(f"{term}: {a} - {b}", levels[a] - levels[b])
    ]


def _some(names: Sequence[str]) -> str:
    """Name a few, and count the rest."""
    rest = len(names) - _FEW
    return ", ".join(names) if rest <= 0 else f"{', '.join(names[:_FEW])} and {rest} more"


def _is_between(block: Columns, people: Integers) -> bool:
    """Tell whether all trials of a person have the same value in every column."""
    first = np.unique(people, return_index=True)[1]
    return bool(np.all(block.values == block.values[first][people]))


@dataclass(frozen=True, kw_only=True, slots=True)
class _Judge:
    """Who tells how sure an answer is; what cannot be told is left out and its name kept."""

    by: RandomIntercept | ClusterRobust
    confidence: float
    unsure: list[str]

    def coefficient(self, name: str, direction: Floats) -> list[Coefficient]:
        found = self.by.coefficient(name, direction, confidence=self.confidence)
        if found is None:
            self.unsure.append(name)
        return [] if found is None else [found]

    def term(self, name: str, columns: Sequence[int]) -> list[Term]:
        found = self.by.term(name, columns)
        if found is None:
            self.unsure.append(name)
        return [] if found is None else [found]
