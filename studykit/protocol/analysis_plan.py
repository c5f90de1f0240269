"""Which tests the study makes, written down before anybody dances."""

from __future__ import annotations

from itertools import combinations
from typing import ClassVar, Literal, Self

from pydantic import Field, field_validator, model_validator

from studykit.core.errors import InputError, nearest
from studykit.protocol.part import Part, refuse_repeats

OUTCOMES: tuple[str, ...] = (
    "heart_rate_mean_bpm",
    "heart_rate_peak_bpm",
    "vigorous_fraction",
    "dtw_m",
    "dtw_lag_s",
    "linear_energy_asked",
    "rotational_energy_asked",
    "linear_energy_danced",
    "rotational_energy_danced",
    "variety_achieved",
    "smoothness_rating",
    "heart_rate_recovery_bpm",
    "vigorous_fraction_reserve",
    "dtw_arms_m",
    "dtw_legs_m",
    "dtw_trunk_m",
    "dtw_lag_sd_s",
    "smoothness_ldlj",
    "range_of_motion_rad",
)
"""The columns of trials.csv that hold a measured number and can therefore be tested."""

Correction = Literal["holm", "closed", "bonferroni", "none"]
Factor = Literal["intensity", "variety", "transition"]
Curve = Literal["heart_rate", "distance", "energy"]
"""What can be followed over the time of a dance."""

MOST_CLOSED = 6
"""Conditions that closed testing can compare: the ways to group more are too many."""


def _refuse_unknown_outcome(name: str) -> str:
    if name not in OUTCOMES:
        raise InputError(f'"{name}" is no measured column of trials.csv', remedy=nearest(name, OUTCOMES))
    return name


class TestPlan(Part):
    """One test that compares an outcome between conditions, with the pairs compared afterwards."""

    __test__: ClassVar[bool] = False  # not a test for pytest

    name: str = Field(min_length=1, description="what the results call this test")
    outcome: str = Field(description="the column of trials.csv that is compared")
    test: Literal["friedman"] = Field(
        description="do the conditions differ at all? (repeated measures, by ranks)"
    )
    conditions: tuple[str, ...] = Field(min_length=3, description="the conditions compared")
    post_hoc: Literal["wilcoxon"] = Field(description="the test of each pair (signed ranks)")
    pairs: Literal["all"] | tuple[tuple[str, str], ...] = Field(
        description='which pairs: "all", or a list such as [["light-easy-on", "light-easy-off"]]'
    )
    correction: Correction = Field(
        description='for testing several pairs: "holm", "closed" (all pairs of up to 6 conditions), '
        '"bonferroni" or "none"'
    )
    p_from: Literal["chi_squared", "f", "permutation"] | None = Field(
        default=None, description='where p is from: "chi_squared" unless given, "f", or "permutation"'
    )
    zeros: Literal["drop", "pratt", "split"] | None = Field(
        default=None, description='pairs without a difference: "drop" unless given, "pratt" or "split"'
    )
    missing: Literal["skillings_mack"] | None = Field(
        default=None,
        description="people who lack a condition are left out; name the test that keeps them beside it",
    )

    _outcome_is_a_column = field_validator("outcome")(_refuse_unknown_outcome)

    @model_validator(mode="after")
    def _pairs_are_of_these_conditions(self) -> Self:
        refuse_repeats(self.conditions, what="condition", where="conditions")
        for first, second in self.pairs_list():
            for name in (first, second):
                if name not in self.conditions:
                    raise InputError(
                        f'the pair ["{first}", "{second}"] names "{name}", which this test does not compare',
                        where="pairs",
                        remedy=nearest(name, self.conditions),
                    )
            if first == second:
                raise InputError(
                    f'"{first}" is paired with itself', where="pairs", remedy="name two different conditions"
                )
        refuse_repeats((" and ".join(sorted(pair)) for pair in self.pairs_list()), what="pair", where="pairs")
        if self.correction == "closed" and (self.pairs != "all" or len(self.conditions) > MOST_CLOSED):
            raise InputError(
                f"closed testing is for all pairs of up to {MOST_CLOSED} conditions",
                where="correction",
                remedy='write "holm"',
            )
        return self

    def pairs_list(self) -> tuple[tuple[str, str], ...]:
        """Give the pairs of conditions that are compared, in order."""
        return tuple(combinations(self.conditions, 2)) if self.pairs == "all" else self.pairs


