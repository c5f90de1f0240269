"""How well segments were joined: jolts, sliding feet, energy lost or won."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from studykit.core.arrays import Booleans, Floats
from studykit.motion import energy, kinematics
from studykit.motion.animation import REACH
from studykit.motion.blending import HALF_WINDOW
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY

LOW_M = 0.05
"""A ball of the foot lower than this should not travel."""

_USUAL_PERCENTILE = 99.9
_BALLS = [NEUTRAL_BODY.index(name) for name in ("left_foot", "right_foot")]


class JoinQuality(NamedTuple):
    """How a dance is where its segments meet, against the segments themselves.

    Attributes
    ----------
    accelerations : ndarray, shape (join,), m/s^2
        See `join_accelerations`.
    sliding : float
        Mean speed over the floor of balls of the feet that are low, in the whole dance, as a multiple of the
        same in the segments; NaN where none are low or, in the segments, none moves.
    join_sliding : float
        The same about the joins alone, ten frames on each side.
    linear_energy, rotational_energy : float
        Of the dance, as a multiple of the sum over the segments.
    """

    accelerations: Floats
    sliding: float
    join_sliding: float
    linear_energy: float
    rotational_energy: float


def join_quality(segments: Sequence[Motion], motion: Motion) -> JoinQuality:
    """Measure a movement against the segments that it was made of.

    Parameters
    ----------
    segments : sequence of Motion
        What was joined, the floor at height zero.
    motion : Motion
        What became of it.
    """
    joins = _joins(segments)
    near = np.zeros(len(motion) - 1, dtype=bool)
    for join in joins:
        near[join - REACH - 1 : join + REACH] = True
    slides, own = _slides(motion), _mean(np.concatenate([_slides(segment) for segment in segments]))
    before, after = np.sum([_energies(s) for s in segments], axis=0), _energies(motion)
    return JoinQuality(
        accelerations=join_accelerations(motion, joins),
        sliding=_multiple(_mean(slides), own),
        join_sliding=_multiple(_mean(slides[near]), own),
        linear_energy=_multiple(after[0], before[0]),
        rotational_energy=_multiple(after[1], before[1]),
    )


def join_accelerations(motion: Motion, joins: Sequence[int]) -> Floats:
    """Give the hardest jolt at each join, shape (join,), m/s^2.

    The largest acceleration of any joint, seen from the pelvis, by second differences, over the twelve frames
    whose acceleration the blend changes.

    Parameters
    ----------
    joins : sequence of int
        The frame that each segment but the first begins with.
    """
    hardest = _accelerations(motion).max(axis=1)
    # Row n is the acceleration at frame n + 1.
    windows = [hardest[join - HALF_WINDOW - 2 : join + HALF_WINDOW] for join in joins]
    return np.array([window.max() for window in windows])


def usual_acceleration(segments: Sequence[Motion]) -> float:
    """Give what joints of these dancers stay below in 99.9 % of all cases, m/s^2.

    About 7 % of all stretches of twelve frames go beyond it somewhere: see `jolting_share`.
    """
    return float(np.percentile(np.concatenate([_accelerations(s) for s in segments]), _USUAL_PERCENTILE))


def jolting_share(segments: Sequence[Motion], acceleration: float) -> float:
    """Give how often dancers themselves jolt harder: the share of all stretches as long as a join.

    Parameters
    ----------
    segments : sequence of Motion
        As danced, each at least twelve frames long.
    acceleration : float, m/s^2
        Such as `usual_acceleration`.
    """
    stretches = [
        np.lib.stride_tricks.sliding_window_view(_accelerations(s).max(axis=1), 2 * HALF_WINDOW + 2)
        for s in segments
    ]
    return float((np.concatenate(stretches).max(axis=1) > acceleration).mean())


def _joins(segments: Sequence[Motion]) -> list[int]:
    return [int(frame) for frame in np.cumsum([len(segment) for segment in segments])[:-1]]


def _accelerations(motion: Motion) -> Floats:
    positions = kinematics.centred_positions(motion.skeleton, motion.rotations)
    return np.asarray(np.linalg.norm(np.diff(positions, 2, axis=0), axis=-1) * motion.frame_rate_hz**2)


def _slides(motion: Motion) -> Floats:
    """Give the speed over the floor of each low ball of a foot, NaN where it is not low; (frame - 1, 2)."""
    balls = kinematics.joint_positions(motion)[:, _BALLS]
    speeds = np.linalg.norm(np.diff(balls[..., [0, 2]], axis=0), axis=-1) * motion.frame_rate_hz
    low: Booleans = np.less(balls[..., 1], LOW_M)
    return np.where(low[1:] & low[:-1], speeds, np.nan)


def _mean(slides: Floats) -> float:
    seen = slides[~np.isnan(slides)]
    return float(seen.mean()) if len(seen) else float("nan")


def _multiple(value: float, of: float) -> float:
    return float(value / of) if of else float("nan")


def _energies(motion: Motion) -> Floats:
    positions = kinematics.centred_positions(motion.skeleton, motion.rotations)
    rate = motion.frame_rate_hz
    return np.array(
        [energy.linear_energy(positions, rate).sum(), energy.rotational_energy(motion.rotations, rate).sum()]
    )
