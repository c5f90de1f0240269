"""Finding frames that no person danced: marker glitches, lost limbs, jumps."""

from __future__ import annotations

from typing import Literal

import numpy as np

from studykit.core.arrays import Booleans, Floats

NoiseRule = Literal["robust", "paper"]

SPEED_LIMIT_M_S = 12.0
"""Faster than the hands and feet of a breakdancer in a flip."""

ACCELERATION_LIMIT_M_S2 = 300.0
"""Harder than any dance step; a marker that jumps 0.35 m in a frame and back."""


def excesses(positions: Floats, root_positions: Floats, frame_rate_hz: float) -> dict[str, Floats]:
    """Give how far each joint of a take goes beyond what each rule allows; above 1 is flagged.

    Parameters
    ----------
    positions : ndarray, shape (frame, joint, 3), m
        Pelvis-centred joint positions at the rate of the library (30 Hz); the pelvis comes first.
    root_positions : ndarray, shape (frame, 3), m
        Where the pelvis is in the room.
    frame_rate_hz : float
        Frames a second.

    Returns
    -------
    dict of str to ndarray, shape (frame, joint)
        "speed": share of 12 m/s. "acceleration": share of 300 m/s2. "root": the larger of both for the way of
        the pelvis through the room. These three are the robust rule. "paper": share of that joint's mean
        acceleration over the take plus two standard deviations, as printed; it flags 10 to 20 % of the frames
        of clean takes.
    """
    speed, acceleration = _speed(positions, frame_rate_hz), _acceleration(positions, frame_rate_hz)
    inner = acceleration[1:-1] if len(positions) > 2 else acceleration
    # A joint that never moves from the pelvis has no spread: rounding is not a glitch.
    usual = np.maximum(inner.mean(axis=0) + 2.0 * inner.std(axis=0), 1e-6)
    root = np.zeros_like(speed)
    way = root_positions[:, None]
    root[:, :1] = np.maximum(
        _speed(way, frame_rate_hz) / SPEED_LIMIT_M_S,
        _acceleration(way, frame_rate_hz) / ACCELERATION_LIMIT_M_S2,
    )
    return {
        "speed": speed / SPEED_LIMIT_M_S,
        "acceleration": acceleration / ACCELERATION_LIMIT_M_S2,
        "root": root,
        "paper": acceleration / usual,
    }


def flagged(excess: dict[str, Floats], rule: NoiseRule) -> Booleans:
    """Give the frames that a noise rule would cut out, shape (frame,); see `excesses`."""
    meant = ("paper",) if rule == "paper" else ("speed", "acceleration", "root")
    return np.asarray(np.any([np.any(excess[name] > 1.0, axis=1) for name in meant], axis=0))


def _speed(positions: Floats, frame_rate_hz: float) -> Floats:
    speed = np.zeros(positions.shape[:2])
    speed[1:] = np.linalg.norm(np.diff(positions, axis=0), axis=-1) * frame_rate_hz
    return speed


def _acceleration(positions: Floats, frame_rate_hz: float) -> Floats:
    acceleration = np.zeros(positions.shape[:2])
    acceleration[1:-1] = np.linalg.norm(np.diff(positions, 2, axis=0), axis=-1) * frame_rate_hz**2
    return acceleration


def clean_runs(bad: Booleans) -> list[tuple[int, int]]:
    """Give the stretches of frames without a flag, as pairs of first frame and frame after the last.

    Examples
    --------
    >>> clean_runs(np.array([False, False, True, False]))
    [(0, 2), (3, 4)]
    """
    edges = np.flatnonzero(np.diff(np.concatenate(([True], bad, [True])).astype(np.int8)))
    return [(int(start), int(stop)) for start, stop in zip(edges[::2], edges[1::2], strict=True)]
