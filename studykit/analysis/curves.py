"""Find the stretches of time in which two conditions, or several, differ."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from studykit.core.arrays import Booleans, Floats, Integers
from studykit.core.errors import InputError

# Permutations computed at once: enough to be quick, few enough to fit in memory.
_BATCH = 256


@dataclass(frozen=True, kw_only=True, slots=True)
class _Grid:
    """The time points, which of them everybody has, and how many people there are."""

    times_s: Floats
    used: Booleans
    people: int


@dataclass(frozen=True, kw_only=True, slots=True)
class Cluster:
    """A stretch of time in which the conditions differ at every point.

    Parameters
    ----------
    start_s, stop_s : float
        Its first and its last time point.
    mass : float
        Sum of the statistic over its points; negative where a lies below b.
    p : float
        How often chance makes a cluster as heavy anywhere: corrected for looking at all times.
    """

    start_s: float
    stop_s: float
    mass: float
    p: float


@dataclass(frozen=True, kw_only=True, slots=True)
class CurveComparison:
    """Where curves differ.

    Parameters
    ----------
    clusters : tuple of Cluster
        In order of time; none if no point passes the threshold.
    p : float
        Of the heaviest cluster; 1 if there is none. Whether the curves differ at all.
    n : int
        Participants.
    threshold : float
        What the statistic of a point must exceed to belong to a cluster.
    times_used : int
        Time points at which everybody has a value.
    left_out_s : tuple of tuple of float
        First and last time of every stretch that is left out because somebody has no value in it; no cluster
        reaches across one.
    permutations : int
        How many were looked at, without the data as they are unless all were.
    method : str
        How p was found.
    """

    clusters: tuple[Cluster, ...]
    p: float
    n: int
    threshold: float
    times_used: int
    left_out_s: tuple[tuple[float, float], ...]
    permutations: int
    method: str


def cluster_permutation(
    a: Floats,
    b: Floats,
    times_s: Floats,
    *,
    rng: np.random.Generator,
    threshold_p: float = 0.05,
    permutations: int = 9999,
) -> CurveComparison:
    """Find when two conditions differ, for people who danced both.

    Parameters
    ----------
    a, b : ndarray, shape (participant, time)
        The two conditions' curves; NaN where there is no value.
    times_s : ndarray, shape (time,)
        Seconds, rising.
    rng : numpy.random.Generator
        Draws the signs; not used if all can be looked at.
    threshold_p : float
        Two-sided p of the paired t at which a time point joins a cluster. It decides which shapes are found
        best, not how often chance finds one.
    permutations : int
        If no more than so many flips are possible all are looked at, else so many are drawn.

    Raises
    ------
    InputError
        With fewer than two people, or no time at which everybody has a value.
    ValueError
        If the shapes do not fit.

    Notes
    -----
    Maris & Oostenveld 2007 (doi 10.1016/j.jneumeth.2007.03.024): under the null hypothesis each person's
    difference could as well have the other sign. The heaviest cluster of every flip makes the distribution to
    which each cluster is compared, which keeps the chance of any false cluster at p. All 2^n flips, or drawn
    ones with p = (hits + 1) / (draws + 1) (Phipson & Smyth 2010, doi 10.2202/1544-6115.1585). What p tells is
    that the curves differ; where a cluster begins and ends is not itself tested.
    """
    from scipy.stats import t as student

    differences = np.asarray(a, dtype=np.float64) - np.asarray(b, dtype=np.float64)
    grid = _grid(differences[:, None, :], times_s)
    people = grid.people
    kept = differences[:, grid.used]
    everything = 2**people <= permutations
    count = 2**people if everything else permutations

    def batches() -> Iterator[Floats]:
        for start in range(0, count, _BATCH):
            size = min(_BATCH, count - start)
            if everything:
                bits = np.arange(start, start + size)[:, None] >> np.arange(people) & 1
            else:
                bits = rng.integers(2, size=(size, people))
            yield _paired_t((1 - 2 * bits).astype(np.float64), kept)

    return _compared(
        grid,
        _paired_t(np.ones((1, people)), kept)[0],
        batches,
        threshold=float(student.isf(threshold_p / 2.0, people - 1)),
        is_exact=everything,
        mass="t",
    )


def several(
    curves: Mapping[str, Floats],
    times_s: Floats,
    *,
    rng: np.random.Generator,
    threshold_p: float = 0.05,
    permutations: int = 9999,
) -> CurveComparison:
    """Find when several conditions differ, for people who danced all of them.

    Parameters
    ----------
    curves : mapping of str to ndarray, shape (participant, time)
        One condition each, two or more; NaN where there is no value.
    times_s, rng, threshold_p, permutations
        As for `cluster_permutation`; p of a point is that of the repeated-measures F.

    Raises
    ------
    InputError
        With fewer than two people, or no time at which everybody has a value in all conditions.
    ValueError
        If the shapes do not fit.

    Notes
    -----
    As `cluster_permutation`, with each person's conditions shuffled; always drawn.
    """
    from scipy.stats import f as fisher

    stacked = np.stack([np.asarray(curve, dtype=np.float64) for curve in curves.values()], axis=1)
    grid = _grid(stacked, times_s)
    people, conditions, _ = stacked.shape
    if conditions < 2:
        raise ValueError("give two conditions or more")
    kept = stacked[:, :, grid.used]
    within = kept - kept.mean(axis=1, keepdims=True)
    same: Integers = np.tile(np.arange(conditions, dtype=np.int64), (1, people, 1))

    def batches() -> Iterator[Floats]:
        for start in range(0, permutations, _BATCH):
            size = min(_BATCH, permutations - start)
            yield _repeated_f(rng.permuted(np.repeat(same, size, axis=0), axis=2), within)

    return _compared(
        grid,
        _repeated_f(same, within)[0],
        batches,
        threshold=float(fisher.isf(threshold_p, conditions - 1, (conditions - 1) * (people - 1))),
        is_exact=False,
        mass="F",
    )


def _grid(values: Floats, times_s: Floats) -> _Grid:
    """Say which time points everybody has, after checking what was given."""
    times = np.asarray(times_s, dtype=np.float64)
    if times.shape != values.shape[-1:] or np.any(np.diff(times) <= 0.0):
        raise ValueError("times_s must be rising, one for every column of the curves")
    used = np.all(np.isfinite(values), axis=(0, 1))
    if len(values) < 2:
        raise InputError(
            f"at least two people with all curves are needed, not {len(values)}",
            where="curves",
            remedy="give two or more",
        )
    if not used.any():
        raise InputError(
            "there is no time at which everybody has a value",
            where="curves",
            remedy="leave out the participants whose curve is empty",
        )
    return _Grid(times_s=times, used=used, people=len(values))


def _floor(values: Floats) -> float:
    """Give a variance that is but rounding: where all agree the statistic is then large, not endless."""
    return max((1e-9 * float(np.abs(values).max())) ** 2, float(np.finfo(np.float64).tiny))


def _paired_t(signs: Floats, differences: Floats) -> Floats:
    """Give t of flipped differences, shape (flip, time)."""
    people = len(differences)
    mean = signs @ differences / people
    variance = (np.sum(differences**2, axis=0) - people * mean**2) / (people - 1)
    return np.asarray(mean / np.sqrt(np.maximum(variance, _floor(differences)) / people))


def _repeated_f(order: Integers, within: Floats) -> Floats:
    """Give F, shape (shuffle, time), of conditions in the order (shuffle, person, condition)."""
    people, conditions, times = within.shape
    # One row of ones and zeros a shuffle and condition picks and adds the values that it gets.
    picks = np.zeros((len(order), conditions, people, conditions))
    shuffle, person, condition = np.ogrid[: len(order), :people, :conditions]
    picks[shuffle, condition, person, order] = 1.0
    sums = picks.reshape(-1, people * conditions) @ within.reshape(-1, times)
    between = np.sum(sums.reshape(-1, conditions, times) ** 2, axis=1) / people
    error = np.maximum(np.sum(within**2, axis=(0, 1)) - between, _floor(within)) / (people - 1)
    return np.asarray(between / error)


def _compared(
    grid: _Grid,
    observed: Floats,
    batches: Callable[[], Iterator[Floats]],
    *,
    threshold: float,
    is_exact: bool,
    mass: str,
) -> CurveComparison:
    """Weigh the clusters of the data against the heaviest of every permutation."""
    places = np.flatnonzero(grid.used)
    follows = np.concatenate(([False], np.diff(places) == 1))
    found = [*_clusters(observed, follows, threshold), *_clusters(-observed, follows, threshold)]
    heaviest = np.concatenate([_heaviest(statistics, follows, threshold) for statistics in batches()])
    added = 0 if is_exact else 1
    clusters = []
    for first, last in sorted(found):
        weight = float(observed[first : last + 1].sum())
        # Sums of the same numbers may differ by rounding.
        hits = int(np.sum(heaviest >= abs(weight) * (1.0 - 1e-9)))
        clusters.append(
            Cluster(
                start_s=float(grid.times_s[places[first]]),
                stop_s=float(grid.times_s[places[last]]),
                mass=weight,
                p=(hits + added) / (len(heaviest) + added),
            )
        )
    drawn = "all possible" if is_exact else "drawn"
    return CurveComparison(
        clusters=tuple(clusters),
        p=min((cluster.p for cluster in clusters), default=1.0),
        n=grid.people,
        threshold=threshold,
        times_used=len(places),
        left_out_s=tuple(
            (float(grid.times_s[first]), float(grid.times_s[last])) for first, last in _runs(~grid.used)
        ),
        permutations=len(heaviest),
        method=f"cluster permutation, mass of {mass}, {drawn} permutations (Maris & Oostenveld 2007)",
    )


def _runs(is_in: Booleans) -> list[tuple[int, int]]:
    """Give the first and last place of every run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], is_in, [False]))))
    return [(int(first), int(last) - 1) for first, last in edges.reshape(-1, 2)]


def _clusters(statistic: Floats, follows: Booleans, threshold: float) -> list[tuple[int, int]]:
    found = []
    for first, last in _runs(statistic > threshold):
        starts = [first, *(place for place in range(first + 1, last + 1) if not follows[place])]
        found += list(zip(starts, [start - 1 for start in starts[1:]] + [last], strict=True))
    return found


def _heaviest(statistics: Floats, follows: Booleans, threshold: float) -> Floats:
    """Give the mass of the heaviest cluster of every permutation, of either sign; 0 if there is none."""
    both = np.stack((statistics, -statistics))
    running = np.zeros(both.shape[:2])
    heaviest = np.zeros(both.shape[:2])
    for place, follow in enumerate(follows):
        here = both[:, :, place]
        running = np.where(here > threshold, running * follow + here, 0.0)
        np.maximum(heaviest, running, out=heaviest)
    return np.asarray(heaviest.max(axis=0))
