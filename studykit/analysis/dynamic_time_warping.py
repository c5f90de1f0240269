"""How far a dancer is from the guide, allowing for being a little early or late."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from studykit.analysis.common_body import COMMON_JOINTS, COMMON_WEIGHTS, common_space, resampled
from studykit.core.arrays import Floats, Integers
from studykit.core.errors import InputError

__all__ = [
    "COMMON_JOINTS",
    "COMMON_WEIGHTS",
    "LIMBS",
    "Alignment",
    "Definition",
    "align",
    "common_space",
    "frame_costs",
    "resampled",
]


Definition = Literal["mean_joint_distance", "tslearn"]
"""How the distance of two movements is defined; see `align`."""


def _joints(*words: str) -> tuple[int, ...]:
    return tuple(n for n, name in enumerate(COMMON_JOINTS) if all(word in name for word in words))


_ARM, _LEG = ("shoulder", "elbow", "wrist"), ("hip", "knee", "ankle")

LIMBS: dict[str, tuple[int, ...]] = {
    "arms": tuple(j for part in _ARM for j in _joints(part)),
    "legs": tuple(j for part in _LEG for j in _joints(part)),
    "trunk": (*_joints("neck"), *_joints("head"), *_joints("spine3")),
    "left": _joints("left"),
    "right": _joints("right"),
    "left_arm": tuple(j for part in _ARM for j in _joints("left", part)),
    "right_arm": tuple(j for part in _ARM for j in _joints("right", part)),
    "left_leg": tuple(j for part in _LEG for j in _joints("left", part)),
    "right_leg": tuple(j for part in _LEG for j in _joints("right", part)),
}
"""Parts of the body whose distance can be told apart, as places in `COMMON_JOINTS`."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Alignment:
    """Which frame of the dancer belongs to which frame of the guide, and how far apart they are.

    Parameters
    ----------
    distance_m : float
        Mean joint distance per aligned frame pair, m: the cost of the path divided by its length. In
        tslearn's definition the root of the path's cost.
    total_m : float
        Cost of the path: the sum of the mean joint distances of its pairs, m; in tslearn's definition the
        sum of the joints' squared distances, m^2.
    path : ndarray, shape (step, 2)
        Frame of the guide and frame of the dancer, from the first pair to the last.
    joint_distances_m : ndarray, shape (step, joint), m
        How far apart each joint is in each pair; NaN where it was not seen in both.
    weights : ndarray, shape (joint,)
        How much each joint counts.
    frame_rate_hz : float
        Frames a second.
    unseen_frames : int
        Frames of the dancer in which nothing was seen; they were given the pose of the last frame before.
    """

    distance_m: float
    total_m: float
    path: Integers
    joint_distances_m: Floats
    weights: Floats
    frame_rate_hz: float
    unseen_frames: int

    @property
    def lag_s(self) -> float:
        """How late the dancer is, s: the median over the path; negative when early."""
        return float(np.median(self._lags)) / self.frame_rate_hz

    @property
    def lag_sd_s(self) -> float:
        """How unsteadily late the dancer is, s: standard deviation of the lag over the path."""
        return float(np.std(self._lags)) / self.frame_rate_hz

    @property
    def distance_by_frame_m(self) -> Floats:
        """Mean joint distance of each guide frame to those it is paired with, shape (guide frame,), m."""
        return self._by_frame(_weighted_mean(self.joint_distances_m, self.weights))

    @property
    def _lags(self) -> Integers:
        return np.asarray(self.path[:, 1] - self.path[:, 0])

    def limb_by_frame_m(self, limb: str) -> Floats:
        """Give how far one of `LIMBS` is from the guide's over time, shape (guide frame,), m.

        NaN where none of its joints was seen.
        """
        joints = list(LIMBS[limb])
        return self._by_frame(_weighted_mean(self.joint_distances_m[:, joints], self.weights[joints]))

    def limb_m(self, limb: str) -> float:
        """Give how far one of `LIMBS` is from the guide's per aligned frame pair, m; NaN if never seen."""
        joints = list(LIMBS[limb])
        by_pair = _weighted_mean(self.joint_distances_m[:, joints], self.weights[joints])
        return float(np.nanmean(by_pair)) if np.isfinite(by_pair).any() else np.nan

    def _by_frame(self, by_pair: Floats) -> Floats:
        seen, frames = np.isfinite(by_pair), int(self.path[-1, 0]) + 1
        pairs = np.bincount(self.path[seen, 0], minlength=frames)
        sums = np.bincount(self.path[seen, 0], weights=by_pair[seen], minlength=frames)
        return np.where(pairs > 0, sums / np.maximum(pairs, 1), np.nan)


