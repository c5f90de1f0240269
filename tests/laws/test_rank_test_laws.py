"""What must hold of the rank tests whatever the data."""

from __future__ import annotations

from itertools import combinations, permutations, product

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps
from scipy.stats import rankdata

from studykit.analysis.friedman import friedman, kendalls_w_interval
from studykit.analysis.multiplicity import bonferroni, closed_friedman, holm
from studykit.analysis.skillings_mack import skillings_mack
from studykit.analysis.wilcoxon import hodges_lehmann, wilcoxon

# Few different values, so that ties and zeros are common.
ratings = st.integers(1, 7).map(float)
tables = nps.arrays(np.float64, st.tuples(st.integers(2, 6), st.integers(3, 5)), elements=ratings)
small = nps.arrays(
    np.float64, st.sampled_from([(2, 3), (3, 3), (4, 3), (5, 3), (2, 4), (3, 4)]), elements=st.integers(1, 4)
)
pairs = nps.arrays(np.float64, st.tuples(st.just(2), st.integers(1, 10)), elements=ratings)
variants = st.sampled_from(
    [(p, z) for p in ("exact", "normal", "normal_continuity") for z in ("drop", "pratt", "split")]
)


@settings(deadline=None)
@given(tables)
def test_friedman_sees_ranks_only_and_not_who_comes_first(table: np.ndarray) -> None:
    assume(not np.all(table == table[:, :1]))
    result = friedman(table, rng=np.random.default_rng(1))
    order = np.random.default_rng(len(table)).permutation(len(table))
    other = friedman(np.exp(table[order]) - 3.0, rng=np.random.default_rng(1))
    assert other.chi_squared == pytest.approx(result.chi_squared, rel=1e-9)
    assert 0.0 <= result.kendalls_w <= 1.0
    assert 0.0 < result.permutation_p <= 1.0
    assert sum(result.mean_ranks) == pytest.approx(table.shape[1] * (table.shape[1] + 1) / 2)


@settings(deadline=None)
@given(st.integers(2, 6), st.integers(3, 5))
def test_people_who_agree_have_w_one(people: int, conditions: int) -> None:
    result = friedman(np.tile(np.arange(conditions), (people, 1)), rng=np.random.default_rng(1))
    assert (result.kendalls_w, result.f, result.f_p) == (1.0, None, None)


@settings(deadline=None)
@given(pairs, variants)
def test_exchanging_the_conditions_exchanges_the_sums(pair: np.ndarray, variant: tuple[str, str]) -> None:
    p, zeros = variant
    forth, back = wilcoxon(*pair, p=p, zeros=zeros), wilcoxon(*pair[::-1], p=p, zeros=zeros)
    assert (forth.w_plus, forth.w_minus) == (back.w_minus, back.w_plus)
    assert forth.p == pytest.approx(back.p, rel=1e-12)
    assert (forth.z, forth.rank_biserial) == (-back.z, -back.rank_biserial)
    assert 0.0 < forth.p <= 1.0


def share_of_signs(differences: np.ndarray, zeros: str, alternative: str) -> float:
    """Give the p of the signed-rank sum among all ways to set the signs, one by one."""
    kept = differences[differences != 0.0] if zeros == "drop" else differences
    ranks = np.where(kept != 0.0, rankdata(np.abs(kept)), 0.0)  # the signs of zeros do not matter
    found = ranks[kept > 0.0].sum()
    signs = np.array(list(product([0.0, 1.0], repeat=len(kept))))
    sums = signs @ ranks
    greater, less = np.mean(sums >= found), np.mean(sums <= found)
    return {"greater": greater, "less": less, "two-sided": min(1.0, 2.0 * min(greater, less))}[alternative]


@settings(max_examples=100, deadline=None)
@given(pairs, st.sampled_from(["drop", "pratt", "split"]), st.sampled_from(["two-sided", "greater", "less"]))
def test_the_exact_p_counts_every_way_to_set_the_signs(
    pair: np.ndarray, zeros: str, alternative: str
) -> None:
    differences = pair[0] - pair[1]
    assume(differences.any())
    expected = share_of_signs(differences, zeros, alternative)
    assert wilcoxon(*pair, zeros=zeros, alternative=alternative).p == pytest.approx(expected, abs=1e-10)


