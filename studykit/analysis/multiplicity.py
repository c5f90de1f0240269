"""Correct p values where several tests could each be wrong."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain, combinations

import numpy as np

from studykit.analysis.friedman import centred_ranks, chi_squared_of_ranks
from studykit.analysis.wilcoxon import wilcoxon
from studykit.core.arrays import Floats

MOST_CONDITIONS = 6
"""That closed testing compares: six split into groups in 203 ways, seven in 877."""

Groups = tuple[tuple[int, ...], ...]


def _adjusted(p: Sequence[float] | Floats, method: str) -> Floats:
    import pingouin

    values = np.asarray(p, dtype=np.float64)
    if not values.size:
        return values
    return np.asarray(pingouin.multicomp(values, method=method)[1], dtype=np.float64)


def holm(p: Sequence[float] | Floats) -> Floats:
    """Correct p values for testing several pairs, stepwise (Holm 1979), shape (test,).

    Examples
    --------
    >>> holm([0.01, 0.04, 0.03]).round(2).tolist()
    [0.03, 0.06, 0.06]
    """
    return _adjusted(p, "holm")


def bonferroni(p: Sequence[float] | Floats) -> Floats:
    """Correct p values for testing several pairs by their number, shape (test,)."""
    return _adjusted(p, "bonf")


def closed_friedman(table: Floats, pairs: Sequence[tuple[int, int]]) -> Floats:
    """Compare pairs of conditions so that all claims together are wrong at most as often as one may be.

    Parameters
    ----------
    table : array_like, shape (person, condition)
        One value each; at least two people and at most six conditions.
    pairs : sequence of tuple of int
        Columns to compare.

    Returns
    -------
    numpy.ndarray, shape (pair,)
        Adjusted p: at least the pair's own p and Friedman's.

    Raises
    ------
    ValueError
        If the table is not finite or too small, has more than six conditions, or a pair names no two of them.

    Notes
    -----
    Closed testing (Marcus, Peritz & Gabriel 1976, doi:10.1093/biomet/63.3.655). "These conditions do not
    differ" splits the conditions into groups that are alike within. Each split is tested by its groups: two
    conditions by the exact signed-rank test with zeros dropped, more by Friedman's test (chi-squared); the
    smallest p counts, times the number of groups of two or more. A pair's adjusted p is the largest over all
    splits that keep the pair together. It may fall below Holm's or exceed it.

    Examples
    --------
    >>> pulse = [[72, 120, 76], [96, 120, 95], [88, 132, 104], [92, 120, 96], [74, 101, 84], [76, 96, 72],
    ...          [82, 112, 76]]
    >>> closed_friedman(pulse, [(0, 1), (0, 2), (1, 2)]).round(4).tolist()
    [0.0156, 0.4688, 0.0156]
    """
    values = np.asarray(table, dtype=np.float64)
    if values.ndim != 2 or values.shape[0] < 2 or not np.all(np.isfinite(values)):
        raise ValueError(f"the table has the shape {values.shape}, expected 2 or more people, all finite")
    conditions = values.shape[1]
    if conditions > MOST_CONDITIONS:
        raise ValueError(
            f"closed testing compares {MOST_CONDITIONS} conditions at most, not {conditions}: use holm"
        )
    if not all(0 <= min(pair) < max(pair) < conditions for pair in pairs):
        raise ValueError(f"a pair is not two of the {conditions} conditions")
    p_of_group: dict[tuple[int, ...], float] = {}
    adjusted = dict.fromkeys(combinations(range(conditions), 2), 0.0)
    for split in _splits(tuple(range(conditions))):
        groups = [group for group in split if len(group) > 1]
        p_of_group |= {group: _p_of_group(values[:, group]) for group in groups if group not in p_of_group}
        p = min(1.0, len(groups) * min((p_of_group[group] for group in groups), default=0.0))
        for pair in chain.from_iterable(combinations(group, 2) for group in groups):
            adjusted[pair] = max(adjusted[pair], p)
    return np.array([adjusted[min(pair), max(pair)] for pair in pairs])


def _splits(conditions: tuple[int, ...]) -> Iterator[Groups]:
    """Give every way to put the conditions into groups."""
    if not conditions:
        yield ()
        return
    first, *others = conditions
    for split in _splits(tuple(others)):
        yield ((first,), *split)
        for place, group in enumerate(split):
            yield (*split[:place], (first, *group), *split[place + 1 :])


def _p_of_group(values: Floats) -> float:
    if values.shape[1] == 2:
        return wilcoxon(values[:, 0], values[:, 1]).p
    if np.all(values == values[:, :1]):
        return 1.0  # nobody tells these conditions apart
    return chi_squared_of_ranks(centred_ranks(values))[1]
