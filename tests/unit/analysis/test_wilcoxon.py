from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from studykit.analysis.wilcoxon import hodges_lehmann, rank_biserial_interval, wilcoxon


def test_people_without_a_difference_have_no_effect() -> None:
    for zeros in ("drop", "pratt", "split"):
        result = wilcoxon([3.0, 4.0], [3.0, 4.0], zeros=zeros)
        assert (result.n, result.n_nonzero, result.w_plus) == (2, 0, result.w_minus)
        assert (result.z, result.p, result.rank_biserial) == (0.0, 1.0, 0.0)


def test_every_variant_is_named() -> None:
    a, b = [5.0, 6.0, 9.0], [4.0, 6.0, 5.0]
    names = {
        wilcoxon(a, b, p=p, zeros=zeros).variant
        for p in ("exact", "normal", "normal_continuity")
        for zeros in ("drop", "pratt", "split")
    }
    assert len(names) == 9


def test_pratts_exact_p_keeps_the_ranks_that_zeros_take() -> None:
    # Differences 0, 1, 2, 3: Pratt's ranks of the last three are 2, 3 and 4.
    result = wilcoxon([0.0, 1.0, 2.0, 3.0], np.zeros(4), zeros="pratt")
    assert result.w_plus == 9.0
    assert result.p == 0.25


def test_split_zeros_give_half_of_their_ranks_to_either_side() -> None:
    # Differences 0, 0, 1, 2, -3: the zeros share the ranks 1 and 2.
    result = wilcoxon([0.0, 0.0, 1.0, 2.0, -3.0], np.zeros(5), zeros="split")
    assert (result.w_plus, result.w_minus) == (3.0 + 4.0 + 1.5, 5.0 + 1.5)
    assert result.rank_biserial == pytest.approx(2.0 / 15.0)
    pratt = wilcoxon([0.0, 0.0, 1.0, 2.0, -3.0], np.zeros(5), zeros="pratt")
    assert (result.p, result.z) == (pratt.p, pratt.z)


def test_pairs_without_an_answer_are_refused() -> None:
    with pytest.raises(ValueError, match="finite"):
        wilcoxon([], [])
    with pytest.raises(ValueError, match="finite"):
        wilcoxon([1.0, np.nan], [1.0, 2.0])
    with pytest.raises(ValueError, match="finite"):
        hodges_lehmann([])
    with pytest.raises(ValueError, match="between 0 and 1"):
        hodges_lehmann([1.0, 2.0], confidence=95.0)


@pytest.mark.parametrize(
    ("people", "confidence", "achieved", "rank"),
    # The limits are the walsh averages of this rank from either end (Hollander & Wolfe, table A.4).
    [(5, 0.95, 0.9375, 1), (6, 0.95, 0.96875, 1), (10, 0.95, 0.951171875, 9), (20, 0.95, 0.9516, 53)],
)
def test_the_interval_of_the_shift_has_the_confidence_that_it_states(
    people: int, confidence: float, achieved: float, rank: int
) -> None:
    differences = np.random.default_rng(people).normal(size=people)
    shift = hodges_lehmann(differences, confidence=confidence)
    walsh = sorted((x + y) / 2 for place, x in enumerate(differences) for y in differences[place:])
    assert shift.confidence == pytest.approx(achieved, abs=5e-5)
    assert shift.interval == (walsh[rank - 1], walsh[-rank])
    assert shift.estimate == np.median(walsh)


def test_ties_and_zeros_are_told_of_in_the_method_of_the_shift() -> None:
    assert "at least" in hodges_lehmann([1.0, -1.0, 2.0]).method
    assert "at least" in hodges_lehmann([0.0, 1.0, 2.0]).method
    assert "at least" not in hodges_lehmann([0.5, 1.0, 2.0]).method
    assert hodges_lehmann([2.0, 2.0, 2.0]).interval == (2.0, 2.0)


def test_the_interval_of_the_rank_biserial() -> None:
    differences = np.random.default_rng(1).normal(size=20) + 0.6
    interval = rank_biserial_interval(differences, np.zeros(20))
    assert interval is not None
    low, high = interval
    assert -1.0 < low < wilcoxon(differences, np.zeros(20)).rank_biserial < high < 1.0
    swapped = rank_biserial_interval(np.zeros(20), differences)
    assert swapped == pytest.approx((-high, -low))
    assert rank_biserial_interval([1.0, 2.0], [1.0, 2.0]) is None


def test_people_who_all_differ_the_same_way_leave_room_for_others() -> None:
    # With 0.831567 or more the share of such people is not too unlike 20 of 20 (Clopper & Pearson).
    interval = rank_biserial_interval(np.arange(1.0, 21.0), np.zeros(20))
    assert interval == pytest.approx((2.0 * 0.831567**2 - 1.0, 1.0), abs=1e-5)
    turned = rank_biserial_interval(np.zeros(21), np.arange(21.0))
    assert turned == pytest.approx((-1.0, -(2.0 * 0.831567**2 - 1.0)), abs=1e-5)


Draws = Callable[[np.random.Generator, int], np.ndarray]
SYMMETRICAL: dict[str, tuple[Draws, float]] = {
    "normal": (lambda rng, people: rng.normal(0.5, 1.0, people), 0.5),
    "heavy tails": (lambda rng, people: rng.standard_t(3, people) + 0.5, 0.5),
    "ratings": (lambda rng, people: rng.binomial(6, 0.5, people) - 2.0, 1.0),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(SYMMETRICAL))
def test_the_interval_of_the_shift_covers_it_in_95_of_100_studies_of_20(kind: str) -> None:
    draws, shift = SYMMETRICAL[kind]
    rng = np.random.default_rng(11)
    limits = np.array([hodges_lehmann(draws(rng, 20)).interval for _ in range(4000)])
    covered = np.mean((limits[:, 0] <= shift) & (shift <= limits[:, 1]))
    assert covered >= 0.94  # 95.2 % less three standard errors
    if kind != "ratings":
        assert covered <= 0.97


@pytest.mark.slow
@pytest.mark.parametrize("mean", [0.0, 0.5, 0.8])
def test_the_interval_of_the_rank_biserial_covers_it_and_the_customary_one_does_not(mean: float) -> None:
    rng = np.random.default_rng(12)
    many = rng.normal(mean, 1.0, 400_000)
    true = wilcoxon(many, np.zeros(len(many)), p="normal").rank_biserial
    customary = 1.959964 * np.sqrt(20 * 21 * 41 / 6) / 210
    covered, covered_by_custom = 0, 0
    for _ in range(1500):
        differences = rng.normal(mean, 1.0, 20)
        interval = rank_biserial_interval(differences, np.zeros(20))
        assert interval is not None
        covered += interval[0] <= true <= interval[1]
        found = wilcoxon(differences, np.zeros(20), p="normal").rank_biserial
        covered_by_custom += abs(found) < 1.0 and abs(np.arctanh(found) - np.arctanh(true)) <= customary
    assert 0.93 <= covered / 1500 <= 0.985
    if mean:
        assert covered_by_custom / 1500 < 0.92
