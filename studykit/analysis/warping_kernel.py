"""The compiled heart of dynamic time warping: what pairs of frames cost, and the cheapest way through.

Row i holds the pairs of guide frame i with the dancer's frames from `first[i]` on, as many as the band
allows. Loops run along a row, so that several pairs are worked out at a time, and only one row of sums is
kept; of the others, only where each pair's cheapest path came from.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from numba import njit

from studykit.core.arrays import Floats, Integers

_Function = TypeVar("_Function", bound=Callable[..., Any])
_BOTH, _GUIDE_ONLY, _DANCED_ONLY = 0, 1, 2
_AT_ONCE = 4


def _compiled(function: _Function) -> _Function:
    # A product and a sum may be rounded once instead of twice, which halves the time.
    compiling: Any = njit(nogil=True, cache=True, error_model="numpy", fastmath={"contract"})
    made: _Function = compiling(function)
    return made


@_compiled
def warped(
    guide: Floats, danced: Floats, weights: Floats, first: Integers, beyond: Integers, *, squared: bool
) -> tuple[Integers, float]:
    """Find the cheapest path of pairs from the first to the last, and what it costs.

    Parameters
    ----------
    guide : ndarray, shape (frame, joint, 3), m
        Already multiplied by what the distance of each joint is to count.
    danced : ndarray, shape (joint, 3, frame), m
        Multiplied likewise; NaN where a joint was not seen.
    weights : ndarray, shape (joint,)
        By what each joint's distance (or its square) has been multiplied; the joints seen in both frames
        make up for the others.
    first, beyond : ndarray, shape (guide frame,)
        The first frame of the dancer in each row, and the one after the last.
    squared : bool
        A pair costs the sum of its squared distances; otherwise that of its distances.

    Returns
    -------
    path : ndarray, shape (step, 2)
    cost : float
        Infinite where there is no path.

    Notes
    -----
    D(i, j) = c(i, j) + min(D(i - 1, j - 1), D(i - 1, j), D(i, j - 1)); at equal cost the diagonal step goes
    first, then the guide's alone.
    """
    frames, width = len(guide), np.max(beyond - first)
    has_gaps = np.isnan(guide).any() or np.isnan(danced).any()
    block, came_from = np.empty((_AT_ONCE, width + _AT_ONCE)), np.empty((frames, width), dtype=np.uint8)
    above, sums = np.full(width + 2, np.inf), np.full(width + 2, np.inf)
    sums[0] = 0.0  # the pair before the first
    for i in range(frames):
        if i % _AT_ONCE == 0:
            begun, last = i, min(i + _AT_ONCE, frames)
            _cost_rows(block, guide[i:last], danced, (first[i], beyond[last - 1]), squared)
        start, count = first[i] - first[begun], beyond[i] - first[i]
        costs = block[i - begun, start : start + count]
        if has_gaps and np.isnan(costs.sum()):
            _cost_row_with_gaps(costs, guide[i], danced[:, :, first[i] : beyond[i]], weights, squared)
        above, sums = sums, above
        down = first[i] - first[i - 1] if i else 0  # how many frames later this row begins than the last
        left = np.inf
        for c in range(count):
            both, guide_only = above[c + down], above[c + down + 1]
            best = min(both, guide_only)
            came_from[i, c] = _DANCED_ONLY if left < best else _GUIDE_ONLY if guide_only < both else _BOTH
            left = costs[c] + min(best, left)
            sums[c + 1] = left
        sums[0] = np.inf
        sums[count + 1 :] = np.inf
    return _path_back(came_from, first, beyond), left


@_compiled
def _cost_rows(
    block: Floats,
    guide: Floats,
    danced: Floats,
    bounds: tuple[int, int],
    squared: bool,  # noqa: FBT001
) -> None:
    """Let several rows use each joint while it is at hand."""
    start, stop = bounds
    block[:] = 0.0
    for joint in range(guide.shape[1]):
        x, y, z = danced[joint, 0, start:stop], danced[joint, 1, start:stop], danced[joint, 2, start:stop]
        for i in range(len(guide)):
            row = block[i, : stop - start]  # in one piece, to be worked out several at a time
            gx, gy, gz = guide[i, joint]
            for c in range(stop - start):
                square = (gx - x[c]) ** 2 + (gy - y[c]) ** 2 + (gz - z[c]) ** 2
                row[c] += square if squared else np.sqrt(square)


@_compiled
def _cost_row_with_gaps(row: Floats, guide: Floats, danced: Floats, weights: Floats, squared: bool) -> None:  # noqa: FBT001
    for c in range(len(row)):
        cost, seen = 0.0, 0.0
        for joint in range(len(weights)):
            square = np.sum((guide[joint] - danced[joint, :, c]) ** 2)
            if not np.isnan(square):
                cost += square if squared else np.sqrt(square)
                seen += weights[joint]
        row[c] = cost * weights.sum() / seen if seen > 0.0 else np.inf


@_compiled
def _path_back(came_from: Integers, first: Integers, beyond: Integers) -> Integers:
    i, j = len(first) - 1, beyond[-1] - 1
    step = i + j + 2
    path = np.empty((step, 2), dtype=np.int64)
    while i >= 0 and j >= first[i]:
        step -= 1
        path[step, 0], path[step, 1] = i, j
        way = came_from[i, j - first[i]]
        i, j = i - (way != _DANCED_ONLY), j - (way != _GUIDE_ONLY)
    return path[step:]
