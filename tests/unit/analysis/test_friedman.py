from __future__ import annotations

from itertools import permutations, product

import numpy as np
import pytest

from studykit.analysis import friedman as module
from studykit.analysis.friedman import friedman, kendalls_w_interval, monte_carlo_p


def chance(seed: int = 1) -> np.random.Generator:
    return np.random.default_rng(seed)


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
        friedman(table, rng=chance())
    with pytest.raises(ValueError, match=problem):
        kendalls_w_interval(table, rng=chance())


@pytest.mark.parametrize(
    ("people", "conditions", "sums", "published"),
    [
        # Friedman 1937, in every book of tables: the p of chi-squared 6.0, 6.5, 6.4 and 8.2.
        (3, 3, (3, 6, 9), 0.028),
        (4, 3, (5, 7, 12), 0.042),
        (5, 3, (6, 10, 14), 0.039),
        (3, 4, (4, 5, 9, 12), 0.017),
    ],
)
def test_the_exact_p_is_that_of_the_published_tables(
    people: int, conditions: int, sums: tuple[int, ...], published: float
) -> None:
    orders = permutations(range(1, conditions + 1))
    table = next(table for table in product(orders, repeat=people) if tuple(np.sum(table, axis=0)) == sums)
    result = friedman(table, rng=chance())
    assert (round(result.permutation_p, 3), result.permutation_p_interval) == (published, None)
    assert "exact" in result.permutation_method


def test_where_orders_are_too_many_they_are_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    table = chance(4).normal(size=(9, 4)) + np.arange(4.0) / 3.0
    exact = friedman(table, rng=chance())
    module._distribution.cache_clear()
    monkeypatch.setattr(module, "_FEASIBLE", 1000)
    monkeypatch.setattr(module, "_CHUNK", 10_000)
    drawn = friedman(table, rng=chance())
    assert drawn.permutation_method == "9999 random permutations"
    assert drawn.permutation_p_interval is not None
    low, high = drawn.permutation_p_interval
    assert low < exact.permutation_p < high
    assert low < drawn.permutation_p < high
    assert high - low < 0.02
    assert drawn == friedman(table, rng=chance())
    assert drawn.chi_squared == exact.chi_squared
    module._distribution.cache_clear()


@pytest.mark.parametrize(
    ("people", "conditions"),
    [
        (20, 4),
        (150, 3),
        pytest.param(30, 4, marks=pytest.mark.slow),
        pytest.param(10, 5, marks=pytest.mark.slow),
    ],
)
def test_what_is_said_to_be_feasible_is(people: int, conditions: int) -> None:
    ranks = tuple(range(1 - conditions, conditions, 2))
    assert module._distribution(((ranks, people),)) is not None
    assert module._distribution(((ranks, 3 * people),)) is None


def test_eight_conditions_of_twenty_people_are_drawn() -> None:
    result = friedman(chance(3).normal(size=(20, 8)), rng=chance(), draws=499)
    assert result.permutation_method == "499 random permutations"
    assert result.permutation_p * 500 == pytest.approx(round(result.permutation_p * 500))


def test_a_drawn_p_is_never_zero_and_its_interval_is_clopper_and_pearsons() -> None:
    p, (low, high) = monte_carlo_p(0, 999)
    assert (p, low) == (0.001, 0.0)
    assert high == pytest.approx(1.0 - 0.025 ** (1.0 / 999.0))
    assert monte_carlo_p(999, 999)[0] == 1.0


def test_the_interval_of_w_holds_w_and_repeats() -> None:
    table = chance().normal(size=(20, 4)) + np.arange(4.0)
    low, high = kendalls_w_interval(table, rng=chance(2))
    assert 0.0 <= low < friedman(table, rng=chance()).kendalls_w < high <= 1.0
    assert (low, high) == kendalls_w_interval(table, rng=chance(2))
    narrow = kendalls_w_interval(table, rng=chance(2), confidence=0.5)
    assert low < narrow[0] < narrow[1] < high
    assert kendalls_w_interval(np.tile(np.arange(3), (5, 1)), rng=chance()) == (1.0, 1.0)


@pytest.mark.slow
@pytest.mark.parametrize("conditions", [4, 8])
@pytest.mark.parametrize("effect", [0.0, 0.2, 0.5])
def test_the_interval_of_w_holds_the_w_expected_of_as_many_people(conditions: int, effect: float) -> None:
    rng = chance(7)
    steps = effect * np.arange(conditions)

    def studies(count: int) -> np.ndarray:
        return rng.normal(size=(count, 20, conditions)) + steps

    expected = np.mean([friedman(table, rng=rng, draws=1).kendalls_w for table in studies(4000)])
    intervals = np.array([kendalls_w_interval(table, rng=rng, resamples=1000) for table in studies(500)])
    assert np.mean((intervals[:, 0] <= expected) & (expected <= intervals[:, 1])) >= 0.89
