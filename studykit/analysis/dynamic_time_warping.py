"""How far a dancer is from the guide, allowing for being a little early or late."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from studykit.analysis.common_body import COMMON_JOINTS, COMMON_WEIGHTS, common_space, resampled
from studykit.core.arrays import Floats, Integers
from studykit.core.errors import InputError

__all__ = [
    "COMMON_JOINTS",
    "COMMON_WEIGHTS",
    "Alignment",
    "align",
    "common_space",
    "frame_costs",
    "resampled",
]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Alignment:
    """Which frame of the dancer belongs to which frame of the guide, and how far apart they are.

    Parameters
    ----------
    distance_m : float
        Mean joint distance per aligned frame pair, m: the cost of the path divided by its length.
    total_m : float
        Cost of the path: the sum of the mean joint distances of its pairs, m.
    lag_s : float
        How late the dancer is, s: the median over the path; negative when early.
    path : ndarray, shape (step, 2)
        Frame of the guide and frame of the dancer, from the first pair to the last.
    distance_by_frame_m : ndarray, shape (guide frame,), m
        Mean joint distance of each guide frame to the frames it is paired with.
    unseen_frames : int
        Frames of the dancer in which nothing was seen; they were given the pose of the last frame before.
    """

    distance_m: float
    total_m: float
    lag_s: float
    path: Integers
    distance_by_frame_m: Floats
    unseen_frames: int


def align(
    guide: Floats,
    danced: Floats,
    band_frames: int,
    weights: Sequence[float] | Floats | None = None,
    *,
    frame_rate_hz: float = 30.0,
) -> Alignment:
    """Pair the frames of dancer and guide so that they are as close as possible, and measure what remains.

    Parameters
    ----------
    guide, danced : array_like, shape (frame, joint, 3), m
        In one space (`common_space`) and at one frame rate; NaN where a joint was not seen.
    band_frames : int
        How many frames the dancer may be early or late, beyond any difference in length.
    weights : array_like, shape (joint,), optional
        How much each joint counts; `COMMON_WEIGHTS` if not given.
    frame_rate_hz : float
        Frames a second, for the lag.

    Returns
    -------
    Alignment

    Raises
    ------
    InputError
        If nothing is seen in any frame, or no pairing within the band has joints to compare.
    ValueError
        If shapes do not fit or the band is negative.

    Notes
    -----
    Dynamic time warping: D(i, j) = c(i, j) + min(D(i - 1, j - 1), D(i - 1, j), D(i, j - 1)), where c is the
    weighted mean of the joints' distances over the joints seen in both frames. The band of Sakoe and Chiba is
    -r <= j - i <= r, widened on one side by the difference in length. At equal cost the diagonal step goes
    first. A frame in which nothing was seen keeps the pose of the last frame before it (the first ones that
    of the next), as a viewer would see it.
    """
    guide, _ = _carried_over(np.asarray(guide, dtype=np.float64), "guide")
    danced, unseen = _carried_over(np.asarray(danced, dtype=np.float64), "danced")
    joints = _weights(weights, guide, danced)
    if band_frames < 0:
        raise ValueError("band_frames must not be negative")
    longer = len(danced) - len(guide)
    first_shift = min(0, longer) - band_frames
    shifts = max(0, longer) + band_frames - first_shift + 1
    costs = _banded_costs(guide, danced, joints, first_shift, shifts)
    total = _accumulated(costs, first_shift, len(danced))
    path = _path_back(total, first_shift, len(danced))
    pair_costs = costs[path[:, 0], path[:, 1] - path[:, 0] - first_shift]
    by_frame = np.bincount(path[:, 0], weights=pair_costs) / np.bincount(path[:, 0])
    return Alignment(
        distance_m=float(pair_costs.mean()),
        total_m=float(pair_costs.sum()),
        lag_s=float(np.median(path[:, 1] - path[:, 0])) / frame_rate_hz,
        path=path,
        distance_by_frame_m=by_frame,
        unseen_frames=unseen,
    )


def frame_costs(guide: Floats, danced: Floats, weights: Sequence[float] | Floats) -> Floats:
    """Give the weighted mean distance of the joints of two poses, over the joints seen in both.

    Parameters
    ----------
    guide, danced : ndarray, shape (..., joint, 3), m
        Broadcast against each other.
    weights : array_like, shape (joint,)

    Returns
    -------
    ndarray, shape (...), m
        Infinite where no joint is seen in both.
    """
    difference = guide - danced
    distances = np.sqrt(np.einsum("...c,...c->...", difference, difference))
    joints = np.asarray(weights, dtype=np.float64)
    unseen = np.isnan(distances)
    if not unseen.any():
        return np.asarray(distances @ joints / joints.sum())
    distances[unseen] = 0.0
    seen_weight = np.where(unseen, 0.0, 1.0) @ joints
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(seen_weight > 0.0, distances @ joints / seen_weight, np.inf)


def _weights(weights: Sequence[float] | Floats | None, guide: Floats, danced: Floats) -> Floats:
    joints = np.asarray(COMMON_WEIGHTS if weights is None else weights, dtype=np.float64)
    wanted = (len(joints), 3)
    if guide.shape[1:] != wanted or danced.shape[1:] != wanted:
        raise ValueError(
            f"guide has the shape {guide.shape}, danced {danced.shape}, expected (frame, *{wanted})"
        )
    if np.any(joints < 0.0) or not joints.sum() > 0.0:
        raise ValueError("weights must not be negative, and not all zero")
    return joints


def _carried_over(positions: Floats, name: str) -> tuple[Floats, int]:
    """Give frames in which nothing was seen the pose of a neighbour, and count them."""
    if positions.ndim != 3:
        raise ValueError(f"{name} has the shape {positions.shape}, expected (frame, joint, 3)")
    seen = np.asarray(np.isfinite(positions).all(axis=-1).any(axis=-1))
    if not seen.any():
        raise InputError(
            "no joint is seen in any frame", where=name, remedy="check that the camera saw the dancer"
        )
    if seen.all():
        return positions, 0
    latest = np.maximum.accumulate(np.where(seen, np.arange(len(seen)), -1))
    return positions[np.where(latest < 0, np.argmax(seen), latest)], int(np.sum(~seen))


def _banded_costs(guide: Floats, danced: Floats, weights: Floats, first_shift: int, shifts: int) -> Floats:
    """Give c(i, i + shift) for every shift in the band, shape (guide frame, shift); infinite outside."""
    costs = np.full((len(guide), shifts), np.inf)
    for column in range(shifts):
        shift = first_shift + column
        start, stop = max(0, -shift), min(len(guide), len(danced) - shift)
        if start < stop:
            costs[start:stop, column] = frame_costs(
                guide[start:stop], danced[start + shift : stop + shift], weights
            )
    return costs


def _accumulated(costs: Floats, first_shift: int, danced_frames: int) -> Floats:
    """Give D(i, i + shift) with a border of infinity: a row above and a column on either side.

    All cells of one anti-diagonal i + j are worked out at once. In memory the cell (i, shift) is followed,
    one guide frame later on the same anti-diagonal, by (i + 1, shift - 2): a constant stride.
    """
    frames, shifts = costs.shape
    width = shifts + 2
    total = np.full((frames + 1, width), np.inf)
    padded = np.full((frames + 1, width), np.inf)
    padded[1:, 1:-1] = costs
    total[0, 1 - first_shift] = 0.0  # the pair before the first, from which the path starts
    cells, local = total.ravel(), padded.ravel()
    for diagonal in range(frames + danced_frames - 1):
        # i + j = diagonal and 0 <= j - i - first_shift < shifts
        low = max(0, -((first_shift + shifts - 1 - diagonal) // 2))
        high = min(frames - 1, (diagonal - first_shift) // 2)
        if low > high:
            continue
        start = (low + 1) * width + 1 + diagonal - 2 * low - first_shift
        stop, stride = start + (high - low) * (width - 2) + 1, width - 2
        best = np.minimum(cells[start - width : stop - width : stride], cells[start - 1 : stop - 1 : stride])
        np.minimum(best, cells[start - width + 1 : stop - width + 1 : stride], out=best)
        np.add(best, local[start:stop:stride], out=cells[start:stop:stride])
    if not np.isfinite(total[frames, 1 + danced_frames - frames - first_shift]):
        raise InputError(
            "within the band there are frames of guide and dancer without a joint seen in both",
            remedy="widen the band, or check which joints the camera saw",
        )
    return total


def _path_back(total: Floats, first_shift: int, danced_frames: int) -> Integers:
    """Follow the cheapest way back from the last pair, shape (step, 2)."""
    rows = total.tolist()
    guide_frame, danced_frame = len(rows) - 2, danced_frames - 1
    path = [(guide_frame, danced_frame)]
    while guide_frame or danced_frame:
        column = 1 + danced_frame - guide_frame - first_shift
        both, guide_only = rows[guide_frame][column], rows[guide_frame][column + 1]
        danced_only = rows[guide_frame + 1][column - 1]
        cheapest = min(both, guide_only, danced_only)
        if both == cheapest:
            guide_frame, danced_frame = guide_frame - 1, danced_frame - 1
        elif guide_only == cheapest:
            guide_frame -= 1
        else:
            danced_frame -= 1
        path.append((guide_frame, danced_frame))
    return np.array(path[::-1], dtype=np.int64)
