"""A declared model: what each factor does, and whether the order mattered."""

from __future__ import annotations

from typing import TYPE_CHECKING

from studykit.analysis.aligned_ranks import aligned_ranks
from studykit.analysis.crossover import order_effects
from studykit.analysis.mixed_model import mixed_model
from studykit.analysis.results import ModelResult, OrderResult
from studykit.core.errors import InputError
from studykit.protocol.analysis_plan import ModelPlan

if TYPE_CHECKING:
    import pandas as pd


def model(plan: ModelPlan, valid: pd.DataFrame, alpha: float) -> ModelResult:
    """Fit a declared model to all valid trials.

    Parameters
    ----------
    plan : ModelPlan
        What was declared.
    valid : DataFrame
        Valid trials.
    alpha : float
        Intervals cover 1 - alpha.
    """
    try:
        if plan.method == "aligned_ranks":
            return ModelResult(plan=plan, effects=aligned_ranks(valid, plan.outcome, plan.factors))
        fit = mixed_model(valid, plan.outcome, factors=plan.factors, confidence=1.0 - alpha)
    except InputError as problem:
        return ModelResult(plan=plan, not_computed_because=problem.problem)
    return ModelResult(plan=plan, mixed_model=fit)


def order(outcome: str, valid: pd.DataFrame, alpha: float) -> OrderResult:
    """Test whether the order of the conditions mattered for an outcome.

    Parameters
    ----------
    outcome : str
        A column of trials.csv.
    valid : DataFrame
        Valid trials.
    alpha : float
        Intervals cover 1 - alpha.
    """
    try:
        return OrderResult(outcome=outcome, effects=order_effects(valid, outcome, confidence=1.0 - alpha))
    except InputError as problem:
        return OrderResult(outcome=outcome, not_computed_because=problem.problem)
