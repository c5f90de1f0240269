"""The mixed model against lme4, lmerTest, emmeans and clubSandwich (mixed_model.R)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from studykit.analysis import cluster_robust
from studykit.analysis import mixed_model as own
from studykit.analysis.crossover import order_effects
from studykit.analysis.mixed_model import MixedModel, mixed_model
from studykit.analysis.random_intercept import Coefficient, Columns, Term
from studykit.core.errors import InputError

GOLDEN: dict[str, Any] = json.loads(Path(__file__).with_name("mixed_model.json").read_text())
STUDIES = ("missing_cells", "singular", "three_levels")


def fitted(name: str) -> tuple[MixedModel, dict[str, Any]]:
    """Fit the study of that name by ours, and give R's beside it."""
    expected = GOLDEN[name]
    return mixed_model(pd.DataFrame(expected["data"]), "value", factors=expected["factors"]), expected


def matches(model: MixedModel, expected: dict[str, Any], *, way: str, close: float) -> None:
    """Check all that lme4 says, and how sure the other packages are of it, to a relative distance."""
    # R puts interactions last, ours beside their factors: both are the same set of numbers.
    order = sorted(range(len(expected["names"])), key=lambda place: ":" in expected["names"][place])
    assert order == list(range(len(order)))
    mains = [ours for ours in model.coefficients if ":" not in ours.name]
    crossed = [ours for ours in model.coefficients if ":" in ours.name]
    sure = expected[way]
    for ours, estimate, error, freedom, p in zip(
        (*mains, *crossed),
        expected["estimate"],
        *(sure[key] for key in ("standard_error", "df", "p")),
        strict=True,
    ):
        assert ours.estimate == pytest.approx(estimate, abs=1e-6)
        assert ours.standard_error == pytest.approx(error, rel=1e-6)
        assert ours.degrees_of_freedom == pytest.approx(freedom, rel=close)
        assert ours.p == pytest.approx(p, abs=1e-6)
    assert {term.name for term in model.terms} == set(sure["f"])
    for term in model.terms:
        is_the_term_of(sure, term, close=close)
    assert model.between_sd == pytest.approx(expected["between_sd"], abs=1e-6)
    assert model.within_sd == pytest.approx(expected["within_sd"], abs=1e-6)
    assert model.is_singular == expected["is_singular"]


def is_the_term_of(sure: dict[str, Any], term: Term | None, *, close: float) -> None:
    assert term is not None
    assert term.f == pytest.approx(sure["f"][term.name], rel=1e-6)
    assert term.numerator_df == sure["numerator_df"][term.name]
    assert term.denominator_df == pytest.approx(sure["denominator_df"][term.name], rel=close)
    assert term.p == pytest.approx(sure["f_p"][term.name], abs=1e-5)


def is_the_row_of(table: dict[str, Any], row: int, ours: Coefficient) -> None:
    assert ours.estimate == pytest.approx(table["Est"][row], abs=1e-6)
    assert ours.standard_error == pytest.approx(table["SE"][row], rel=1e-6)
    assert ours.degrees_of_freedom == pytest.approx(table["df"][row], rel=1e-6)
    assert ours.interval == pytest.approx((table["CI_L"][row], table["CI_U"][row]), abs=1e-5)
    assert ours.p == pytest.approx(table["p_val"][row], abs=1e-6)


@pytest.mark.parametrize("name", STUDIES)
def test_estimates_are_those_of_lmer_and_their_uncertainty_that_of_club_sandwich(name: str) -> None:
    matches(*fitted(name), way="robust", close=1e-6)


@pytest.mark.parametrize("name", STUDIES)
def test_differences_of_levels_are_those_of_emmeans_by_club_sandwich(name: str) -> None:
    model, expected = fitted(name)
    differences = iter(model.differences)
    for factor in expected["factors"]:
        pairs = expected["robust"]["pairs"][factor]
        for row, contrast in enumerate(pairs["contrast"]):
            difference = next(differences)
            assert difference.name == f"{factor}: {contrast}"
            is_the_row_of(pairs, row, difference)
    assert next(differences, None) is None


def test_the_order_is_judged_by_club_sandwich_and_the_sequence_between_people_by_lmer() -> None:
    expected = GOLDEN["with_sequence"]
    trials = pd.DataFrame(GOLDEN["missing_cells"]["data"])
    effects = order_effects(trials, "value", factors=expected["factors"])
    is_the_term_of(expected["robust"], effects.period, close=1e-6)
    is_the_term_of(expected["robust"], effects.carry_over, close=1e-6)
    is_the_term_of(expected["alike"], effects.sequence, close=1e-4)
    # The robust test of eight sequences of two or three people has no degrees of freedom.
    assert expected["robust"]["denominator_df"]["sequence"] < 0.0
    periods = expected["robust"]["periods"]
    for row, mean in enumerate(effects.period_means):
        assert mean.name == f"period: {periods['period'][row]}"
        is_the_row_of(periods, row, mean)
    assert len(effects.period_means) == 8


@pytest.mark.parametrize("name", STUDIES)
def test_as_if_people_responded_alike_all_is_as_lmer_test_says(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(own, "ClusterRobust", lambda fit: fit)
    # With several directions the approximation depends a little on which contrasts span the term; lmerTest's
    # type III takes its own.
    matches(*fitted(name), way="alike", close=1e-3)


@pytest.mark.parametrize("name", STUDIES)
def test_that_all_people_respond_alike_would_be_noticed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # Wrong on purpose: the model's own standard errors.
    monkeypatch.setattr(own, "ClusterRobust", lambda fit: fit)
    with pytest.raises(AssertionError):
        matches(*fitted(name), way="robust", close=1e-6)


def test_residuals_that_are_not_adjusted_would_be_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    # Wrong on purpose: CR0, which forgets that the estimates follow the residuals.
    monkeypatch.setattr(cluster_robust, "_adjustment", lambda left, covariance: np.linalg.inv(covariance))
    with pytest.raises(InputError, match="to tell how uncertain"):  # for it is biased under the working model
        fitted("missing_cells")


def test_contrasts_against_a_reference_would_be_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    # Wrong on purpose: treatment coding, under which a factor's F is that at one level of the others.
    def treatment(values: pd.Series, term: str) -> Columns:
        levels = sorted(level for level in values.unique() if level)
        ones = np.stack([(values == level).to_numpy(dtype=float) for level in levels[:-1]])
        return Columns(term=term, names=tuple(f"{term}[{level}]" for level in levels[:-1]), values=ones.T)

    monkeypatch.setattr(own, "categories", treatment)
    with pytest.raises(AssertionError):
        matches(*fitted("missing_cells"), way="robust", close=1e-6)
