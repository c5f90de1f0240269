"""What comes out of the declared tests, and how it is written down."""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

from studykit.analysis.aligned_ranks import FactorialEffect
from studykit.analysis.correlation import Correlation
from studykit.analysis.crossover import OrderEffects
from studykit.analysis.curves import CurveComparison
from studykit.analysis.equivalence import Equivalence
from studykit.analysis.friedman import Friedman
from studykit.analysis.mixed_model import MixedModel, Term
from studykit.analysis.skillings_mack import SkillingsMack
from studykit.analysis.wilcoxon import Shift, Wilcoxon
from studykit.protocol.analysis_plan import (
    CorrelationPlan,
    CurvePlan,
    EquivalencePlan,
    ModelPlan,
    TestPlan,
)
from studykit.protocol.part import Part


@dataclass(frozen=True, kw_only=True, slots=True)
class Exclusions:
    """What a test did not use, and why.

    Parameters
    ----------
    trials : int
        Trials of the conditions compared.
    used : int
        Trials that entered the test.
    not_valid : dict of str to int
        Trials that are not valid, counted by reason.
    without_value : int
        Valid trials for which nothing was measured.
    participants_left_out : dict of str to list of str
        People not used, each with the conditions of which they have no value.
    """

    trials: int
    used: int
    not_valid: dict[str, int]
    without_value: int
    participants_left_out: dict[str, list[str]]


@dataclass(frozen=True, kw_only=True, slots=True)
class ConditionSummary:
    """One condition's values over people: mean, standard deviation, median and quartiles."""

    condition: str
    mean: float
    standard_deviation: float
    median: float
    lower_quartile: float
    upper_quartile: float
    mean_rank: float


