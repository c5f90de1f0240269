from __future__ import annotations

import numpy as np
import pytest

from studykit.analysis.friedman import friedman, kendalls_w_interval


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


def test_the_interval_of_w_holds_w_and_repeats() -> None:
    table = np.random.default_rng(1).normal(size=(20, 4)) + np.arange(4.0)
    low, high = kendalls_w_interval(table, rng=np.random.default_rng(2))
    assert 0.0 <= low < friedman(table).kendalls_w < high <= 1.0
    assert (low, high) == kendalls_w_interval(table, rng=np.random.default_rng(2))
    narrow = kendalls_w_interval(table, rng=np.random.default_rng(2), confidence=0.5)
    assert low < narrow[0] < narrow[1] < high
