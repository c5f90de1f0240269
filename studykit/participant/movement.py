"""How a simulated person misses a movement: late, and with joints that are turned a little wrong."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import gaussian_filter1d

from studykit.core.arrays import Floats

LARGEST_TURN_RAD = 1.0
"""Root mean square of the wrong turns of a shoulder, rad; who errs more does not copy a dance any more."""

LARGEST_ERROR_M = 0.135
"""Mean distance from the guide that people of all sizes reach with such turns, m."""
LEAST_ERROR_M = 0.01
"""Nobody copies a dance more exactly than this, m."""

_SHORTEST_DELAY_S, _LONGEST_DELAY_S = 0.1, 0.3
_DELAY_DRIFT_S, _DELAY_DRIFT_TIME_S = 0.02, 8.0
_CORRELATION_S = (0.5, 1.0)

# Wrong turns of each joint as shares of a shoulder's. Arms and legs stray, the trunk hardly does; nothing
# hangs on hands and feet.
_SHARES = {
    "pelvis": 0.08,
    "hip": 0.65,
    "spine1": 0.12,
    "knee": 0.75,
    "spine2": 0.12,
    "ankle": 0.4,
    "spine3": 0.12,
    "foot": 0.0,
    "neck": 0.3,
    "collar": 0.15,
    "head": 0.3,
    "shoulder": 1.0,
    "elbow": 1.0,
    "wrist": 0.4,
    "hand": 0.0,
}


def wrong_turns(
    joint_names: Sequence[str], frames: int, rng: np.random.Generator, *, frame_rate_hz: float
) -> Floats:
    """Draw how every joint is turned wrong: smoothly, each on its own.

    Parameters
    ----------
    joint_names : sequence of str
        SMPL's names of the joints.
    frames : int
        Number of frames.
    rng : numpy.random.Generator
        The errors. Their correlation falls to 1/e within 0.5 to 1 s.
    frame_rate_hz : float
        Frames a second.

    Returns
    -------
    ndarray, shape (frame, joint, 3), rad
        Rotation vectors in each joint's own axes, 1 rad (root mean square) at the shoulders, less at the
        other joints: to be made smaller until a dancer is as far from the guide as wanted.
    """
    turns = np.zeros((frames, len(joint_names), 3))
    shares = [_SHARES[name.split("_")[-1]] for name in joint_names]
    for joint in np.flatnonzero(shares):
        noise = _smooth_noise((frames, 3), rng.uniform(*_CORRELATION_S) * frame_rate_hz, rng)
        rms = np.sqrt(np.mean(np.sum(noise**2, axis=-1)))
        turns[:, joint] = shares[joint] / rms * noise
    return turns


def delays_s(frames: int, rng: np.random.Generator, *, frame_rate_hz: float) -> Floats:
    """Draw how late a dancer follows: 0.1 to 0.3 s, drifting slowly.

    Parameters
    ----------
    frames : int
        Number of frames.
    rng : numpy.random.Generator
        The mean delay and its drift.
    frame_rate_hz : float
        Frames a second.

    Returns
    -------
    ndarray, shape (frame,), s
    """
    drift = _smooth_noise((frames, 1), _DELAY_DRIFT_TIME_S * frame_rate_hz, rng)[:, 0]
    delays = rng.uniform(_SHORTEST_DELAY_S, _LONGEST_DELAY_S) + _DELAY_DRIFT_S * drift
    return np.clip(delays, _SHORTEST_DELAY_S, _LONGEST_DELAY_S)


def _smooth_noise(shape: tuple[int, int], correlation_frames: float, rng: np.random.Generator) -> Floats:
    """Draw noise of unit variance whose correlation falls to 1/e within some frames."""
    # White noise smoothed by a Gaussian of width s has the correlation exp(-lag^2 / 4 s^2).
    width = max(correlation_frames / 2.0, 1e-3)
    margin = int(np.ceil(4.0 * width))
    white = rng.normal(size=(shape[0] + 2 * margin, shape[1]))
    smooth = gaussian_filter1d(white, width, axis=0, mode="wrap")[margin : margin + shape[0]]
    return np.asarray(smooth * np.sqrt(2.0 * width * np.sqrt(np.pi)))