@dataclass(frozen=True, kw_only=True, slots=True)
class PairResult:
    """Two conditions compared.

    Parameters
    ----------
    a, b : str
        The conditions; differences are a - b.
    median_difference : float
        In the outcome's unit.
    shift : Shift
        By how much a exceeds b (Hodges-Lehmann), with its interval.
    test : Wilcoxon
        Statistic, p, effect size and variant.
    p_corrected : float
        Corrected for the pairs of this test.
    is_significant : bool
        Whether `p_corrected` lies below alpha.
    rank_biserial_interval : tuple of float or None
        Plausible values of the effect size; None if nobody differs.
    bayes_factor_10 : float or None
        How many times likelier the data are with a difference than with none; None if all differ alike.
    p_by_variant : dict of str to float
        Uncorrected p of the other ways to make the test.
    """

    a: str
    b: str
    median_difference: float
    shift: Shift
    test: Wilcoxon
    p_corrected: float
    is_significant: bool
    rank_biserial_interval: tuple[float, float] | None
    bayes_factor_10: float | None
    p_by_variant: dict[str, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class TestResult:
    """One declared test.

    Parameters
    ----------
    plan : TestPlan
    exclusions : Exclusions
    participants : int
        People compared.
    friedman : Friedman or None
        None if not computed.
    p : float or None
        Friedman's p of the kind declared.
    is_significant : bool or None
        Whether it lies below alpha.
    kendalls_w_interval : tuple of float or None
        Plausible values of W (bootstrap over people).
    skillings_mack : SkillingsMack or None
        The test that keeps people who lack a condition, where declared.
    skillings_mack_not_computed_because : str or None
        Why it could not be made, if so.
    summaries : tuple of ConditionSummary
    pairs : tuple of PairResult
    not_computed_because : str or None
        Why there are no numbers, if there are none.
    """

    __test__ = False  # not a test for pytest

    plan: TestPlan
    exclusions: Exclusions
    participants: int
    friedman: Friedman | None = None
    p: float | None = None
    is_significant: bool | None = None
    kendalls_w_interval: tuple[float, float] | None = None
    skillings_mack: SkillingsMack | None = None
    skillings_mack_not_computed_because: str | None = None
    summaries: tuple[ConditionSummary, ...] = ()
    pairs: tuple[PairResult, ...] = ()
    not_computed_because: str | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class CorrelationResult:
    """One declared correlation, with the pooled one always beside it.

    Parameters
    ----------
    plan : CorrelationPlan
    exclusions : Exclusions
    distinct_x : int
        Different values of x; few of them say little about the shape of a relation.
    repeated_measures, pooled : Correlation or None
        None if not computed.
    not_computed_because : str or None
        Why, if so.
    """

    plan: CorrelationPlan
    exclusions: Exclusions
    distinct_x: int
    repeated_measures: Correlation | None = None
    pooled: Correlation | None = None
    not_computed_because: str | None = None

    @property
    def declared(self) -> Correlation | None:
        """The correlation that the plan names."""
        return self.pooled if self.plan.method == "pearson" else self.repeated_measures


@dataclass(frozen=True, kw_only=True, slots=True)
class ModelResult:
    """One declared model.

    Parameters
    ----------
    plan : ModelPlan
    mixed_model : MixedModel or None
        None if another method was declared, or not computed.
    effects : tuple of FactorialEffect
        Of aligned ranks; empty if another method was declared, or not computed.
    not_computed_because : str or None
        Why there are no numbers, if there are none.
    """

    plan: ModelPlan
    mixed_model: MixedModel | None = None
    effects: tuple[FactorialEffect, ...] = ()
    not_computed_because: str | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class EquivalenceResult:
    """One pair that was declared to be the same but for what does not matter.

    Parameters
    ----------
    plan : EquivalencePlan
    exclusions : Exclusions
    found : Equivalence or None
        None if not computed.
    not_computed_because : str or None
        Why, if so.
    """

    plan: EquivalencePlan
    exclusions: Exclusions
    found: Equivalence | None = None
    not_computed_because: str | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class CurveResult:
    """One declared comparison over time.

    Parameters
    ----------
    plan : CurvePlan
    found : CurveComparison or None
        None if not computed.
    not_computed_because : str or None
        Why, if so.
    """

    plan: CurvePlan
    found: CurveComparison | None = None
    not_computed_because: str | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class OrderResult:
    """Whether the order of the conditions mattered for one outcome.

    Parameters
    ----------
    outcome : str
        A column of trials.csv.
    effects : OrderEffects or None
        None if not computed.
    not_computed_because : str or None
        Why, if so.
    """

    outcome: str
    effects: OrderEffects | None = None
    not_computed_because: str | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Results:
    """Everything that the analysis plan asked for.

    Parameters
    ----------
    alpha : float
        A corrected p below this is called significant; intervals cover 1 - alpha.
    participants, trials, valid_trials : int
        What the table held.
    is_simulated : bool
        Whether any trial was simulated.
    tests : tuple of TestResult
    correlations : tuple of CorrelationResult
    models : tuple of ModelResult
    equivalences : tuple of EquivalenceResult
    curves : tuple of CurveResult
    order_effects : tuple of OrderResult
        One for every outcome that is tested or modelled.
    """

    alpha: float
    participants: int
    trials: int
    valid_trials: int
    is_simulated: bool
    tests: tuple[TestResult, ...]
    correlations: tuple[CorrelationResult, ...]
    models: tuple[ModelResult, ...] = ()
    equivalences: tuple[EquivalenceResult, ...] = ()
    curves: tuple[CurveResult, ...] = ()
    order_effects: tuple[OrderResult, ...] = ()

    def test(self, name: str) -> TestResult:
        """Give a test by the name that the plan gives it."""
        return {result.plan.name: result for result in self.tests}[name]

    def correlation(self, name: str) -> CorrelationResult:
        """Give a correlation by the name that the plan gives it."""
        return {result.plan.name: result for result in self.correlations}[name]

    def __str__(self) -> str:
        """Give every result in a line, pairs below their test, as a person reads it."""
        return "\n".join(
            [line for test in self.tests for line in _test_lines(test)]
            + [line for correlation in self.correlations for line in _correlation_lines(correlation)]
            + [line for model in self.models for line in _model_lines(model)]
            + [_equivalence_line(pair) for pair in self.equivalences]
            + [_curve_line(comparison) for comparison in self.curves]
            + [line for order in self.order_effects for line in _order_lines(order)]
        )

    def to_dict(self) -> dict[str, Any]:
        """Give everything as plain values, ready for JSON: the same, byte for byte, for the same trials.

        The fields of a plan stand beside its results, and those of a pair's test beside the pair's own.
        """
        return dict(plain(self))


def p_text(p: float) -> str:
    """Write a p value as journals do.

    Examples
    --------
    >>> p_text(0.0312), p_text(1e-9)
    ('p = .031', 'p < .001')
    """
    return "p < .001" if p < 0.001 else f"p = {p:.3f}".replace("0.", ".", 1)


def _test_lines(result: TestResult) -> list[str]:
    head = f"{result.plan.name} ({result.plan.outcome})"
    friedman = result.friedman
    if friedman is None:
        return [f"{head}: not computed because {result.not_computed_because}"]
    test = (
        f"{head}: Friedman chi2({friedman.degrees_of_freedom}) = {friedman.chi_squared:.2f}, "
        f"{p_text(friedman.p)}, W = {friedman.kendalls_w:.2f}, n = {friedman.n}"
    )
    pairs = (
        f"    {pair.a} - {pair.b}: {pair.shift.estimate:+.3g} "
        f"[{pair.shift.interval[0]:+.3g}, {pair.shift.interval[1]:+.3g}], "
        f"{p_text(pair.p_corrected)} ({result.plan.correction}), r = {pair.test.rank_biserial:+.2f}"
        for pair in result.pairs
    )
    return [test, *pairs]


def _correlation_lines(result: CorrelationResult) -> list[str]:
    head = f"{result.plan.name} ({' + '.join(result.plan.x)} with {result.plan.y})"
    found = result.declared
    if found is None:
        return [f"{head}: not computed because {result.not_computed_because}"]
    return [f"{head}: {found.method}: r = {found.r:.2f}, {p_text(found.p)}, {found.n} trials"]


def _model_lines(result: ModelResult) -> list[str]:
    head = f"{result.plan.name} ({result.plan.outcome})"
    if result.not_computed_because:
        return [f"{head}: not computed because {result.not_computed_because}"]
    if result.mixed_model is None:
        lines = [f"{head}: aligned ranks, {result.effects[0].n} people"]
        return lines + [
            f"    {one.effect}: F({one.df[0]}, {one.df[1]}) = {one.f:.2f}, {p_text(one.p)}, "
            f"partial eta squared {one.partial_eta_squared:.2f}"
            for one in result.effects
        ]
    fit = result.mixed_model
    spread = f"between people {fit.between_sd:.3g}, within {fit.within_sd:.3g} (standard deviations)"
    lines = [f"{head}: mixed model, {fit.n} trials of {fit.participants} people, {spread}"]
    lines += [f"    {_term_text(term)}" for term in fit.terms]
    return lines


def _equivalence_line(result: EquivalenceResult) -> str:
    plan, found = result.plan, result.found
    head = f"{plan.name} ({plan.outcome}, {plan.a} - {plan.b} within {plan.low:g} to {plan.high:g})"
    if found is None:
        return f"{head}: not computed because {result.not_computed_because}"
    by_t, by_ranks = found.by_t, found.by_ranks
    return f"{head}: {p_text(by_t.p)} by t, {p_text(by_ranks.p)} by ranks, n = {found.n}"


def _curve_line(result: CurveResult) -> str:
    head = f"{result.plan.name} ({result.plan.curve} over time)"
    if result.found is None:
        return f"{head}: not computed because {result.not_computed_because}"
    stretches = ", ".join(
        f"{one.start_s:g} to {one.stop_s:g} s ({p_text(one.p)})" for one in result.found.clusters
    )
    return f"{head}: {stretches or 'no stretch differs'}, n = {result.found.n}"


def _order_lines(result: OrderResult) -> list[str]:
    head = f"order of conditions ({result.outcome})"
    if result.effects is None:
        return [f"{head}: not computed because {result.not_computed_because}"]
    effects = result.effects
    found = [_term_text(one) for one in (effects.period, effects.sequence, effects.carry_over) if one]
    return [f"{head}: {'; '.join(found)}"]


def _term_text(term: Term) -> str:
    numerator, denominator = term.numerator_df, term.denominator_df
    return f"{term.name}: F({numerator:g}, {denominator:.1f}) = {term.f:.2f}, {p_text(term.p)}"


def plain(value: Any) -> Any:
    """Turn results into dictionaries, lists, numbers and words, ready for JSON."""
    if isinstance(value, Part):
        return value.model_dump(mode="json")
    if is_dataclass(value) and not isinstance(value, type):
        entries = {field.name: plain(getattr(value, field.name)) for field in fields(value)}
        # What was planned, or the test of a pair, stands beside what came out, without a level of its own.
        return entries.pop("plan", {}) | entries.pop("test", {}) | entries
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, dict):
        return {key: plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    return value
