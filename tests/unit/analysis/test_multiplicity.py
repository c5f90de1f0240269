from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from studykit.analysis.friedman import friedman
from studykit.analysis.multiplicity import bonferroni, closed_friedman, holm
from studykit.analysis.wilcoxon import wilcoxon


def test_correcting_nothing_gives_nothing() -> None:
    assert holm([]).tolist() == bonferroni([]).tolist() == []
    assert closed_friedman(np.eye(3), []).tolist() == []


@pytest.mark.parametrize(
    ("table", "pair", "problem"),
    [
        (np.eye(7), (0, 1), "6 conditions at most, not 7: use holm"),
        (np.eye(3), (0, 3), "not two of the 3"),
        (np.eye(3), (1, 1), "not two of the 3"),
        (np.full((3, 3), np.nan), (0, 1), "finite"),
        (np.ones((1, 3)), (0, 1), "2 or more people"),
    ],
)
def test_what_closed_testing_cannot_compare_is_refused(
    table: np.ndarray, pair: tuple[int, int], problem: str
) -> None:
    with pytest.raises(ValueError, match=problem):
        closed_friedman(table, [pair])


def test_three_conditions_need_friedmans_test_and_the_pairs_own() -> None:
    rng = np.random.default_rng(2)
    table = rng.normal(size=(12, 3)) + np.array([0.0, 0.4, 1.0])
    pairs = list(combinations(range(3), 2))
    omnibus = friedman(table, rng=rng).p
    expected = [max(omnibus, wilcoxon(table[:, a], table[:, b]).p) for a, b in pairs]
    assert closed_friedman(table, pairs).tolist() == expected


def test_four_conditions_by_hand() -> None:
    # The splits that keep 0 and 1 together: 01|2|3, 01|23, 012|3, 013|2 and 0123.
    rng = np.random.default_rng(3)
    table = rng.normal(size=(15, 4)) + np.array([0.0, 0.9, 0.2, 0.3])
    pair, other = (wilcoxon(table[:, a], table[:, b]).p for a, b in ((0, 1), (2, 3)))
    of_more = [friedman(table[:, kept], rng=rng).p for kept in ([0, 1, 2], [0, 1, 3], [0, 1, 2, 3])]
    expected = max(pair, 2.0 * min(pair, other), *of_more)
    assert closed_friedman(table, [(1, 0)]).tolist() == [pytest.approx(expected)]


def test_it_may_fall_below_holms_and_exceed_it() -> None:
    pairs = list(combinations(range(4), 2))
    rng = np.random.default_rng(1)
    apart = rng.normal(size=(20, 4)) + np.arange(4.0) / 2.0
    raw = [wilcoxon(apart[:, a], apart[:, b]).p for a, b in pairs]
    assert np.any(closed_friedman(apart, pairs) < holm(raw))
    one_apart = rng.normal(size=(20, 4)) + np.array([0.0, 0.0, 0.0, 0.7])
    raw = [wilcoxon(one_apart[:, a], one_apart[:, b]).p for a, b in pairs]
    assert np.any(closed_friedman(one_apart, pairs) > holm(raw))


@pytest.mark.slow
@pytest.mark.parametrize("means", [(0, 0, 0, 0), (0, 0, 1, 1), (0, 0, 0, 2), (0, 0, 1, 3)], ids=str)
def test_some_claim_is_wrong_in_at_most_5_of_100_studies(means: tuple[int, ...]) -> None:
    rng = np.random.default_rng(4)
    alike = [pair for pair in combinations(range(4), 2) if means[pair[0]] == means[pair[1]]]
    wrong, uncorrected = 0, 0
    for _ in range(2000):
        table = rng.normal(size=(20, 4)) + means
        wrong += bool(np.any(closed_friedman(table, alike) <= 0.05))
        uncorrected += any(wilcoxon(table[:, a], table[:, b]).p <= 0.05 for a, b in alike)
    assert wrong / 2000 <= 0.06
    if len(alike) > 1:
        assert uncorrected / 2000 > 0.07  # what no correction gives: the check can fail
