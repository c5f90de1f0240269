"""What must hold of aligned ranks whatever the data."""

from __future__ import annotations

from itertools import product

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from studykit.analysis import aligned_ranks as own
from studykit.analysis.aligned_ranks import align, aligned_ranks, contrasts_of_aligned_ranks
from studykit.core.errors import InputError

FACTORS = ("intensity", "variety", "transition")


def trials(values: np.ndarray) -> pd.DataFrame:
    """Name the cells of an array (participant, level of factor 1, ...)."""
    rows = [
        {"participant": f"{place[0]:02d}", "value": values[place]}
        | {factor: f"level {level}" for factor, level in zip(FACTORS, place[1:], strict=False)}
        for place in product(*map(range, values.shape))
    ]
    return pd.DataFrame(rows)


shapes = st.tuples(st.integers(4, 7), st.integers(2, 3), st.integers(2, 3), st.integers(2, 3))


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**32 - 1), shapes)
def test_aligned_values_sum_to_zero_and_hold_their_own_effect_only(seed: int, shape: tuple[int, ...]) -> None:
    values = np.random.default_rng(seed).normal(size=shape) * 10.0 + 100.0
    means = values.mean(axis=0)
    together = np.zeros_like(means)
    for effect in own._effects(3):
        aligned = align(values, effect)
        assert aligned.sum() == pytest.approx(0.0, abs=1e-8)
        left = aligned.mean(axis=0)
        assert left.sum(axis=effect[0]) == pytest.approx(0.0, abs=1e-9)
        for axis in set(range(3)) - set(effect):
            assert np.ptp(left, axis=axis) == pytest.approx(0.0, abs=1e-9)
        together += left
    assert together == pytest.approx(means - means.mean(), abs=1e-9)


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**32 - 1), shapes)
def test_one_effect_does_not_change_the_test_of_another(seed: int, shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(seed)
    values = rng.normal(size=shape)
    first = aligned_ranks(trials(values), "value", FACTORS)
    # A main effect and an interaction of the other two factors, far larger than anything else.
    shifted = (
        values + 50.0 * rng.normal(size=(1, 1, shape[2], 1)) + 50.0 * rng.normal(size=(1, 1, *shape[2:]))
    )
    second = aligned_ranks(trials(shifted), "value", FACTORS)
    for a, b in zip(first, second, strict=True):
        if a.effect.startswith("intensity"):
            assert (b.f, b.p) == pytest.approx((a.f, a.p), rel=1e-6, abs=1e-12)


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**32 - 1), shapes)
def test_each_effect_is_tested_against_its_own_error(seed: int, shape: tuple[int, ...]) -> None:
    people, *levels = shape
    effects = aligned_ranks(trials(np.random.default_rng(seed).normal(size=shape)), "value", FACTORS)
    freedom = dict(zip(FACTORS, (count - 1 for count in levels), strict=True))
    for effect in effects:
        width = int(np.prod([freedom[name] for name in effect.effect.split(":")]))
        assert effect.df == (width, width * (people - 1))
        assert 0.0 <= effect.p <= 1.0
        assert 0.0 <= effect.partial_eta_squared <= 1.0
        assert 1.0 / width - 1e-9 <= effect.epsilon <= 1.0 + 1e-9
        eta = effect.f * effect.df[0] / (effect.f * effect.df[0] + effect.df[1])
        assert effect.partial_eta_squared == pytest.approx(eta)


def test_with_one_factor_of_two_levels_it_is_the_paired_t_of_the_ranks() -> None:
    values = np.random.default_rng(3).normal(size=(9, 2))
    (effect,) = aligned_ranks(trials(values), "value", FACTORS[:1])
    ranks = stats.rankdata(values).reshape(values.shape)
    expected = stats.ttest_rel(ranks[:, 0], ranks[:, 1])
    assert (effect.f, effect.p) == pytest.approx((expected.statistic**2, expected.pvalue))
    (contrast,) = contrasts_of_aligned_ranks(trials(values), "value", FACTORS[:1], of=FACTORS[:1])
    assert (contrast.t, contrast.p) == pytest.approx((expected.statistic, expected.pvalue))


