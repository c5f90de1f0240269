"""Depth cameras: one picture of the body."""

from __future__ import annotations

from dataclasses import dataclass

from studykit.core.arrays import Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CameraFrame:
    """Where a camera saw the joints at one moment.

    Parameters
    ----------
    time_s : float
        When the picture was taken, s from the start of the recording.
    positions : ndarray, shape (joint, 3), m
        Right-handed axes, Y up; NaN where a joint was not seen.
    confidence : ndarray, shape (joint,)
        0 (not seen) to 1 (certain).
    """

    time_s: float
    positions: Floats
    confidence: Floats
