"""How smoothly somebody moves."""

from __future__ import annotations

import numpy as np

from studykit.core.arrays import Floats


def squared_jerk(positions: Floats, frame_rate_hz: float) -> Floats:
    """Give the mean over time of the squared jerk of points, shape (point,), m^2/s^6; see below."""
    jerks = np.diff(positions, n=3, axis=0) * frame_rate_hz**3
    return np.asarray(np.sum(jerks**2, axis=-1).mean(axis=0))


def log_dimensionless_jerk(
    positions: Floats, frame_rate_hz: float, *, trembling: Floats | float = 0.0
) -> Floats:
    """Tell how smoothly points move, whatever the size and the duration of the movement.

    Parameters
    ----------
    positions : ndarray, shape (frame, point, 3), m
        Without gaps.
    frame_rate_hz : float
        Frames a second.
    trembling : ndarray, shape (point,), m^2/s^6, optional
        The `squared_jerk` that the camera sees in somebody who stands still; it is taken off.

    Returns
    -------
    ndarray, shape (point,)
        Nearer to 0 is smoother. NaN for a point without jerk: one that keeps its speed, stands still, or
        does not move more than the camera trembles.

    Notes
    -----
    -ln(T^3 / v^2 x integral of |jerk|^2), with T the duration and v the highest speed: the LDLJ of
    Balasubramanian et al. 2015 (doi 10.1186/s12984-015-0090-9), with the jerk of the way itself, so that
    turning round counts; on a straight way forwards it is the same as theirs. It falls with duration (by
    4 ln 2 in a movement twice as long, of twice as many equal parts): only movements of one length compare.

    Examples
    --------
    One swing of a pendulum, x = cos(2 pi t / T), has -ln((2 pi)^4 / 2) = -6.66.

    >>> swing = np.cos(np.linspace(0.0, 2.0 * np.pi, 601))[:, None, None] * np.array([1.0, 0.0, 0.0])
    >>> log_dimensionless_jerk(swing, 100.0).round(2).tolist()
    [-6.66]
    """
    velocities = np.gradient(positions, 1.0 / frame_rate_hz, axis=0)
    peak_squared = np.sum(velocities**2, axis=-1).max(axis=0)
    duration_s = (len(positions) - 1) / frame_rate_hz
    jerk = squared_jerk(positions, frame_rate_hz) - trembling
    with np.errstate(divide="ignore", invalid="ignore"):
        measure = -np.log(duration_s**4 / peak_squared * jerk)
    return np.where(np.isfinite(measure), measure, np.nan)
