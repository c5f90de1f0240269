"""A declared test: do conditions differ, which of them, and by how much."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from studykit.analysis import multiplicity
from studykit.analysis.bayes import bayes_factor
from studykit.analysis.friedman import Friedman, friedman, kendalls_w_interval
from studykit.analysis.planned.values import exclusions_of, values_of, why_not_compared
from studykit.analysis.results import ConditionSummary, PairResult, TestResult
from studykit.analysis.skillings_mack import SkillingsMack, skillings_mack
from studykit.analysis.wilcoxon import PValue, Zeros, hodges_lehmann, rank_biserial_interval, wilcoxon
from studykit.core.arrays import Floats
from studykit.core.seeding import stream
from studykit.protocol.analysis_plan import TestPlan

if TYPE_CHECKING:
    import pandas as pd

_CORRECTIONS: dict[str, Callable[[Sequence[float]], Floats]] = {
    "holm": multiplicity.holm,
    "bonferroni": multiplicity.bonferroni,
    "none": np.asarray,
}
# Beside the variant that counts, these show that nothing hangs on the choice.
_VARIANTS: tuple[tuple[PValue, Zeros], ...] = (
    ("exact", "drop"),
    ("exact", "pratt"),
    ("normal", "drop"),
    ("normal_continuity", "drop"),
    ("normal", "pratt"),
)


def compare(plan: TestPlan, trials: pd.DataFrame, alpha: float) -> TestResult:
    """Make a declared test.

    Parameters
    ----------
    plan : TestPlan
        What was declared.
    trials : DataFrame
        All trials; only valid ones count, of people who have a value in all conditions.
    alpha : float
        Level of significance; intervals cover 1 - alpha.
    """
    values = values_of(trials, plan.conditions, trials[plan.outcome])
    complete = values.dropna()
    exclusions = exclusions_of(trials, plan.conditions, values, complete)
    table = complete.to_numpy()
    with_gaps, without_gaps_because = _with_gaps(plan, values)
    problem = why_not_compared(values, table)
    if problem:
        return TestResult(
            plan=plan,
            exclusions=exclusions,
            participants=len(table),
            skillings_mack=with_gaps,
            skillings_mack_not_computed_because=without_gaps_because,
            not_computed_because=problem,
        )
    omnibus = friedman(table, rng=stream(0, "friedman", plan.name))
    p = _declared_p(plan, omnibus)
    return TestResult(
        plan=plan,
        exclusions=exclusions,
        participants=len(table),
        friedman=omnibus,
        p=p,
        is_significant=p < alpha,
        kendalls_w_interval=kendalls_w_interval(
            table, rng=stream(0, "kendalls_w_interval", plan.name), confidence=1.0 - alpha
        ),
        skillings_mack=with_gaps,
        skillings_mack_not_computed_because=without_gaps_because,
        summaries=_summaries(plan.conditions, table, omnibus.mean_ranks),
        pairs=_pairs(plan, complete, alpha),
    )


def _with_gaps(plan: TestPlan, values: pd.DataFrame) -> tuple[SkillingsMack | None, str | None]:
    """Test with the people who lack a condition, or say why not; neither where it is not declared."""
    if plan.missing is None:
        return None, None
    try:
        return skillings_mack(values.to_numpy(), rng=stream(0, "skillings_mack", plan.name)), None
    except ValueError as problem:
        return None, str(problem)


def _declared_p(plan: TestPlan, found: Friedman) -> float:
    """Give the p that the protocol names; F has none where all agree, and its p is 0 then."""
    if plan.p_from == "permutation":
        return found.permutation_p
    if plan.p_from == "f":
        return 0.0 if found.f_p is None else found.f_p
    return found.p


def _summaries(
    conditions: Sequence[str], table: Floats, mean_ranks: Sequence[float]
) -> tuple[ConditionSummary, ...]:
    quartiles = np.quantile(table, [0.25, 0.5, 0.75], axis=0)
    return tuple(
        ConditionSummary(
            condition=name,
            mean=float(table[:, place].mean()),
            standard_deviation=float(table[:, place].std(ddof=1)),
            median=float(quartiles[1, place]),
            lower_quartile=float(quartiles[0, place]),
            upper_quartile=float(quartiles[2, place]),
            mean_rank=mean_ranks[place],
        )
        for place, name in enumerate(conditions)
    )


def _pairs(plan: TestPlan, complete: pd.DataFrame, alpha: float) -> tuple[PairResult, ...]:
    pairs = plan.pairs_list()
    column = {name: complete[name].to_numpy() for name in plan.conditions}
    declared: tuple[PValue, Zeros] = ("exact", plan.zeros or "drop")
    kinds = (declared, *(variant for variant in _VARIANTS if variant != declared))
    variants = [[wilcoxon(column[a], column[b], p=p, zeros=zeros) for p, zeros in kinds] for a, b in pairs]
    if plan.correction == "closed":
        places = [(plan.conditions.index(a), plan.conditions.index(b)) for a, b in pairs]
        corrected = multiplicity.closed_friedman(complete.to_numpy(), places)
    else:
        corrected = _CORRECTIONS[plan.correction]([tests[0].p for tests in variants])
    return tuple(
        PairResult(
            a=a,
            b=b,
            median_difference=float(np.median(column[a] - column[b])),
            shift=hodges_lehmann(column[a] - column[b], confidence=1.0 - alpha),
            test=test,
            p_corrected=float(p),
            is_significant=bool(p < alpha),
            rank_biserial_interval=rank_biserial_interval(column[a], column[b], confidence=1.0 - alpha),
            bayes_factor_10=_bayes_factor(column[a], column[b]),
            p_by_variant={other.variant: other.p for other in others},
        )
        for (a, b), (test, *others), p in zip(pairs, variants, corrected, strict=True)
    )


def _bayes_factor(a: Floats, b: Floats) -> float | None:
    """Give the Bayes factor; None where all differences are alike, which it cannot weigh."""
    differences = a - b
    if np.ptp(differences) <= 1e-12 * np.abs(differences).max():
        return None
    return bayes_factor(a, b)