def test_the_exact_p_of_every_number_of_people_to_ten_counts_every_way_to_set_the_signs() -> None:
    rng = np.random.default_rng(3)
    for people in range(1, 11):
        differences = rng.integers(-3, 5, people).astype(float)
        differences[0] = 2.0
        for zeros, alternative in product(("drop", "pratt", "split"), ("two-sided", "greater", "less")):
            found = wilcoxon(differences, np.zeros(people), zeros=zeros, alternative=alternative).p
            assert found == pytest.approx(share_of_signs(differences, zeros, alternative), abs=1e-10)


def share_of_orders(table: np.ndarray, *, with_ties: bool = True) -> float:
    """Give the p of the rank sums among all ways to reorder each person's ranks, one by one."""
    ranks = rankdata(table, axis=1)
    people, conditions = ranks.shape
    found = np.sum((ranks.sum(axis=0) - people * (conditions + 1) / 2) ** 2)
    if not with_ties:  # wrong on purpose
        ranks = np.tile(np.arange(1.0, conditions + 1), (people, 1))
    sums = np.zeros((1, conditions))
    for person in ranks:
        sums = (sums[:, None] + np.array(list(permutations(person)))).reshape(-1, conditions)
    return float(np.mean(np.sum((sums - people * (conditions + 1) / 2) ** 2, axis=1) >= found - 1e-9))


@settings(max_examples=100, deadline=None)
@given(small)
def test_friedmans_exact_p_counts_every_way_to_order_the_ranks(table: np.ndarray) -> None:
    assume(not np.all(table == table[:, :1]))
    result = friedman(table, rng=np.random.default_rng(1))
    assert result.permutation_p_interval is None
    assert result.permutation_p == pytest.approx(share_of_orders(table), abs=1e-10)


def test_the_distribution_of_untied_ranks_is_wrong_for_tied_ones() -> None:
    table = np.array([[1, 1, 2, 3], [1, 2, 2, 2], [1, 1, 3, 3]])
    found = friedman(table, rng=np.random.default_rng(1)).permutation_p
    assert found == pytest.approx(share_of_orders(table), abs=1e-10)
    assert found != pytest.approx(share_of_orders(table, with_ties=False), abs=1e-3)


@settings(deadline=None)
@given(tables, st.integers(0, 99))
def test_the_interval_of_w_stays_between_none_and_all(table: np.ndarray, seed: int) -> None:
    assume(not np.all(table == table[:, :1]))
    low, high = kendalls_w_interval(table, rng=np.random.default_rng(seed), resamples=50)
    assert 0.0 <= low <= high <= 1.0


wild = st.floats(-1e300, 1e300)


@settings(deadline=None)
@given(nps.arrays(np.float64, st.tuples(st.integers(2, 5), st.integers(3, 5)), elements=wild))
def test_kendalls_w_lies_between_none_and_all_on_any_input(table: np.ndarray) -> None:
    if np.all(table == table[:, :1]):
        with pytest.raises(ValueError, match="same value"):
            friedman(table, rng=np.random.default_rng(1))
        return
    assert 0.0 <= friedman(table, rng=np.random.default_rng(1)).kendalls_w <= 1.0


@settings(deadline=None)
@given(nps.arrays(np.float64, st.integers(1, 12), elements=st.floats(-1e6, 1e6)), st.floats(0.5, 0.99))
def test_the_shift_moves_with_the_differences_and_turns_with_their_sign(
    differences: np.ndarray, confidence: float
) -> None:
    shift = hodges_lehmann(differences, confidence=confidence)
    low, high = shift.interval
    assert low <= shift.estimate <= high
    turned = hodges_lehmann(-differences, confidence=confidence)
    assert (turned.estimate, turned.interval) == (-shift.estimate, (-high, -low))
    moved = hodges_lehmann(differences + 7.0, confidence=confidence)
    assert (moved.estimate, *moved.interval) == pytest.approx(
        (shift.estimate + 7.0, low + 7.0, high + 7.0), abs=1e-8
    )
    assert shift.confidence >= confidence or shift.interval == (differences.min(), differences.max())


