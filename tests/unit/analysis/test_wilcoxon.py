from __future__ import annotations

import numpy as np
import pytest

from studykit.analysis.wilcoxon import rank_biserial_interval, wilcoxon


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


def test_pratts_exact_p_keeps_the_ranks_that_zeros_take() -> None:
    # Differences 0, 1, 2, 3: Pratt's ranks of the last three are 2, 3 and 4.
    result = wilcoxon([0.0, 1.0, 2.0, 3.0], np.zeros(4), zeros="pratt")
    assert result.w_plus == 9.0
    assert result.p == 0.25


def test_pairs_without_an_answer_are_refused() -> None:
    with pytest.raises(ValueError, match="finite"):
        wilcoxon([], [])
    with pytest.raises(ValueError, match="finite"):
        wilcoxon([1.0, np.nan], [1.0, 2.0])


def test_the_interval_of_the_rank_biserial() -> None:
    interval = rank_biserial_interval(0.5, 20)
    assert interval is not None
    # tanh(artanh(0.5) -+ 1.959964 sqrt(20 x 21 x 41 / 6) / 210)
    assert interval == pytest.approx((0.0493, 0.7815), abs=5e-5)
    assert rank_biserial_interval(1.0, 20) is None
    assert rank_biserial_interval(0.0, 0) is None
