"""What must hold of the rank tests whatever the data."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps
from scipy.stats import rankdata

from studykit.analysis.friedman import friedman
from studykit.analysis.multiplicity import bonferroni, holm
from studykit.analysis.wilcoxon import wilcoxon

# Few different values, so that ties and zeros are common.
ratings = st.integers(1, 7).map(float)
tables = nps.arrays(np.float64, st.tuples(st.integers(2, 8), st.integers(3, 6)), elements=ratings)
pairs = nps.arrays(np.float64, st.tuples(st.just(2), st.integers(1, 8)), elements=ratings)
variants = st.sampled_from(
    [(p, z) for p in ("exact", "normal", "normal_continuity") for z in ("drop", "pratt")]
)


@settings(deadline=None)
@given(tables)
def test_friedman_sees_ranks_only_and_not_who_comes_first(table: np.ndarray) -> None:
    assume(not np.all(table == table[:, :1]))
    result = friedman(table)
    order = np.random.default_rng(len(table)).permutation(len(table))
    other = friedman(np.exp(table[order]) - 3.0)
    assert other.chi_squared == pytest.approx(result.chi_squared, rel=1e-9)
    assert -1e-12 <= result.kendalls_w <= 1.0 + 1e-12
    assert sum(result.mean_ranks) == pytest.approx(table.shape[1] * (table.shape[1] + 1) / 2)


@settings(deadline=None)
@given(st.integers(2, 9), st.integers(3, 6))
def test_people_who_agree_have_w_one(people: int, conditions: int) -> None:
    assert friedman(np.tile(np.arange(conditions), (people, 1))).kendalls_w == pytest.approx(1.0)


@settings(deadline=None)
@given(pairs, variants)
def test_exchanging_the_conditions_exchanges_the_sums(pair: np.ndarray, variant: tuple[str, str]) -> None:
    p, zeros = variant
    forth, back = wilcoxon(*pair, p=p, zeros=zeros), wilcoxon(*pair[::-1], p=p, zeros=zeros)
    assert (forth.w_plus, forth.w_minus) == (back.w_minus, back.w_plus)
    assert forth.p == pytest.approx(back.p, rel=1e-12)
    assert (forth.z, forth.rank_biserial) == (-back.z, -back.rank_biserial)
    assert 0.0 < forth.p <= 1.0


@settings(max_examples=60, deadline=None)
@given(pairs, st.sampled_from(["two-sided", "greater", "less"]))
def test_the_exact_p_counts_every_way_to_set_the_signs(pair: np.ndarray, alternative: str) -> None:
    differences = pair[0] - pair[1]
    kept = differences[differences != 0.0]
    assume(len(kept))
    ranks = rankdata(np.abs(kept))
    found = ranks[kept > 0.0].sum()
    sums = np.array([ranks[np.array(signs)].sum() for signs in product([False, True], repeat=len(kept))])
    greater, less = np.mean(sums >= found), np.mean(sums <= found)
    expected = {"greater": greater, "less": less, "two-sided": min(1.0, 2.0 * min(greater, less))}[
        alternative
    ]
    assert wilcoxon(*pair, alternative=alternative).p == pytest.approx(expected, rel=1e-12)


@settings(deadline=None)
@given(st.lists(st.floats(1e-9, 1.0), min_size=1, max_size=12))
def test_holm_lies_between_no_correction_and_bonferronis(p: list[float]) -> None:
    corrected = holm(p)
    assert np.all(corrected >= np.array(p) - 1e-15)
    assert np.all(corrected <= bonferroni(p) + 1e-15)
    assert np.all(np.diff(corrected[np.argsort(p, kind="stable")]) >= -1e-15)
