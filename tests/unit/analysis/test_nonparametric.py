from __future__ import annotations

import numpy as np
import pytest

from studykit.analysis.nonparametric import (
    benjamini_hochberg,
    friedman,
    holm,
    kendalls_w_interval,
    rank_biserial_interval,
    wilcoxon,
)


def test_people_without_a_difference_have_no_effect() -> None:
    result = wilcoxon([3.0, 4.0], [3.0, 4.0])
    assert (result.n, result.n_nonzero, result.w_plus, result.w_minus) == (2, 0, 0.0, 0.0)
    assert (result.z, result.p, result.rank_biserial) == (0.0, 1.0, 0.0)


def test_every_variant_is_named() -> None:
    a, b = [5.0, 6.0, 9.0], [4.0, 6.0, 5.0]
    names = {
        wilcoxon(a, b, p=p, zeros=zeros).variant
        for p in ("exact", "normal", "normal_continuity")
        for zeros in ("drop", "pratt")
    }
    assert len(names) == 6
    assert "chi-squared" in friedman([[1, 2, 3], [1, 3, 2]]).variant


def test_pratts_exact_p_keeps_the_ranks_that_zeros_take() -> None:
    # Differences 0, 1, 2, 3: Pratt's ranks of the last three are 2, 3 and 4.
    result = wilcoxon([0.0, 1.0, 2.0, 3.0], np.zeros(4), zeros="pratt")
    assert result.w_plus == 9.0
    assert result.p == 0.25


@pytest.mark.parametrize(
    ("table", "problem"),
    [
        ([[1, 2, 3]], "2 or more people"),
        ([[1, 2], [2, 1]], "3 or more conditions"),
        ([[1, 2, np.nan], [1, 2, 3]], "finite"),
        ([[2, 2, 2], [3, 3, 3]], "same value"),
    ],
)
def test_tables_without_an_answer_are_refused(table: list[list[float]], problem: str) -> None:
    with pytest.raises(ValueError, match=problem):
        friedman(table)


def test_pairs_without_an_answer_are_refused() -> None:
    with pytest.raises(ValueError, match="finite"):
        wilcoxon([], [])
    with pytest.raises(ValueError, match="finite"):
        wilcoxon([1.0, np.nan], [1.0, 2.0])


def test_the_interval_of_w_holds_w_and_repeats() -> None:
    table = np.random.default_rng(1).normal(size=(20, 4)) + np.arange(4.0)
    low, high = kendalls_w_interval(table, rng=np.random.default_rng(2))
    assert 0.0 <= low < friedman(table).kendalls_w < high <= 1.0
    assert (low, high) == kendalls_w_interval(table, rng=np.random.default_rng(2))
    narrow = kendalls_w_interval(table, rng=np.random.default_rng(2), confidence=0.5)
    assert low < narrow[0] < narrow[1] < high


def test_the_interval_of_the_rank_biserial() -> None:
    interval = rank_biserial_interval(0.5, 20)
    assert interval is not None
    # tanh(artanh(0.5) -+ 1.959964 sqrt(20 x 21 x 41 / 6) / 210)
    assert interval == pytest.approx((0.0493, 0.7815), abs=5e-5)
    assert rank_biserial_interval(1.0, 20) is None
    assert rank_biserial_interval(0.0, 0) is None


def test_correcting_nothing_gives_nothing() -> None:
    assert holm([]).tolist() == benjamini_hochberg([]).tolist() == []
