"""What must hold of mixed models and of order effects whatever the data."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from studykit.analysis import random_intercept
from studykit.analysis.crossover import order_effects
from studykit.analysis.mixed_model import MixedModel, mixed_model
from studykit.core.errors import InputError
from studykit.protocol.latin_square import williams

LABELS = [f"{a}-{b}-{c}" for a in ("light", "intense") for b in ("easy", "hard") for c in ("off", "on")]
FACTORS = ["intensity", "variety", "transition"]


def study(
    rng: np.random.Generator, *, people: int, labels: list[str], between: float = 3.0, within: float = 1.0
) -> pd.DataFrame:
    """People who danced all conditions in the orders of a Williams square."""
    square = williams(len(labels))
    rows = []
    for person in range(people):
        row = person % len(square)
        order = [labels[place] for place in square[row]]
        level = rng.normal(0.0, between)
        for period, (before, label) in enumerate(pairwise(["", *order]), start=1):
            rows.append(
                {
                    "participant": f"{person:02d}",
                    "sequence": row + 1,
                    "period": period,
                    "condition": label,
                    "previous_condition": before,
                    "value": level + rng.normal(0.0, within),
                }
            )
    return pd.DataFrame(rows)


def term(model: MixedModel, name: str) -> random_intercept.Term:
    return next(found for found in model.terms if found.name == name)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**32 - 1), st.integers(3, 9))
def test_with_complete_data_it_is_the_classical_repeated_measures_test(seed: int, people: int) -> None:
    rng = np.random.default_rng(seed)
    trials = study(rng, people=people, labels=["a", "b"])
    model = mixed_model(trials, "value", factors=["condition"], with_period=False, with_carry_over=False)
    table = trials.pivot(index="participant", columns="condition", values="value")
    expected = stats.ttest_rel(table["a"], table["b"])
    found = term(model, "condition")
    assert found.f == pytest.approx(expected.statistic**2, rel=1e-6)
    assert found.denominator_df == pytest.approx(people - 1, rel=1e-6)
    assert found.p == pytest.approx(expected.pvalue, rel=1e-5, abs=1e-12)
    (difference,) = model.differences
    assert difference.name == "condition: a - b"
    is_paired(difference, table["a"] - table["b"])


def is_paired(found: random_intercept.Coefficient, differences: pd.Series) -> None:
    """Check that it is the paired t test of these differences."""
    expected = stats.ttest_1samp(differences, 0.0)
    assert found.estimate == pytest.approx(differences.mean())
    assert found.t == pytest.approx(expected.statistic, rel=1e-6)
    assert found.degrees_of_freedom == pytest.approx(len(differences) - 1, rel=1e-6)
    assert found.p == pytest.approx(expected.pvalue, rel=1e-5, abs=1e-12)
    assert found.interval == pytest.approx(tuple(expected.confidence_interval()), rel=1e-6, abs=1e-9)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**32 - 1), st.integers(3, 20), st.floats(0.0, 5.0))
def test_every_factor_is_the_paired_t_test_of_what_it_does_to_each_participant(
    seed: int, people: int, slope_sd: float
) -> None:
    rng = np.random.default_rng(seed)
    trials = study(rng, people=people, labels=LABELS)
    trials[FACTORS] = trials["condition"].str.split("-", expand=True)
    gain = rng.normal(3.0, slope_sd, people)[trials["participant"].astype(int)]
    trials["value"] += gain * (trials["intensity"] == "intense")
    model = mixed_model(trials, "value", factors=FACTORS, with_period=False, with_carry_over=False)
    for found in model.differences:
        factor, _, levels = found.name.partition(": ")
        a, b = levels.split(" - ")
        means = trials.pivot_table(index="participant", columns=factor, values="value")
        is_paired(found, means[a] - means[b])


@settings(deadline=None, max_examples=10)
@given(st.integers(0, 2**32 - 1), st.integers(6, 12))
def test_several_conditions_together_are_hotellings_t_squared(seed: int, people: int) -> None:
    # The classical test that the means of the participants' contrasts are zero, whatever their covariance.
    rng = np.random.default_rng(seed)
    trials = study(rng, people=people, labels=["a", "b", "c", "d"])
    model = mixed_model(trials, "value", factors=["condition"], with_period=False, with_carry_over=False)
    wide = trials.pivot(index="participant", columns="condition", values="value").to_numpy()
    contrasts = wide[:, 1:] - wide[:, :1]
    mean = contrasts.mean(axis=0)
    squared = people * mean @ np.linalg.solve(np.cov(contrasts.T), mean)
    found = term(model, "condition")
    assert found.f == pytest.approx((people - 3) / (3 * (people - 1)) * squared, rel=1e-6)
    assert (found.numerator_df, found.denominator_df) == (3, pytest.approx(people - 3, rel=1e-6))


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**32 - 1), st.floats(0.1, 50.0), st.floats(-100.0, 100.0))
def test_units_order_of_rows_and_level_do_not_change_the_tests(seed: int, scale: float, shift: float) -> None:
    rng = np.random.default_rng(seed)
    trials = study(rng, people=9, labels=["a", "b", "c", "d"])
    trials = trials.drop(index=rng.choice(len(trials), 4, replace=False))
    first = mixed_model(trials, "value", factors=["condition"])
    other = trials.assign(value=scale * trials["value"] + shift).sample(frac=1.0, random_state=seed)
    second = mixed_model(other, "value", factors=["condition"])
    for a, b in zip(first.terms, second.terms, strict=True):
        assert (b.f, b.denominator_df) == pytest.approx((a.f, a.denominator_df), rel=1e-5)
    assert second.within_sd == pytest.approx(scale * first.within_sd, rel=1e-6)
    assert second.between_sd == pytest.approx(scale * first.between_sd, rel=1e-5, abs=1e-6)


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_the_likelihood_is_highest_where_the_fit_stands(seed: int) -> None:
    # The textbook's restricted likelihood with the covariance written out.
    rng = np.random.default_rng(seed)
    people = np.repeat(np.arange(6), [2, 5, 3, 4, 1, 6])
    design = np.column_stack((np.ones(21), rng.normal(size=(21, 2))))
    values = rng.normal(size=21) + rng.normal(size=6)[people]
    fit = random_intercept.RandomIntercept(design, values, people)

    def deviance(within: float, between: float) -> float:
        covariance = within * np.eye(21) + between * (people[:, None] == people)
        inverse = np.linalg.inv(covariance)
        precision = design.T @ inverse @ design
        residual = values - design @ np.linalg.solve(precision, design.T @ inverse @ values)
        logs = np.linalg.slogdet(covariance)[1] + np.linalg.slogdet(precision)[1]
        return float(logs + residual @ inverse @ residual)

    best = deviance(fit.within, fit.between)
    for within in (0.99, 1.0, 1.01):
        for between in (0.9, 0.99, 1.01, 1.1):
            assert deviance(within * fit.within, between * fit.between + 1e-3 * fit.is_singular) >= best


def test_people_who_do_not_differ_are_said_in_words() -> None:
    trials = study(np.random.default_rng(1), people=8, labels=["a", "b", "c", "d"], between=0.0)
    # Take every person's mean off: less than no difference between people.
    levels = trials.groupby("participant")["value"].transform("mean")
    model = mixed_model(trials.assign(value=trials["value"] - levels), "value", factors=["condition"])
    assert model.is_singular
    assert model.between_sd == 0.0
    assert any("estimated as zero" in note for note in model.notes)


def test_where_the_likelihood_is_flat_at_zero_people_do_not_differ() -> None:
    # Two people, two trials each: between people's means exactly as much as within them.
    people = np.array([0, 0, 1, 1])
    fit = random_intercept.RandomIntercept(np.ones((4, 1)), np.array([2.0, 0.0, 0.0, 0.0]), people)
    assert fit.is_singular
    assert fit.within == pytest.approx(1.0)


def test_what_cannot_be_told_apart_is_said_and_left_out() -> None:
    # Everybody danced a, b, c in this order: period is condition.
    trials = study(np.random.default_rng(2), people=6, labels=["a", "b", "c"])
    trials = trials[trials["sequence"] == 1]
    rng = np.random.default_rng(3)
    everybody = pd.concat(
        [trials.assign(participant=str(n), value=rng.normal(size=3) + rng.normal()) for n in range(7)]
    )
    model = mixed_model(everybody, "value", factors=["condition"])
    assert [found.name for found in model.terms] == ["condition"]
    assert "period cannot be told from the terms before it and is left out; they include it" in model.notes
    assert any(note.startswith("carry-over cannot be told") for note in model.notes)


def test_with_two_conditions_carry_over_cannot_be_told_from_sequence() -> None:
    trials = study(np.random.default_rng(4), people=10, labels=["a", "b"])
    effects = order_effects(trials, "value")
    assert effects.carry_over is None
    assert effects.sequence is not None
    assert effects.sequence.denominator_df == pytest.approx(8.0)
    assert "; sequence lies between participants" in effects.model.variant
    assert effects.period is not None
    assert any(note.startswith("carry-over cannot be told") for note in effects.model.notes)


def test_a_sequence_for_everybody_cannot_be_tested() -> None:
    trials = study(np.random.default_rng(5), people=4, labels=["a", "b", "c", "d"])
    effects = order_effects(trials, "value")
    assert effects.sequence is None
    assert effects.carry_over is not None
    assert any(note.startswith("sequence is left out") for note in effects.model.notes)


def test_sequence_is_tested_between_people() -> None:
    # With complete data and nothing else in the way it is the one-way test of the people's means.
    trials = study(np.random.default_rng(6), people=12, labels=["a", "b"])
    effects = order_effects(trials, "value")
    means = trials.groupby(["sequence", "participant"])["value"].mean()
    expected = stats.f_oneway(*(group.to_numpy() for _, group in means.groupby("sequence")))
    assert effects.sequence is not None
    assert effects.sequence.f == pytest.approx(expected.statistic, rel=1e-6)
    assert effects.sequence.p == pytest.approx(expected.pvalue, rel=1e-5)
    # Wrong on purpose: trials as if they were people give many more degrees of freedom.
    pooled = stats.f_oneway(*(group.to_numpy() for _, group in trials.groupby("sequence")["value"]))
    assert effects.sequence.p != pytest.approx(pooled.pvalue, rel=1e-2)


def test_planted_order_effects_are_found_and_their_size_estimated() -> None:
    trials = study(np.random.default_rng(7), people=16, labels=["a", "b", "c", "d"])
    shifted = trials["value"] + 3.0 * (trials["period"] == 1) + 3.0 * (trials["previous_condition"] == "b")
    effects = order_effects(trials.assign(value=shifted), "value")
    assert effects.period is not None
    assert effects.carry_over is not None
    assert effects.period.p < 0.01
    assert effects.carry_over.p < 1e-4
    first, *others = effects.period_means
    assert [mean.name for mean in effects.period_means] == [f"period: {number}" for number in range(1, 5)]
    # Periods are compared at the mean carry-over, which adds 3 / 4 to all but the first.
    assert first.estimate - np.mean([mean.estimate for mean in others]) == pytest.approx(2.25, abs=1.0)
    carried = {found.name: found.estimate for found in effects.model.coefficients}
    assert carried["carry-over[b]"] == pytest.approx(3.0 * 3 / 4, abs=1.0)


def test_conditions_left_out_and_factors_of_one_level_are_no_obstacle() -> None:
    trials = study(np.random.default_rng(8), people=12, labels=["a", "b", "c", "d"])
    trials["place"] = "studio"
    trials.loc[trials.index[:2], "value"] = np.nan
    model = mixed_model(trials[trials["condition"].isin(["a", "b"])], "value", factors=["condition", "place"])
    assert model.notes[-1] == "place has one level only and is left out"
    assert [found.name for found in model.terms] == ["condition", "period", "carry-over"]
    assert model.n == 24 - sum(trials["condition"][:2].isin(["a", "b"]))
    alone = mixed_model(trials, "value", factors=["place"], with_carry_over=False)
    assert alone.formula == "value ~ 1 + period + (1 | participant)"
    without = mixed_model(trials, "value", factors=["condition"], with_period=False)
    assert [found.name for found in without.terms] == ["condition", "no condition before", "carry-over"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"participant": "01"}, "differences between people cannot be told"),
        ({"value": np.nan}, "no trial has a value"),
        ({"value": 7.0}, "the model leaves nothing unexplained"),
    ],
)
def test_data_that_cannot_be_modelled_are_refused_in_words(change: dict[str, object], words: str) -> None:
    trials = study(np.random.default_rng(9), people=6, labels=["a", "b", "c", "d"])
    with pytest.raises(InputError, match=words):
        mixed_model(trials.assign(**change), "value", factors=["condition"])


def test_what_too_few_participants_cannot_tell_is_left_out_in_words() -> None:
    # Three people, eight conditions and eight periods: each of them decides some part of it alone.
    trials = study(np.random.default_rng(12), people=3, labels=LABELS)
    with pytest.raises(InputError, match="participants are too few, or too much alike"):
        mixed_model(trials, "value", factors=["condition"], with_carry_over=False)
    # Five people can tell two conditions apart, but not test seven contrasts at once.
    trials = study(np.random.default_rng(12), people=5, labels=LABELS)
    trials["intensity"] = trials["condition"].str.partition("-")[0]
    model = mixed_model(trials, "value", factors=["intensity"], with_carry_over=False)
    assert [found.name for found in model.terms] == ["intensity"]
    assert len(model.differences) == 1
    assert model.notes[-1].endswith("left out: period")


def test_people_who_all_respond_exactly_alike_leave_no_test() -> None:
    trials = study(np.random.default_rng(13), people=6, labels=["a", "b", "c"])
    by_person = trials.groupby("participant")["value"].transform("first")
    apart = np.where(
        trials["condition"] == "c", trials["value"], by_person + 2.0 * (trials["condition"] == "b")
    )
    model = mixed_model(
        trials.assign(value=apart), "value", factors=["condition"], with_period=False, with_carry_over=False
    )
    assert [one.name for one in model.differences] == ["condition: a - c", "condition: b - c"]
    assert not model.terms
    assert model.notes[-1].endswith("left out: condition, condition: a - b")


def test_more_terms_than_trials_are_refused_in_words() -> None:
    trials = study(np.random.default_rng(9), people=2, labels=[*"abcdefgh"])
    with pytest.raises(InputError, match="the model has as many terms as there are trials, 16"):
        mixed_model(trials, "value", factors=["condition"])


@pytest.mark.slow
def test_intervals_cover_and_tests_err_as_often_as_they_say() -> None:
    # 1,000 studies of 20 with planted effects of the conditions alone: 95 % and 5 %, three standard errors.
    rng = np.random.default_rng(10)
    planted = dict(zip(LABELS, (0.0, 1.0, 0.5, 1.5, 3.0, 4.0, 3.5, 4.5), strict=True))
    covered, errors = [], []
    for _ in range(1000):
        trials = study(rng, people=20, labels=LABELS)
        trials[FACTORS] = trials["condition"].str.split("-", expand=True)
        trials["value"] += trials["condition"].map(planted)
        found = order_effects(trials, "value", factors=FACTORS)
        effects = {
            "intensity: intense - light": 3.0,
            "variety: easy - hard": -0.5,
            "transition: off - on": -1.0,
        }
        covered.append(
            [
                low <= effects[one.name] <= high
                for one in found.model.differences
                for low, high in [one.interval]
            ]
        )
        errors.append([term(found.model, name).p < 0.05 for name in ("period", "sequence", "carry-over")])
    assert np.mean(covered, axis=0) == pytest.approx(0.95, abs=0.021)
    assert np.mean(errors, axis=0) == pytest.approx(0.05, abs=0.021)


def test_a_column_that_is_not_there_is_named() -> None:
    trials = study(np.random.default_rng(9), people=6, labels=["a", "b"])
    with pytest.raises(InputError, match='there is no column "valu"'):
        mixed_model(trials, "valu", factors=["condition"])
