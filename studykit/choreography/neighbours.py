"""Which segments follow one another smoothly: those that begin nearest to where another ends."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

COUNT = 32
_TILE = 1024  # segments whose first poses stay in the cache of a core together


def successors(
    first_poses: NDArray[np.floating[Any]], last_poses: NDArray[np.floating[Any]], *, count: int = COUNT
) -> np.ndarray[Any, np.dtype[np.int32]]:
    """Find, for every segment, the segments with the smallest displacement (Eq. 3) after it.

    Parameters
    ----------
    first_poses, last_poses : ndarray, shape (segment, 24, 3), m
        Pelvis-centred boundary poses, each turned to its own facing.
    count : int
        How many; fewer where the library has no more.

    Returns
    -------
    ndarray, shape (segment, count)
        Numbers of segments, nearest first; a segment does not follow itself.

    Notes
    -----
    All pairs are compared: 34,613 segments take seconds on one core, in memory that grows with the segments
    alone. Displacements are summed in single precision, so segments may change places that differ by less
    than a micrometre; of equal ones the first comes first.
    """
    segments = len(first_poses)
    count = min(count, segments - 1)
    joints_first = np.ascontiguousarray(np.moveaxis(first_poses, 0, -1), dtype=np.float32)
    found = np.full((segments, count), -1, dtype=np.int32)
    nearest = np.full((segments, count), np.inf, dtype=np.float32)
    if count > 0:
        for start in range(0, segments, _TILE):
            tile = np.ascontiguousarray(joints_first[..., start : start + _TILE])
            _merge(tile, np.asarray(last_poses, dtype=np.float32), start, found, nearest)
    return found


@njit(cache=True, nogil=True)
def _merge(tile: Any, last_poses: Any, start: int, found: Any, nearest: Any) -> None:
    """Take the segments of a tile, shape (joint, 3, segment), into the lists of nearest segments."""
    size, count = tile.shape[2], found.shape[1]
    total = np.empty(size, dtype=np.float32)
    for before in range(len(last_poses)):
        total[:] = 0.0
        for joint in range(tile.shape[0]):
            x, y, z = last_poses[before, joint]
            for after in range(size):
                total[after] += np.sqrt(
                    (tile[joint, 0, after] - x) ** 2
                    + (tile[joint, 1, after] - y) ** 2
                    + (tile[joint, 2, after] - z) ** 2
                )
        for after in range(size):
            if total[after] < nearest[before, count - 1] and start + after != before:
                place = count - 1
                while place > 0 and nearest[before, place - 1] > total[after]:
                    nearest[before, place] = nearest[before, place - 1]
                    found[before, place] = found[before, place - 1]
                    place -= 1
                nearest[before, place] = total[after]
                found[before, place] = start + after
