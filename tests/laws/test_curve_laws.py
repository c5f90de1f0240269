"""What must hold when curves are compared over time."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from scipy.ndimage import gaussian_filter1d, label

from studykit.analysis import curves as own
from studykit.analysis.curves import cluster_permutation, several
from studykit.core.errors import InputError


def smooth(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Curves whose neighbouring points are alike, as heart rate's are."""
    return np.asarray(gaussian_filter1d(rng.normal(size=shape), 3.0, axis=-1))


def brute_force(differences: np.ndarray, threshold: float) -> list[float]:
    """Give the p of every cluster, in order of time, by SciPy's t and labels over all flips."""

    def masses(values: np.ndarray) -> list[tuple[int, float]]:
        t = stats.ttest_1samp(values, 0.0).statistic
        found = []
        for signed in (t, -t):
            names, count = label(signed > threshold)
            places = [np.flatnonzero(names == number) for number in range(1, count + 1)]
            found += [(int(place[0]), float(signed[place].sum())) for place in places]
        return sorted(found)

    signs = product((1.0, -1.0), repeat=len(differences))
    heaviest = np.array(
        [
            max([mass for _, mass in masses(np.array(flip)[:, None] * differences)], default=0.0)
            for flip in signs
        ]
    )
    return [float(np.mean(heaviest >= mass * (1.0 - 1e-9))) for _, mass in masses(differences)]