class CorrelationPlan(Part):
    """One correlation between what the dances ask for and what people do."""

    name: str = Field(min_length=1, description="what the results call this correlation")
    x: tuple[str, ...] = Field(min_length=1, description="columns of trials.csv; several are summed")
    y: str = Field(description="a column of trials.csv")
    conditions: tuple[str, ...] = Field(min_length=2, description="the conditions taken in")
    method: Literal["repeated_measures", "pearson"] = Field(
        description='"repeated_measures" looks within each person; "pearson" pools all trials'
    )

    _y_is_a_column = field_validator("y")(_refuse_unknown_outcome)

    @field_validator("x")
    @classmethod
    def _x_are_columns(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        refuse_repeats(names, what="column")
        return tuple(_refuse_unknown_outcome(name) for name in names)

    @field_validator("conditions")
    @classmethod
    def _no_repeats(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        refuse_repeats(names, what="condition")
        return names


class ModelPlan(Part):
    """One model of an outcome by the study's factors, with the effects of order."""

    name: str = Field(min_length=1, description="what the results call this model")
    outcome: str = Field(description="the column of trials.csv that is explained")
    method: Literal["mixed_model", "aligned_ranks"] = Field(
        description='"mixed_model" (with period and carry-over), or "aligned_ranks" for ratings'
    )
    factors: tuple[Factor, ...] = Field(min_length=1, description="the factors, with all their interactions")

    _outcome_is_a_column = field_validator("outcome")(_refuse_unknown_outcome)

    @field_validator("factors")
    @classmethod
    def _no_repeats(cls, names: tuple[Factor, ...]) -> tuple[Factor, ...]:
        refuse_repeats(names, what="factor")
        return names


class EquivalencePlan(Part):
    """One pair of conditions that should be the same, but for a difference too small to matter."""

    name: str = Field(min_length=1, description="what the results call this test")
    outcome: str = Field(description="the column of trials.csv that is compared")
    a: str = Field(description="a condition; differences are a - b")
    b: str = Field(description="the condition it is compared with")
    low: float = Field(description="the lowest difference that does not matter, in the outcome's unit")
    high: float = Field(description="the highest difference that does not matter")

    _outcome_is_a_column = field_validator("outcome")(_refuse_unknown_outcome)

    @model_validator(mode="after")
    def _bounds_are_in_order(self) -> Self:
        if self.low >= self.high:
            raise InputError(
                f"low ({self.low:g}) is not below high ({self.high:g})",
                where="high",
                remedy="give high the larger number",
            )
        if self.a == self.b:
            raise InputError(
                f'"{self.a}" is compared with itself', where="b", remedy="name two different conditions"
            )
        return self

    @property
    def conditions(self) -> tuple[str, str]:
        """The two conditions."""
        return self.a, self.b


class CurvePlan(Part):
    """One comparison of conditions at every moment of the dance."""

    name: str = Field(min_length=1, description="what the results call this comparison")
    curve: Curve = Field(
        description="what is followed over time: heart rate, distance to the guide, or energy danced"
    )
    conditions: tuple[str, ...] = Field(min_length=2, description="the conditions compared")

    @field_validator("conditions")
    @classmethod
    def _no_repeats(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        refuse_repeats(names, what="condition")
        return names


class AnalysisPlan(Part):
    """The tests that were declared before the study; nothing else is called a result."""

    alpha: float = Field(gt=0.0, lt=1.0, description="a corrected p below this counts as significant")
    tests: tuple[TestPlan, ...] = Field(default=(), description="comparisons between conditions")
    correlations: tuple[CorrelationPlan, ...] = Field(default=(), description="correlations")
    models: tuple[ModelPlan, ...] | None = Field(default=None, description="models by factors")
    equivalences: tuple[EquivalencePlan, ...] | None = Field(
        default=None, description="pairs that should not differ"
    )
    curves: tuple[CurvePlan, ...] | None = Field(default=None, description="comparisons over time")

    @model_validator(mode="after")
    def _names_are_unique(self) -> Self:
        for kind in ("tests", "correlations", "models", "equivalences", "curves"):
            refuse_repeats((plan.name for plan in getattr(self, kind) or ()), what="name", where=kind)
        return self

    @property
    def outcomes(self) -> tuple[str, ...]:
        """The columns that the declared comparisons need, each once."""
        named = [plan.outcome for plan in self.tests]
        named += [plan.outcome for plan in self.models or ()]
        named += [plan.outcome for plan in self.equivalences or ()]
        for plan in self.correlations:
            named += [*plan.x, plan.y]
        return tuple(dict.fromkeys(named))
