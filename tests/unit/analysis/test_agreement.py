"""Agreement of raters: known answers, chance, certainty and what cannot be rated."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.analysis.agreement import Agreement, krippendorff_alpha
from studykit.core.errors import InputError


def judged(rng: np.random.Generator, units: int, *, right: float, raters: int = 3) -> np.ndarray:
    """Let raters tell one of two things, each right in this share of the cases."""
    truth = rng.integers(2, size=units)
    return np.where(rng.random((raters, units)) < right, truth, 1 - truth).astype(float)


def test_who_always_agrees_has_an_alpha_of_one() -> None:
    told = krippendorff_alpha(np.tile([0.0, 1.0, 1.0, 0.0, 2.0, 1.0], (3, 1)), replicates=200)
    assert told.alpha == 1.0
    assert told.interval == (1.0, 1.0)
    assert (told.raters, told.units, told.ratings) == (3, 6, 18)
    assert "200 times" in told.method


def test_who_guesses_has_an_alpha_near_zero_and_an_interval_around_it() -> None:
    told = krippendorff_alpha(judged(np.random.default_rng(1), 1000, right=0.5), replicates=300)
    assert abs(told.alpha) < 0.05
    assert told.interval[0] < 0.0 < told.interval[1]


def test_who_always_contradicts_has_an_alpha_below_zero() -> None:
    ratings = np.array([[0.0, 1.0] * 10, [1.0, 0.0] * 10])
    # n_c = 20 each of 40: expected disagreement 2 x 20 x 20 / (40 x 39), observed 1.
    assert krippendorff_alpha(ratings, replicates=50).alpha == pytest.approx(1.0 - 39.0 / 20.0)


def test_two_raters_of_a_yes_or_no_by_hand() -> None:
    # Hayes and Krippendorff's definition for two raters: 1 - (n - 1) o01 / (n0 n1), n = 20 values.
    first = [0, 1, 0, 0, 0, 0, 0, 0, 1, 0]
    second = [1, 1, 1, 0, 0, 1, 0, 0, 0, 0]
    told = krippendorff_alpha([first, second], replicates=50)
    assert told.alpha == pytest.approx(1.0 - 19.0 * 4.0 / (14.0 * 6.0))
    # Wrong: agreement in per cent, which calls six of ten good.
    assert told.alpha < 0.1 < np.mean(np.array(first) == second)


def test_what_one_alone_rated_says_nothing() -> None:
    rng = np.random.default_rng(2)
    ratings = judged(rng, 40, right=0.9)
    alone = np.full((3, 5), np.nan)
    alone[1] = [0, 1, 1, 1, 1]
    more = krippendorff_alpha(np.hstack((ratings, alone)), seed=3, replicates=100)
    assert more == krippendorff_alpha(ratings, seed=3, replicates=100)
    assert more.units == 40


def test_the_same_seed_gives_the_same_interval() -> None:
    ratings = judged(np.random.default_rng(4), 30, right=0.8)
    intervals = [krippendorff_alpha(ratings, seed=seed, replicates=100).interval for seed in (1, 1, 2)]
    assert intervals[0] == intervals[1] != intervals[2]


def test_a_rare_category_leaves_no_draw_without_an_answer() -> None:
    ratings = np.zeros((2, 12))
    ratings[:, 0] = 1.0  # a third of the draws lack it
    told = krippendorff_alpha(ratings, replicates=200)
    assert np.all(np.isfinite(told.interval))


@pytest.mark.parametrize(
    ("ratings", "problem"),
    [
        ([[0, 1, 0, 1]], "1 people rated"),
        ([[0, 1, 0, 1], [np.nan] * 4], "1 people rated"),
        (np.full((3, 4), np.nan), "0 people rated"),
        ([[0, np.nan, 1], [0, 1, np.nan]], "1 units were rated by two"),
        ([[1, 1, 1], [1, 1, 1]], "all ratings are the same"),
        ([0, 1, 0], "1 axes"),
    ],
)
def test_what_cannot_be_judged_is_refused(ratings, problem) -> None:
    with pytest.raises(InputError, match=problem):
        krippendorff_alpha(ratings)


def covered(*, studies: int, replicates: int) -> float:
    """Give the share of studies whose interval holds the alpha of the population they come from."""
    # Two of three categories are as frequent; D_o = 2 q (1 - q), D_e = 1/2, so alpha = (2 q - 1)^2.
    true_alpha, rng = (2.0 * 0.85 - 1.0) ** 2, np.random.default_rng(7)
    told: list[Agreement] = [
        krippendorff_alpha(judged(rng, 60, right=0.85), replicates=replicates, seed=study)
        for study in range(studies)
    ]
    return float(np.mean([one.interval[0] <= true_alpha <= one.interval[1] for one in told]))


def test_the_interval_usually_holds_the_truth() -> None:
    assert covered(studies=60, replicates=200) > 0.85


@pytest.mark.slow
def test_the_interval_holds_the_truth_in_about_95_of_100_studies() -> None:
    assert 0.915 < covered(studies=600, replicates=400) < 0.975
