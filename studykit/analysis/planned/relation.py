"""A declared correlation: do two measurements change together."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from studykit.analysis import correlation
from studykit.analysis.planned.values import exclusions_of, values_of
from studykit.analysis.results import CorrelationResult
from studykit.protocol.analysis_plan import CorrelationPlan

if TYPE_CHECKING:
    import pandas as pd


def correlate(plan: CorrelationPlan, trials: pd.DataFrame, alpha: float) -> CorrelationResult:
    """Make a declared correlation, within people and pooled.

    Parameters
    ----------
    plan : CorrelationPlan
        What was declared.
    trials : DataFrame
        All trials; only valid ones count, of people who have both values in two conditions or more.
    alpha : float
        Intervals cover 1 - alpha.
    """
    across = values_of(trials, plan.conditions, trials[list(plan.x)].sum(axis=1, skipna=False))
    up = values_of(trials, plan.conditions, trials[plan.y])
    both = across.notna() & up.notna()
    kept = both.sum(axis=1) >= 2
    across, up, both = across.where(both), up.where(both), both[kept]
    exclusions = exclusions_of(trials, plan.conditions, up, up[kept])
    x, y = across[kept].to_numpy()[both.to_numpy()], up[kept].to_numpy()[both.to_numpy()]
    people = np.repeat(both.index.to_numpy(), both.sum(axis=1))
    distinct = len(np.unique(x))
    if not len(x):
        return CorrelationResult(
            plan=plan,
            exclusions=exclusions,
            distinct_x=distinct,
            not_computed_because="nobody has values in two conditions or more",
        )
    try:
        within = correlation.repeated_measures(people.tolist(), x, y, confidence=1.0 - alpha)
        pooled = correlation.pearson(x, y, confidence=1.0 - alpha)
    except ValueError as problem:
        return CorrelationResult(
            plan=plan, exclusions=exclusions, distinct_x=distinct, not_computed_because=str(problem)
        )
    return CorrelationResult(
        plan=plan, exclusions=exclusions, distinct_x=distinct, repeated_measures=within, pooled=pooled
    )
