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


def flagged(positions: Floats, frame_rate_hz: float, rule: NoiseRule) -> dict[str, Booleans]:
    """Mark the frames of a take that look wrong, with the reason.

    Parameters
    ----------
    positions : ndarray, shape (frame, joint, 3), m
        Pelvis-centred joint positions at the rate of the library (30 Hz).
    frame_rate_hz : float
        Frames a second.
    rule : {"robust", "paper"}
        "robust": a joint over 12 m/s, or over 300 m/s2. "paper": an acceleration more than two standard
        deviations above that joint's mean over the take, as printed; it flags 10 to 20 % of the frames of
        clean takes.

    Returns
    -------
    dict of str to ndarray, shape (frame,)
        The frames flagged by each criterion of the rule.
    """
    frames = len(positions)
    speed = np.zeros((frames, positions.shape[1]))
    speed[1:] = np.linalg.norm(np.diff(positions, axis=0), axis=-1) * frame_rate_hz
    acceleration = np.zeros_like(speed)
    acceleration[1:-1] = np.linalg.norm(np.diff(positions, 2, axis=0), axis=-1) * frame_rate_hz**2
    if rule == "robust":
        return {
            "speed": np.any(speed > SPEED_LIMIT_M_S, axis=1),
            "acceleration": np.any(acceleration > ACCELERATION_LIMIT_M_S2, axis=1),
        }
    measured = acceleration[1:-1] if frames > 2 else acceleration
    limit = measured.mean(axis=0) + 2.0 * measured.std(axis=0)
    # A joint that never moves from the pelvis has no spread: rounding is not a glitch.
    return {"paper": np.any(acceleration > np.maximum(limit, 1e-6), axis=1)}


def clean_runs(bad: Booleans) -> list[tuple[int, int]]:
    """Give the stretches of frames without a flag, as pairs of first frame and frame after the last.

    Examples
    --------
    >>> clean_runs(np.array([False, False, True, False]))
    [(0, 2), (3, 4)]
    """
    edges = np.flatnonzero(np.diff(np.concatenate(([True], bad, [True])).astype(np.int8)))
    return [(int(start), int(stop)) for start, stop in zip(edges[::2], edges[1::2], strict=True)]
