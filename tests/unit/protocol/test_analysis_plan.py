from __future__ import annotations

from typing import Any

import pytest
from pydantic import ValidationError

from studykit.protocol.analysis_plan import OUTCOMES, AnalysisPlan, CorrelationPlan, TestPlan

FOUR = ("light-easy-on", "light-hard-on", "intense-easy-on", "intense-hard-on")


def plan(**changes: Any) -> TestPlan:
    fields = {
        "name": "movement",
        "outcome": "dtw_m",
        "test": "friedman",
        "conditions": FOUR,
        "post_hoc": "wilcoxon",
        "pairs": "all",
        "correction": "holm",
    }
    return TestPlan.model_validate(fields | changes)


def correlation(**changes: Any) -> CorrelationPlan:
    fields = {
        "name": "energy",
        "x": ("linear_energy_asked", "rotational_energy_asked"),
        "y": "heart_rate_mean_bpm",
        "conditions": FOUR,
        "method": "repeated_measures",
    }
    return CorrelationPlan.model_validate(fields | changes)


def test_all_pairs_of_four_conditions_are_six() -> None:
    pairs = plan().pairs_list()
    assert len(pairs) == 6
    assert pairs[0] == ("light-easy-on", "light-hard-on")
    assert plan(pairs=[FOUR[:2]]).pairs_list() == (FOUR[:2],)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"outcome": "dtw"}, '"dtw" is no measured column'),
        ({"outcome": "participant"}, "is no measured column"),
        ({"pairs": [("light-easy-on", "light-easy-off")]}, "which this test does not compare"),
        ({"pairs": [("light-easy-on", "light-easy-on")]}, "paired with itself"),
        ({"pairs": [FOUR[:2], FOUR[1::-1]]}, "stands twice"),
        ({"conditions": (*FOUR, FOUR[0])}, "stands twice"),
        ({"conditions": FOUR[:2]}, "at least 3"),
    ],
)
def test_an_inconsistent_test_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        plan(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"x": ("energy",)}, "is no measured column"),
        ({"x": ("dtw_m", "dtw_m")}, "stands twice"),
        ({"y": "heart_rate"}, "is no measured column"),
        ({"conditions": (FOUR[0], FOUR[0])}, "stands twice"),
    ],
)
def test_an_inconsistent_correlation_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        correlation(**changes)


def test_two_tests_cannot_share_a_name() -> None:
    assert AnalysisPlan(alpha=0.05, tests=(plan(), plan(name="other"))).tests[1].name == "other"
    with pytest.raises(ValidationError, match="stands twice"):
        AnalysisPlan(alpha=0.05, tests=(plan(), plan()))
    with pytest.raises(ValidationError, match="stands twice"):
        AnalysisPlan(alpha=0.05, correlations=(correlation(), correlation()))


def test_every_outcome_can_be_tested() -> None:
    assert [plan(outcome=outcome).outcome for outcome in OUTCOMES] == list(OUTCOMES)