@settings(deadline=None, max_examples=8)
@given(st.integers(0, 2**32 - 1))
def test_exact_p_is_that_of_looking_at_every_flip(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a = smooth(rng, 7, 40) + 0.3 * (np.arange(40) > 25)
    found = cluster_permutation(a, np.zeros_like(a), np.arange(40.0), rng=rng, threshold_p=0.1)
    assert found.permutations == 128
    assert [cluster.p for cluster in found.clusters] == brute_force(a, found.threshold)


def test_every_cluster_for_itself_would_be_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    # Wrong on purpose: each permutation gives its last cluster instead of its heaviest.
    a = smooth(np.random.default_rng(1), 8, 60)
    times = np.arange(60.0)

    def last(statistics: np.ndarray, follows: np.ndarray, threshold: float) -> np.ndarray:
        found = [[*own._clusters(row, follows, threshold), (0, -1)][0] for row in statistics]
        return np.array([row[a : b + 1].sum() for row, (a, b) in zip(statistics, found, strict=True)])

    def p_values() -> list[float]:
        comparison = cluster_permutation(a, 0.0 * a, times, rng=np.random.default_rng(0), threshold_p=0.2)
        return [cluster.p for cluster in comparison.clusters]

    expected = brute_force(a, float(stats.t.isf(0.1, 7)))
    assert p_values() == expected
    monkeypatch.setattr(own, "_heaviest", last)
    assert p_values() != expected


def test_a_planted_bump_is_found_where_it_is() -> None:
    rng = np.random.default_rng(2)
    times = np.arange(0.0, 32.0, 0.25)
    bump = 0.8 * ((times >= 10.0) & (times <= 16.0))
    a, b = smooth(rng, 20, len(times)) + bump, smooth(rng, 20, len(times))
    found = cluster_permutation(a, b, times, rng=rng, permutations=1999)
    best = min(found.clusters, key=lambda cluster: cluster.p)
    assert best.p == found.p == 1 / 2000
    assert best.start_s == pytest.approx(10.0, abs=0.75)
    assert best.stop_s == pytest.approx(16.0, abs=0.75)
    assert best.mass > 0.0
    mirrored = cluster_permutation(b, a, times, rng=np.random.default_rng(3), permutations=999)
    assert [-cluster.mass for cluster in mirrored.clusters] == [cluster.mass for cluster in found.clusters]
    again = several({"a": a, "b": b, "c": smooth(rng, 20, len(times))}, times, rng=rng, permutations=999)
    assert again.p == 1 / 1000


def test_two_conditions_by_f_are_two_conditions_by_t() -> None:
    rng = np.random.default_rng(4)
    a, b = smooth(rng, 2, 12, 50)
    times = np.arange(50.0)
    by_t = cluster_permutation(a, b, times, rng=rng, threshold_p=0.3)
    by_f = several({"a": a, "b": b}, times, rng=rng, threshold_p=0.3)
    assert by_f.threshold == pytest.approx(by_t.threshold**2)
    assert [(one.start_s, one.stop_s) for one in by_f.clusters] == [
        (one.start_s, one.stop_s) for one in by_t.clusters
    ]
    t = stats.ttest_rel(a, b).statistic
    for cluster in by_f.clusters:
        inside = (times >= cluster.start_s) & (times <= cluster.stop_s)
        assert cluster.mass == pytest.approx(np.sum(t[inside] ** 2))


def test_f_of_a_point_is_that_of_repeated_measures() -> None:
    # The textbook's sums of squares, written out.
    values = np.random.default_rng(5).normal(size=(6, 4, 1))
    found = own._repeated_f(np.tile(np.arange(4), (1, 6, 1)), values - values.mean(axis=1, keepdims=True))
    table = values[:, :, 0]
    conditions = 6 * np.sum((table.mean(axis=0) - table.mean()) ** 2)
    people = 4 * np.sum((table.mean(axis=1) - table.mean()) ** 2)
    error = np.sum((table - table.mean()) ** 2) - conditions - people
    assert found[0, 0] == pytest.approx((conditions / 3) / (error / 15))


@settings(deadline=None, max_examples=10)
@given(st.integers(0, 2**32 - 1), st.floats(0.01, 100.0), st.floats(-1e3, 1e3))
def test_units_and_order_of_people_do_not_matter(seed: int, scale: float, shift: float) -> None:
    rng = np.random.default_rng(seed)
    a, b = smooth(rng, 2, 8, 30)
    times = np.arange(30.0)
    first = cluster_permutation(a, b, times, rng=rng)
    order = rng.permutation(8)
    second = cluster_permutation(scale * a[order] + shift, scale * b[order] + shift, times, rng=rng)
    assert [cluster.p for cluster in second.clusters] == [cluster.p for cluster in first.clusters]


def test_the_same_seed_gives_the_same_p() -> None:
    a, b = smooth(np.random.default_rng(6), 2, 16, 40)
    pair = [
        cluster_permutation(
            a, b, np.arange(40.0), rng=np.random.default_rng(7), threshold_p=0.3, permutations=99
        )
        for _ in range(2)
    ]
    assert pair[0] == pair[1]
    assert pair[0].permutations == 99
    assert "drawn" in pair[0].method


def test_times_that_somebody_lacks_are_left_out_said_and_not_bridged() -> None:
    a = smooth(np.random.default_rng(8), 8, 40) + 5.0
    a[3, 20:23] = np.nan
    a[5, :2] = np.nan
    times = np.arange(40.0) / 2.0
    found = cluster_permutation(a, np.zeros((8, 40)), times, rng=np.random.default_rng(0))
    assert found.times_used == 35
    assert found.left_out_s == ((0.0, 0.5), (10.0, 11.0))
    assert [(cluster.start_s, cluster.stop_s) for cluster in found.clusters] == [(1.0, 9.5), (11.5, 19.5)]
    others = {"a": a, "b": np.zeros((8, 40)), "c": np.ones((8, 40))}
    assert (
        several(others, times, rng=np.random.default_rng(0), permutations=19).left_out_s == found.left_out_s
    )


def test_differences_that_are_alike_in_everybody_weigh_much_but_not_endlessly() -> None:
    a, b = np.ones((6, 10)), np.zeros((6, 10))
    found = cluster_permutation(a, b, np.arange(10.0), rng=np.random.default_rng(0))
    (cluster,) = found.clusters
    assert np.isfinite(cluster.mass)
    assert cluster.p == 2 / 64
    assert cluster_permutation(a, a, np.arange(10.0), rng=np.random.default_rng(0)).clusters == ()
    assert cluster_permutation(a, a, np.arange(10.0), rng=np.random.default_rng(0)).p == 1.0


def test_curves_that_cannot_be_compared_are_refused_in_words() -> None:
    rng = np.random.default_rng(9)
    a, times = smooth(rng, 4, 10), np.arange(10.0)
    with pytest.raises(InputError, match="no time at which everybody has a value"):
        cluster_permutation(np.where(np.eye(4, 1), np.nan, a), a, times, rng=rng)
    with pytest.raises(InputError, match="at least two people with all curves are needed, not 1"):
        cluster_permutation(a[:1], a[:1], times, rng=rng)
    with pytest.raises(ValueError, match="times_s must be rising"):
        cluster_permutation(a, a, times[::-1], rng=rng)
    with pytest.raises(ValueError, match="two conditions or more"):
        several({"a": a}, times, rng=rng)


def false_alarms(studies: int, rng: np.random.Generator, *, threshold_p: float) -> float:
    """Give the share of studies without any difference in which a cluster has p <= 0.05."""
    times = np.arange(80.0)
    alarms = 0
    for _ in range(studies):
        a, b = smooth(rng, 2, 20, 80)
        found = cluster_permutation(a, b, times, rng=rng, permutations=199, threshold_p=threshold_p)
        alarms += found.p <= 0.05
    return alarms / studies


@pytest.mark.slow
@pytest.mark.parametrize("threshold_p", [0.05, 0.3])
def test_chance_finds_a_cluster_in_at_most_six_of_a_hundred_studies(threshold_p: float) -> None:
    # 2,000 studies: the standard error is half a percent.
    assert false_alarms(2000, np.random.default_rng(10), threshold_p=threshold_p) <= 0.06


@pytest.mark.slow
def test_clusters_without_the_maximum_would_alarm_too_often(monkeypatch: pytest.MonkeyPatch) -> None:
    # Wrong on purpose: each permutation's mass is that of a cluster picked without regard to weight.
    def any_cluster(statistics: np.ndarray, follows: np.ndarray, threshold: float) -> np.ndarray:
        found = [[*own._clusters(np.abs(row), follows, threshold), (0, -1)][0] for row in statistics]
        return np.array([np.abs(row[a : b + 1]).sum() for row, (a, b) in zip(statistics, found, strict=True)])

    monkeypatch.setattr(own, "_heaviest", any_cluster)
    assert false_alarms(500, np.random.default_rng(10), threshold_p=0.3) > 0.06


@pytest.mark.slow
def test_chance_finds_a_cluster_among_several_conditions_as_rarely() -> None:
    rng = np.random.default_rng(11)
    alarms = 0
    for _ in range(500):
        four = dict(zip("abcd", smooth(rng, 4, 12, 40), strict=True))
        alarms += several(four, np.arange(40.0), rng=rng, permutations=199).p <= 0.05
    # 500 studies: 5 % and two standard errors.
    assert alarms / 500 <= 0.07


def test_runs_are_what_lies_between_edges() -> None:
    is_in = np.array([True, True, False, True, False, False, True])
    assert own._runs(is_in) == [(0, 1), (3, 3), (6, 6)]
    assert all(second[0] - first[1] > 1 for first, second in pairwise(own._runs(is_in)))
