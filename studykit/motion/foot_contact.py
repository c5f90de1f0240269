"""Feet that stand on the floor: when they do, and how they keep standing where segments meet."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from studykit.core.arrays import Booleans, Floats
from studykit.motion.skeleton import NEUTRAL_BODY

POINTS = tuple(NEUTRAL_BODY.index(name) for name in ("left_ankle", "right_ankle", "left_foot", "right_foot"))
"""What touches the floor: ankles (for the heels) and the balls of the feet, left and right by turns."""

HEIGHT_M = 0.05
"""The ball of a foot that stands is lower than this, an ankle by as much more as it is higher at rest."""

SPEED_M_S = 0.3
"""A foot that stands is slower than this: what marker sets make of a foot at rest."""

_SHORTEST_FRAMES = 3
_HALF_STEP = 7  # frames before and after the join in which a foot that must step does so
_FAR_M = 0.15  # what the legs can bring back without a jerk
_LIFT, _HIGHEST_LIFT_M = 0.3, 0.08  # of the step's length
_PELVIS_INERTIA = 4.0  # how much changes of the pelvis's speed matter, against a foot that slides
_FREE_LEG = 0.05  # how much the other foot's sliding matters while the one that leads stands
_HELD = 1e6


def contacts(positions: Floats, frame_rate_hz: float) -> Booleans:
    """Tell when heels and balls of the feet stand on the floor.

    Parameters
    ----------
    positions : ndarray, shape (frame, 24, 3), m
        In the room, with the floor at height zero.
    frame_rate_hz : float
        Frames a second.

    Returns
    -------
    ndarray of bool, shape (frame, 4)
        By `POINTS`. Three frames at least, low, and slow to the frames before and after.
    """
    points = positions[:, POINTS]
    ankle_height_m = -NEUTRAL_BODY.offsets[POINTS[2], 1]
    limits = HEIGHT_M + ankle_height_m * np.array([1.0, 1.0, 0.0, 0.0])
    step = np.linalg.norm(np.diff(points, axis=0), axis=-1) * frame_rate_hz
    speed = np.maximum(np.concatenate((step[:1], step)), np.concatenate((step, step[-1:])))
    stands: Booleans = np.logical_and(points[..., 1] < limits, speed < SPEED_M_S)
    for point in range(len(POINTS)):
        for start, stop in runs(stands[:, point]):
            if stop - start < _SHORTEST_FRAMES:
                stands[start:stop, point] = False
    return stands


def runs(flags: Booleans) -> Iterator[tuple[int, int]]:
    """Go through the stretches that are true: first frame, and frame after the last.

    Examples
    --------
    >>> list(runs(np.array([True, True, False, True])))
    [(0, 2), (3, 4)]
    """
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(np.int8), [0]))))
    return zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


def root_steps(points: Floats, stands: Booleans) -> Floats:
    """Give the steps that the root should take besides, so that standing feet slide as little as they can.

    Parameters
    ----------
    points : ndarray, shape (frame, 4, 3), m
        Where heels and balls are in a window about a join.
    stands : ndarray of bool, shape (frame, 4)
        When they stand.

    Returns
    -------
    ndarray, shape (frame - 1, 3), m
        Horizontal; zero from the first frame to the second and from the last but one to the last.

    Notes
    -----
    Least squares: feet that stand do not slide, the root's speed changes smoothly. The foot that stands
    longest leads; if it stands all through the window, it ends where it began, whatever the other one does.
    """
    count = len(points) - 3
    slides = np.diff(points, axis=0)[1:-1] * np.array([1.0, 0.0, 1.0])
    both = (stands[1:] & stands[:-1])[1:-1]
    leader = int(np.argmax(both.sum(axis=0) + 0.5 * (np.arange(4) >= 2)))
    weights = both * np.where(both[:, [leader]], _FREE_LEG, 1.0)
    weights[:, leader] = both[:, leader]
    change = np.diff(np.eye(count + 2), axis=0)[:, 1:-1]
    normal = np.diag(weights.sum(axis=1) + 1e-3) + _PELVIS_INERTIA * change.T @ change
    wanted = -np.einsum("fp,fpc->fc", weights, slides)
    if both[:, leader].all():
        normal += _HELD
        wanted -= _HELD * slides[:, leader].sum(axis=0)
    return np.concatenate((np.zeros((1, 3)), np.linalg.solve(normal, wanted), np.zeros((1, 3))))


class Footholds(NamedTuple):
    """Where standing feet are held in a window.

    Attributes
    ----------
    places : ndarray, shape (frame, 4, 3), m
        Where each heel and ball should be; where it is, if it is not held.
    is_held : ndarray of bool, shape (frame, 4)
        Whether it is.
    """

    places: Floats
    is_held: Booleans


def footholds(points: Floats, stands: Booleans) -> Footholds:
    """Give where feet that stand within a window are held.

    A foot that stands already when the window begins, or still when it ends, stays where it is outside the
    window. One that does both takes a step at the join, the higher the longer, if that is in two places. A
    foot that the rest of the body carries away is let go.

    Parameters
    ----------
    points : ndarray, shape (frame, 4, 3), m
        Where heels and balls are; the join is in the middle, and the two frames at either end do not move.
    stands : ndarray of bool, shape (frame, 4)
        When they stand.
    """
    places, is_held = np.array(points), np.zeros(stands.shape, dtype=bool)
    last = len(points) - 2
    for point in range(stands.shape[1]):
        first, final = points[1, point], points[last, point]
        for start, stop in runs(stands[:, point]):
            stood, stands_on = start <= 1, stop > last
            if stood and stands_on:
                places[:, point] = _step(first, final, len(points))
            elif stood or stands_on:
                places[start:stop, point] = first if stood else final
            else:
                places[start:stop, point] = points[start:stop, point].mean(axis=0)
            is_held[start:stop, point] = True
    is_held &= np.linalg.norm(places - points, axis=-1) < _FAR_M
    return Footholds(places, is_held)


def _step(first: Floats, final: Floats, frames: int) -> Floats:
    """Stand in one place, step about the middle frame, stand in the other."""
    share = np.clip((np.arange(frames) + 0.5 - frames / 2) / (2 * _HALF_STEP) + 0.5, 0.0, 1.0)[:, None]
    way = share**2 * (3.0 - 2.0 * share)
    length = float(np.linalg.norm(final - first))
    lift = min(_LIFT * length, _HIGHEST_LIFT_M) * 16.0 * share**2 * (1.0 - share) ** 2
    return np.asarray(first + way * (final - first) + lift * np.array([0.0, 1.0, 0.0]))