def test_the_contrast_of_a_factor_of_two_levels_is_its_effect() -> None:
    table = trials(np.random.default_rng(4).normal(size=(8, 2, 2, 2)))
    effect = aligned_ranks(table, "value", FACTORS)[1]
    (contrast,) = contrasts_of_aligned_ranks(table, "value", FACTORS, of=["variety"])
    assert contrast.t**2 == pytest.approx(effect.f)
    assert contrast.p == pytest.approx(effect.p)


def test_people_with_a_missing_combination_are_left_out_and_named() -> None:
    table = trials(np.random.default_rng(5).normal(size=(6, 2, 2)))
    complete = table[table["participant"] != "03"]
    table.loc[(table["participant"] == "03") & (table["variety"] == "level 1"), "value"] = np.nan
    found = aligned_ranks(table, "value", FACTORS[:2])
    assert [effect.left_out for effect in found] == [("03",)] * 3
    assert found[0].n == 5
    assert found[0].f == aligned_ranks(complete, "value", FACTORS[:2])[0].f


def test_the_order_of_rows_does_not_matter() -> None:
    table = trials(np.random.default_rng(6).normal(size=(6, 2, 3)))
    shuffled = table.sample(frac=1.0, random_state=1)
    assert aligned_ranks(shuffled, "value", FACTORS[:2]) == aligned_ranks(table, "value", FACTORS[:2])


def test_values_that_still_hold_other_effects_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(own, "align", lambda values, effect: values - values.mean())
    with pytest.raises(ArithmeticError, match="still hold other effects"):
        aligned_ranks(trials(np.random.default_rng(7).normal(size=(6, 2, 2))), "value", FACTORS[:2])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"variety": "easy"}, "variety: variety has one level only"),
        ({"participant": "01"}, "a value in all 4 combinations of intensity, variety: 1;"),
        ({"value": 4.0}, "the values do not vary"),
    ],
)
def test_what_cannot_be_tested_is_refused_in_words(change: dict[str, object], words: str) -> None:
    table = trials(np.random.default_rng(8).normal(size=(4, 2, 2)))
    with pytest.raises(InputError, match=words):
        aligned_ranks(table.assign(**change), "value", FACTORS[:2])


def test_a_contrast_of_something_else_is_refused() -> None:
    table = trials(np.random.default_rng(8).normal(size=(4, 2, 2)))
    with pytest.raises(InputError, match='there is no factor "varieti"'):
        contrasts_of_aligned_ranks(table, "value", FACTORS[:2], of=["varieti"])
    with pytest.raises(InputError, match="no factor is compared"):
        contrasts_of_aligned_ranks(table, "value", FACTORS[:2], of=[])


def test_an_effect_that_is_the_same_in_everybody_has_no_f() -> None:
    table = trials(np.tile([[1.0, 2.0], [4.0, 8.0]], (5, 1, 1)))
    with pytest.raises(InputError, match="the effect is the same in everybody"):
        aligned_ranks(table, "value", FACTORS[:2])
    with pytest.raises(InputError, match="differ by the same in everybody"):
        contrasts_of_aligned_ranks(table, "value", FACTORS[:2], of=["variety"])


def test_large_main_effects_do_not_make_false_interactions() -> None:
    # 2,000 studies of 20 with skewed errors: the interaction's 5 % test errs in 4 to 6 %.
    rng = np.random.default_rng(9)
    mains = np.array([[0.0, 3.0], [2.0, 5.0]])[:, :, None] + np.array([0.0, 1.0])
    found = 0
    for _ in range(2000):
        values = mains + rng.normal(size=(20, 1, 1, 1)) + np.exp(rng.normal(size=(20, 2, 2, 2)))
        cells = own._Cells(values=values, factors=FACTORS, levels=(("0", "1"),) * 3, left_out=())
        found += own._tested(cells, (0, 1), own._contrasts(cells, (0, 1))).p < 0.05
    assert 0.04 <= found / 2000 <= 0.06
