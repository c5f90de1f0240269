"""The mixed model against lme4, lmerTest and emmeans (mixed_model.R)."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from studykit.analysis import mixed_model as own
from studykit.analysis import random_intercept
from studykit.analysis.crossover import order_effects
from studykit.analysis.mixed_model import MixedModel, mixed_model
from studykit.analysis.random_intercept import Columns

GOLDEN: dict[str, Any] = json.loads(Path(__file__).with_name("mixed_model.json").read_text())
STUDIES = ("missing_cells", "singular", "three_levels")


def fitted(name: str) -> tuple[MixedModel, dict[str, Any]]:
    """Fit the study of that name by ours, and give R's beside it."""
    expected = GOLDEN[name]
    return mixed_model(pd.DataFrame(expected["data"]), "value", factors=expected["factors"]), expected


def matches(model: MixedModel, expected: dict[str, Any]) -> None:
    """Check all that lme4 and lmerTest say."""
    # R puts interactions last, ours beside their factors: both are the same set of numbers.
    order = sorted(range(len(expected["names"])), key=lambda place: ":" in expected["names"][place])
    assert order == list(range(len(order)))
    mains = [ours for ours in model.coefficients if ":" not in ours.name]
    crossed = [ours for ours in model.coefficients if ":" in ours.name]
    for ours, estimate, error, freedom, p in zip(
        (*mains, *crossed), *(expected[key] for key in ("estimate", "standard_error", "df", "p")), strict=True
    ):
        assert ours.estimate == pytest.approx(estimate, abs=1e-6)
        assert ours.standard_error == pytest.approx(error, rel=1e-6)
        assert ours.degrees_of_freedom == pytest.approx(freedom, abs=1e-3)
        assert ours.p == pytest.approx(p, abs=1e-6)
    assert {term.name for term in model.terms} == set(expected["f"])
    for term in model.terms:
        assert term.f == pytest.approx(expected["f"][term.name], rel=1e-6)
        assert term.numerator_df == expected["numerator_df"][term.name]
        # With several directions the approximation depends a little on which contrasts span the term;
        # lmerTest's type III takes its own.
        assert term.denominator_df == pytest.approx(expected["denominator_df"][term.name], abs=1e-2)
        assert term.p == pytest.approx(expected["f_p"][term.name], abs=1e-5)
    assert model.between_sd == pytest.approx(expected["between_sd"], abs=1e-6)
    assert model.within_sd == pytest.approx(expected["within_sd"], abs=1e-6)
    assert model.is_singular == expected["is_singular"]


@pytest.mark.parametrize("name", STUDIES)
def test_estimates_degrees_of_freedom_and_p_are_those_of_lmer(name: str) -> None:
    matches(*fitted(name))


def test_order_effects_are_those_of_lmer_with_the_sequence_between_people() -> None:
    expected = GOLDEN["with_sequence"]
    trials = pd.DataFrame(GOLDEN["missing_cells"]["data"])
    effects = order_effects(trials, "value", factors=expected["factors"])
    for name, term in (
        ("period", effects.period),
        ("sequence", effects.sequence),
        ("carry-over", effects.carry_over),
    ):
        assert term is not None
        assert term.f == pytest.approx(expected["f"][name], rel=1e-6)
        assert term.denominator_df == pytest.approx(expected["denominator_df"][name], abs=1e-3)
        assert term.p == pytest.approx(expected["f_p"][name], abs=1e-6)
    periods = expected["periods"]
    for mean, period, estimate, freedom, low, high in zip(
        effects.period_means,
        *(periods[key] for key in ("period", "emmean", "df", "lower.CL", "upper.CL")),
        strict=True,
    ):
        assert mean.name == f"period: {period}"
        assert mean.estimate == pytest.approx(estimate, abs=1e-6)
        assert mean.degrees_of_freedom == pytest.approx(freedom, abs=1e-3)
        assert mean.interval == pytest.approx((low, high), abs=1e-5)


@pytest.mark.parametrize("name", STUDIES)
def test_differences_of_levels_are_those_of_emmeans(name: str) -> None:
    model, expected = fitted(name)
    differences = iter(model.differences)
    for factor in expected["factors"]:
        pairs = expected["pairs"][factor]
        for row, contrast in enumerate(pairs["contrast"]):
            difference = next(differences)
            assert difference.name == f"{factor}: {contrast}"
            assert difference.estimate == pytest.approx(pairs["estimate"][row], abs=1e-6)
            assert difference.degrees_of_freedom == pytest.approx(pairs["df"][row], abs=1e-3)
            limits = (pairs["lower.CL"][row], pairs["upper.CL"][row])
            assert difference.interval == pytest.approx(limits, abs=1e-5)
            assert difference.p == pytest.approx(pairs["p.value"][row], abs=1e-6)
    assert next(differences, None) is None


def test_degrees_of_freedom_that_ignore_the_uncertain_variances_would_be_noticed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # Wrong on purpose: the containment rule's trials minus coefficients instead of Satterthwaite's.
    right = random_intercept.RandomIntercept.coefficient

    def residual(self: Any, name: str, direction: Any, *, confidence: float) -> Any:
        return replace(right(self, name, direction, confidence=confidence), degrees_of_freedom=21.0)

    monkeypatch.setattr(random_intercept.RandomIntercept, "coefficient", residual)
    with pytest.raises(AssertionError):
        matches(*fitted("three_levels"))


def test_contrasts_against_a_reference_would_be_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    # Wrong on purpose: treatment coding, under which a factor's F is that at one level of the others.
    def treatment(values: pd.Series, term: str) -> Columns:
        levels = sorted(level for level in values.unique() if level)
        ones = np.stack([(values == level).to_numpy(dtype=float) for level in levels[:-1]])
        return Columns(term=term, names=tuple(f"{term}[{level}]" for level in levels[:-1]), values=ones.T)

    monkeypatch.setattr(own, "categories", treatment)
    with pytest.raises(AssertionError):
        matches(*fitted("missing_cells"))
