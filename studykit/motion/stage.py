"""Keeping a dance within the space that there is to dance in."""

from __future__ import annotations

import numpy as np

from studykit.core.arrays import Booleans, Floats

_STANDING = 100.0  # how much sliding matters while a foot stands, against while none does
_INERTIA = 30.0  # frames^2: how much changes of the added speed matter
_HELD = 1e7
_ROUNDS = 400


def excess_m(root_positions: Floats, stage_m: tuple[float, float]) -> float:
    """Give how far a way leads out of the stage, at most.

    Parameters
    ----------
    root_positions : ndarray, shape (frame, 3), m
        Where the root is.
    stage_m : (float, float), m
        Width (along x) and depth (along z) of a rectangle about the place of the first frame.
    """
    away = np.abs(root_positions[:, [0, 2]] - root_positions[0, [0, 2]])
    return float(max(0.0, np.max(away - 0.5 * np.array(stage_m))))


def kept_on(root_positions: Floats, stands: Booleans, stage_m: tuple[float, float]) -> Floats:
    """Bend a way so that it stays on the stage, shape (frame, 3).

    The body keeps facing as it did, so what its joints do about the pelvis stays the same. The way gives in
    while no foot stands, where it can: steps become shorter or longer.

    Parameters
    ----------
    root_positions : ndarray, shape (frame, 3), m
        Where the root is.
    stands : ndarray of bool, shape (frame,)
        When a foot stands on the floor.
    stage_m : (float, float), m
        Width (along x) and depth (along z) of a rectangle about the place of the first frame.

    Notes
    -----
    Least squares of the added speed and its changes with bounds on the place, by a primal-dual active set
    (Hintermüller, Ito & Kunisch 2002), for each axis alone.
    """
    bent = np.array(root_positions)
    if excess_m(root_positions, stage_m) > 0.0:
        for axis, size in ((0, stage_m[0]), (2, stage_m[1])):
            way = root_positions[:, axis] - root_positions[0, axis]
            bent[:, axis] += _offset(way, 0.5 * size, stands)
    return bent


def _offset(way: Floats, reach: float, stands: Booleans) -> Floats:
    """Give what to add to a way from zero so that it stays within +-reach, shape (frame,)."""
    from scipy.linalg import solveh_banded

    matrix = _bands(stands)
    matrix[0, 0] += _HELD  # the first frame stays
    bound = np.zeros(len(way))  # -1 where the way is held at its lower bound, 1 at the upper one
    offset = np.zeros(len(way))
    for number in range(_ROUNDS):
        at_bound = bound != 0.0
        force = _HELD * np.where(at_bound, bound * reach - way, 0.0)
        held = matrix.copy()
        held[0] += _HELD * at_bound
        offset = solveh_banded(held, force, lower=True)
        # Held frames stay held while the bound pushes inwards, free ones are held once they are outside.
        # Should that go in circles, none is let go any more: then it ends, each frame inside.
        push = np.where(at_bound, offset + way - bound * reach, 0.0)
        outside = np.sign(offset + way) * (np.abs(offset + way) > reach + 1e-6)
        is_pushed = (push * bound > 0.0) | (number > _ROUNDS // 2)
        new = np.where(at_bound, bound * is_pushed, outside)
        if np.array_equal(new, bound):
            break
        bound = new
    return np.asarray(offset)


def _bands(stands: Booleans) -> Floats:
    """Give the lower bands of sum c (d' - d)^2 + inertia (d'' - 2 d' + d)^2, shape (3, frame)."""
    frames = len(stands)
    slide = np.where(stands[1:] & stands[:-1], _STANDING, 1.0)
    bands = np.zeros((3, frames))
    bands[0, :-1] += slide
    bands[0, 1:] += slide
    bands[1, :-1] -= slide
    for shift, weight in enumerate((1.0, 4.0, 1.0)):
        bands[0, shift : frames - 2 + shift] += _INERTIA * weight
    bands[1, : frames - 2] -= 2.0 * _INERTIA
    bands[1, 1 : frames - 1] -= 2.0 * _INERTIA
    bands[2, : frames - 2] += _INERTIA
    return bands