def align(
    guide: Floats,
    danced: Floats,
    band_frames: int | None,
    weights: Sequence[float] | Floats | None = None,
    *,
    frame_rate_hz: float = 30.0,
    definition: Definition = "mean_joint_distance",
) -> Alignment:
    """Pair the frames of dancer and guide so that they are as close as possible, and measure what remains.

    Parameters
    ----------
    guide, danced : array_like, shape (frame, joint, 3), m
        In one space (`common_space`) and at one frame rate; NaN where a joint was not seen.
    band_frames : int or None
        How many frames the dancer may be early or late, beyond any difference in length; None for any.
    weights : array_like, shape (joint,), optional
        How much each joint counts; if not given `COMMON_WEIGHTS`, or all the same in tslearn's definition.
    frame_rate_hz : float
        Frames a second, for the lag.
    definition : {"mean_joint_distance", "tslearn"}
        What a pair costs and what the distance is: the mean of the joints' distances, and the mean of that
        over the path; or the sum of their squares, and the root of the sum over the path.

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
    of the next), as a viewer would see it. With every joint seen, "tslearn" is what `tslearn.metrics.dtw`
    gives (Tavenard et al. 2020).
    """
    from studykit.analysis.warping_kernel import warped

    guide, _ = _carried_over(np.asarray(guide, dtype=np.float64), "guide")
    danced, unseen = _carried_over(np.asarray(danced, dtype=np.float64), "danced")
    is_squared = definition == "tslearn"
    if weights is None:
        weights = np.ones(guide.shape[1]) if is_squared else COMMON_WEIGHTS
    joints = _checked(weights, guide, danced)
    shares = joints if is_squared else joints / joints.sum()
    factors = (np.sqrt(shares) if is_squared else shares)[:, None]
    first, beyond = _bounds(len(guide), len(danced), band_frames)
    turned = np.ascontiguousarray(np.moveaxis(danced * factors, 0, 2))
    path, total = warped(guide * factors, turned, shares, first, beyond, squared=is_squared)
    if not np.isfinite(total):
        raise InputError(
            "within the band there are frames of guide and dancer without a joint seen in both",
            remedy="widen the band, or check which joints the camera saw",
        )
    return Alignment(
        distance_m=float(np.sqrt(total)) if is_squared else total / len(path),
        total_m=total,
        path=path,
        joint_distances_m=_distances(guide[path[:, 0]], danced[path[:, 1]]),
        weights=joints,
        frame_rate_hz=frame_rate_hz,
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
    mean = _weighted_mean(_distances(guide, danced), np.asarray(weights, dtype=np.float64))
    return np.where(np.isnan(mean), np.inf, mean)


def _distances(guide: Floats, danced: Floats) -> Floats:
    """Give how far apart each joint is, shape (..., joint), m."""
    difference = guide - danced
    return np.asarray(np.sqrt(np.einsum("...c,...c->...", difference, difference)))


def _weighted_mean(distances: Floats, weights: Floats) -> Floats:
    """Give the weighted mean over the joints that were seen, shape (...); NaN where none was."""
    seen = np.isfinite(distances)
    total = np.where(seen, distances, 0.0) @ weights
    seen_weight = seen @ weights
    return np.where(seen_weight > 0.0, total / np.where(seen_weight > 0.0, seen_weight, 1.0), np.nan)


def _checked(weights: Sequence[float] | Floats, guide: Floats, danced: Floats) -> Floats:
    joints = np.asarray(weights, dtype=np.float64)
    wanted = (len(joints), 3)
    if guide.shape[1:] != wanted or danced.shape[1:] != wanted:
        raise ValueError(
            f"guide has the shape {guide.shape}, danced {danced.shape}, expected (frame, *{wanted})"
        )
    if np.any(joints < 0.0) or not joints.sum() > 0.0:
        raise ValueError("weights must not be negative, and not all zero")
    return joints


def _bounds(guide_frames: int, danced_frames: int, band_frames: int | None) -> tuple[Integers, Integers]:
    """Give each guide frame's first frame of the dancer within the band, and the one after the last."""
    if band_frames is None:
        band_frames = max(guide_frames, danced_frames)
    if band_frames < 0:
        raise ValueError("band_frames must not be negative")
    longer, frames = danced_frames - guide_frames, np.arange(guide_frames)
    first = np.maximum(0, frames + min(0, longer) - band_frames)
    return first, np.minimum(danced_frames, frames + max(0, longer) + band_frames + 1)


def _carried_over(positions: Floats, name: str) -> tuple[Floats, int]:
    """Give frames in which nothing was seen the pose of a neighbour, and count them."""
    if positions.ndim != 3:
        raise ValueError(f"{name} has the shape {positions.shape}, expected (frame, joint, 3)")
    finite = np.isfinite(positions)
    if finite.all():
        return positions, 0
    seen = np.asarray(finite.all(axis=-1).any(axis=-1))
    if not seen.any():
        raise InputError(
            "no joint is seen in any frame", where=name, remedy="check that the camera saw the dancer"
        )
    latest = np.maximum.accumulate(np.where(seen, np.arange(len(seen)), -1))
    return positions[np.where(latest < 0, np.argmax(seen), latest)], int(np.sum(~seen))
