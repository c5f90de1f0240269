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
)
"""The columns of trials.csv that hold a measured number and can therefore be tested."""

Correction = Literal["holm", "bonferroni", "none"]


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
    correction: Correction = Field(description='for testing several pairs: "holm", "bonferroni" or "none"')

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


class AnalysisPlan(Part):
    """The tests that were declared before the study; nothing else is called a result."""

    alpha: float = Field(gt=0.0, lt=1.0, description="a corrected p below this counts as significant")
    tests: tuple[TestPlan, ...] = Field(default=(), description="comparisons between conditions")
    correlations: tuple[CorrelationPlan, ...] = Field(default=(), description="correlations")

    @model_validator(mode="after")
    def _names_are_unique(self) -> Self:
        refuse_repeats((test.name for test in self.tests), what="name", where="tests")
        refuse_repeats((plan.name for plan in self.correlations), what="name", where="correlations")
        return self
