"""A declared test: do conditions differ, which of them, and by how much."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from studykit.analysis import multiplicity
from studykit.analysis.friedman import Friedman, friedman, kendalls_w_interval
from studykit.analysis.planned.values import exclusions_of, values_of, why_not_compared
from studykit.analysis.results import ConditionSummary, PairResult, TestResult
from studykit.analysis.wilcoxon import PValue, Zeros, rank_biserial_interval, wilcoxon
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
    problem = why_not_compared(values, table)
    if problem:
        return TestResult(
            plan=plan,
            exclusions=exclusions,
            participants=len(table),
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
        summaries=_summaries(plan.conditions, table, omnibus.mean_ranks),
        pairs=_pairs(plan, complete, alpha),
    )


def _declared_p(plan: TestPlan, found: Friedman) -> float:
    """Give the p that the protocol names; F has none where all agree, and its p is 0 then."""
    if plan.p == "permutation":
        return found.permutation_p
    if plan.p == "f":
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
    corrected = _CORRECTIONS[plan.correction]([tests[0].p for tests in variants])
    return tuple(
        PairResult(
            a=a,
            b=b,
            median_difference=float(np.median(column[a] - column[b])),
            test=test,
            p_corrected=float(p),
            is_significant=bool(p < alpha),
            rank_biserial_interval=rank_biserial_interval(column[a], column[b], confidence=1.0 - alpha),
            p_by_variant={other.variant: other.p for other in others},
        )
        for (a, b), (test, *others), p in zip(pairs, variants, corrected, strict=True)
    )
