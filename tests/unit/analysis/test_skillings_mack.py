from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chi2

from studykit.analysis.friedman import friedman
from studykit.analysis.skillings_mack import skillings_mack

NAN = np.nan


def chance(seed: int = 1) -> np.random.Generator:
    return np.random.default_rng(seed)


@pytest.mark.parametrize(
    ("table", "problem"),
    [
        ([[1, 2], [2, 1]], "3 or more conditions"),
        ([[1, 2, 3], [NAN, NAN, 1]], "2 or more people"),
        ([[1, 2, NAN], [2, 1, NAN], [NAN, NAN, 3]], "column 2 has no value"),
        ([[1, 2, np.inf], [2, 1, 3]], "infinite"),
        ([[2, 2, NAN], [3, NAN, 3]], "same value"),
    ],
)
def test_tables_without_an_answer_are_refused(table: list[list[float]], problem: str) -> None:
    with pytest.raises(ValueError, match=problem):
        skillings_mack(table, rng=chance())


def test_people_with_one_value_are_left_out() -> None:
    table = [[1.0, 3.0, 2.0], [1.0, 2.0, NAN], [NAN, 2.0, 3.0], [2.0, 1.0, 5.0]]
    result = skillings_mack(table, rng=chance())
    assert (result.n, result.cells_missing) == (4, 2)
    assert skillings_mack([*table, [NAN, 9.0, NAN]], rng=chance()) == result


def test_conditions_that_nobody_links_cost_a_degree_of_freedom() -> None:
    left, right = [[1.0, 2.0, NAN, NAN]] * 3, [[NAN, NAN, 1.0, 2.0]] * 2
    result = skillings_mack([*left, *right, [NAN, NAN, 2.0, 1.0]], rng=chance())
    # Two sign tests: 3 of 3 gives chi-squared 3, 2 of 3 gives 1 / 3.
    assert result.statistic == pytest.approx(3.0 + 1.0 / 3.0)
    assert result.degrees_of_freedom == 2
    assert result.p == pytest.approx(chi2.sf(3.0 + 1.0 / 3.0, 2))


def test_the_permutation_p_is_that_of_all_orders_where_nothing_is_missing() -> None:
    table = chance(5).integers(1, 5, (7, 4)).astype(float)
    result = skillings_mack(table, rng=chance(), draws=19_999)
    exact = friedman(table, rng=chance()).permutation_p
    assert result.permutation_p_interval[0] < exact < result.permutation_p_interval[1]
    assert result == skillings_mack(table, rng=chance(), draws=19_999)


@pytest.mark.slow
def test_both_p_are_level_where_nothing_differs() -> None:
    rng, found = chance(8), []
    for _ in range(1500):
        table = rng.normal(size=(20, 4)) + rng.normal(size=(20, 1))
        table[rng.random((20, 4)) < 0.15] = NAN
        result = skillings_mack(table, rng=rng, draws=199)
        found.append((result.p, result.permutation_p))
    assert np.all(np.mean(np.array(found) <= 0.05, axis=0) <= 0.065)
    assert np.all(np.mean(np.array(found) <= 0.05, axis=0) >= 0.03)
