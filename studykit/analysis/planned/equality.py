"""A declared pair that should not differ by more than what matters."""

from __future__ import annotations

from typing import TYPE_CHECKING

from studykit.analysis.equivalence import equivalence
from studykit.analysis.planned.values import exclusions_of, values_of, why_not_compared
from studykit.analysis.results import EquivalenceResult
from studykit.core.errors import InputError
from studykit.protocol.analysis_plan import EquivalencePlan

if TYPE_CHECKING:
    import pandas as pd


def equal(plan: EquivalencePlan, trials: pd.DataFrame, alpha: float) -> EquivalenceResult:
    """Test whether a declared pair differs by less than what matters.

    Parameters
    ----------
    plan : EquivalencePlan
        What was declared.
    trials : DataFrame
        All trials; only valid ones count, of people who have both conditions.
    alpha : float
        Level of significance.
    """
    values = values_of(trials, plan.conditions, trials[plan.outcome])
    complete = values.dropna()
    exclusions = exclusions_of(trials, plan.conditions, values, complete)
    problem = why_not_compared(values, complete.to_numpy())
    if problem is None:
        a, b = complete[plan.a].to_numpy(), complete[plan.b].to_numpy()
        try:
            found = equivalence(a, b, low=plan.low, high=plan.high, confidence=1.0 - alpha)
            return EquivalenceResult(plan=plan, exclusions=exclusions, found=found)
        except InputError as refused:
            problem = refused.problem
    return EquivalenceResult(plan=plan, exclusions=exclusions, not_computed_because=problem)