@settings(deadline=None)
@given(st.integers(6, 25), st.integers(0, 999))
def test_the_interval_of_the_shift_is_what_the_exact_test_does_not_refuse(people: int, seed: int) -> None:
    differences = np.random.default_rng(seed).normal(0.4, 1.0, people)
    shift = hodges_lehmann(differences)
    for limit, inside in zip(shift.interval, (1.0, -1.0), strict=True):
        kept = wilcoxon(differences, np.full(people, limit + inside * 1e-9)).p
        refused = wilcoxon(differences, np.full(people, limit - inside * 1e-9)).p
        assert refused <= 0.05 + 1e-12 < kept
        assert refused == pytest.approx(1.0 - shift.confidence, abs=1e-12)


@settings(deadline=None)
@given(st.lists(st.floats(1e-9, 1.0), min_size=1, max_size=12))
def test_holm_lies_between_no_correction_and_bonferronis(p: list[float]) -> None:
    corrected = holm(p)
    assert np.all(corrected >= np.array(p) - 1e-15)
    assert np.all(corrected <= bonferroni(p) + 1e-15)
    assert np.all(np.diff(corrected[np.argsort(p, kind="stable")]) >= -1e-15)


@settings(max_examples=50, deadline=None)
@given(tables)
def test_closed_testing_never_gives_less_than_the_pairs_own_p_or_friedmans(table: np.ndarray) -> None:
    assume(not np.all(table == table[:, :1]))
    pairs = list(combinations(range(table.shape[1]), 2))
    adjusted = closed_friedman(table, pairs)
    own = np.array([wilcoxon(table[:, a], table[:, b]).p for a, b in pairs])
    assert np.all(adjusted >= own)
    assert np.all(adjusted >= friedman(table, rng=np.random.default_rng(1)).p)
    assert np.all(adjusted <= 1.0)


@settings(max_examples=50, deadline=None)
@given(tables, st.integers(0, 99))
def test_closed_testing_does_not_mind_the_order_of_the_conditions(table: np.ndarray, seed: int) -> None:
    pairs = list(combinations(range(table.shape[1]), 2))
    order = np.random.default_rng(seed).permutation(table.shape[1])
    moved = closed_friedman(table[:, order], pairs)
    back = closed_friedman(table, [(int(order[a]), int(order[b])) for a, b in pairs])
    assert moved == pytest.approx(back, rel=1e-9)


@settings(deadline=None)
@given(tables)
def test_skillings_and_macks_test_is_friedmans_where_nothing_is_missing(table: np.ndarray) -> None:
    assume(not np.all(table == table[:, :1]))
    complete = friedman(table, rng=np.random.default_rng(1), draws=9)
    found = skillings_mack(table, rng=np.random.default_rng(1), draws=9)
    assert found.statistic == pytest.approx(complete.chi_squared, rel=1e-9, abs=1e-9)
    assert (found.degrees_of_freedom, found.cells_missing) == (complete.degrees_of_freedom, 0)
    assert found.p == pytest.approx(complete.p, rel=1e-9)


@settings(deadline=None)
@given(tables, st.integers(0, 99))
def test_skillings_and_macks_test_sees_ranks_only(table: np.ndarray, seed: int) -> None:
    rng = np.random.default_rng(seed)
    table = np.where(rng.random(table.shape) < 0.2, np.nan, table)
    enough = table[np.count_nonzero(~np.isnan(table), axis=1) >= 2]
    assume(len(enough) >= 2 and not np.isnan(enough).all(axis=0).any())
    assume(np.any(np.nanmax(enough, axis=1) > np.nanmin(enough, axis=1)))
    first = skillings_mack(table, rng=np.random.default_rng(1), draws=9)
    people, conditions = rng.permutation(len(table)), rng.permutation(table.shape[1])
    other = skillings_mack(np.exp(table)[people][:, conditions], rng=np.random.default_rng(1), draws=9)
    assert other.statistic == pytest.approx(first.statistic, rel=1e-8, abs=1e-9)
    assert (other.n, other.cells_missing) == (first.n, first.cells_missing)
