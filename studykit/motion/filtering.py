"""Smoothing of measured movement."""

from __future__ import annotations

import numpy as np

from studykit.core.arrays import Floats


def low_pass(positions: Floats, cutoff_hz: float, frame_rate_hz: float) -> Floats:
    """Take the trembling of a measurement out of joint tracks without delaying them.

    Parameters
    ----------
    positions : ndarray, shape (frame, ...), m
        Evenly sampled, without gaps.
    cutoff_hz : float
        What is faster is taken out; 6 Hz suits people who dance (Winter 2009).
    frame_rate_hz : float
        Frames a second.

    Returns
    -------
    ndarray, shape (frame, ...)
        Second-order Butterworth, run forwards and backwards.
    """
    from scipy.signal import butter, sosfiltfilt

    sections = butter(2, cutoff_hz, fs=frame_rate_hz, output="sos")
    return np.asarray(sosfiltfilt(sections, positions, axis=0), dtype=np.float64)


def without_gaps(times_s: Floats, positions: Floats, grid_s: Floats) -> Floats:
    """Put joint tracks with gaps on an even time grid, each coordinate by straight lines.

    Parameters
    ----------
    times_s : ndarray, shape (frame,), s
        When each frame was taken.
    positions : ndarray, shape (frame, joint, 3), m
        NaN where a joint was not seen; a joint never seen stays NaN.
    grid_s : ndarray, shape (sample,), s
        When positions are wanted.
    """
    filled = np.full((len(grid_s), *positions.shape[1:]), np.nan)
    for joint in range(positions.shape[1]):
        seen = np.isfinite(positions[:, joint]).all(axis=-1)
        if seen.any():
            for axis in range(3):
                filled[:, joint, axis] = np.interp(grid_s, times_s[seen], positions[seen, joint, axis])
    return filled
