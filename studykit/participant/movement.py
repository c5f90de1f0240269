"""How a simulated person dances: late, not quite as shown, and in a body of their own."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from studykit.core.arrays import Floats
from studykit.participant.person import Person

_GUIDE_HEIGHT_M = 1.70
_SHORTEST_DELAY_S, _LONGEST_DELAY_S = 0.1, 0.3
_DELAY_DRIFT_S, _DELAY_DRIFT_TIME_S = 0.02, 8.0

# Hands and feet stray further from the guide than the trunk; SMPL's order of 24 joints, trunk to hands.
_SHARES_24 = np.repeat(
    (0.3, 0.35, 0.9, 0.4, 1.2, 0.45, 1.4, 0.5, 0.8, 0.6, 1.3, 1.9, 2.1),
    (1, 3, 2, 1, 2, 1, 2, 3, 1, 2, 2, 2, 2),
)


def perform(
    guide: Floats, person: Person, error_m: float, rng: np.random.Generator, *, frame_rate_hz: float = 30.0
) -> Floats:
    """Dance along with a guide.

    Parameters
    ----------
    guide : ndarray, shape (frame, joint, 3), m
        What is shown; the floor lies at a height of 0.
    person : Person
        Who dances.
    error_m : float
        Mean distance of the joints from where they should be, m; it does not depend on the dance.
    rng : numpy.random.Generator
        Errors and delays.
    frame_rate_hz : float, optional
        Frames a second.

    Returns
    -------
    ndarray, shape (frame, joint, 3), m
        What is danced, at the times of the guide's frames.
    """
    copied = copy(own_size(guide, person), error_m, rng, frame_rate_hz=frame_rate_hz)
    return delayed(
        copied, delays_s(len(guide), rng, frame_rate_hz=frame_rate_hz), frame_rate_hz=frame_rate_hz
    )


def own_size(guide: Floats, person: Person) -> Floats:
    """Scale a movement from the guide's body to that of a person.

    Parameters
    ----------
    guide : ndarray, shape (frame, joint, 3), m
        The movement of a body of 1.70 m.
    person : Person
        Whose height counts.

    Returns
    -------
    ndarray, shape (frame, joint, 3), m
    """
    return guide * (person.height_m / _GUIDE_HEIGHT_M)


def copy(intended: Floats, error_m: float, rng: np.random.Generator, *, frame_rate_hz: float) -> Floats:
    """Miss a movement by a given distance, smoothly, each joint on its own.

    Parameters
    ----------
    intended : ndarray, shape (frame, joint, 3), m
        Where the joints should be.
    error_m : float
        Mean distance over frames and joints, m; the result has it exactly.
    rng : numpy.random.Generator
        The errors. Their correlation falls to 1/e within 0.5 to 1 s.
    frame_rate_hz : float
        Frames a second.

    Returns
    -------
    ndarray, shape (frame, joint, 3), m
    """
    frames, joints, _ = intended.shape
    shares = _SHARES_24 if joints == len(_SHARES_24) else np.ones(joints)
    error = np.stack(
        [_smooth_noise((frames, 3), rng.uniform(0.5, 1.0) * frame_rate_hz, rng) * share for share in shares],
        axis=1,
    )
    return np.asarray(intended + error * (error_m / np.linalg.norm(error, axis=-1).mean()))


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


def delayed(positions: Floats, delay_s: Floats, *, frame_rate_hz: float) -> Floats:
    """Show a movement late; before it begins, its first pose is held.

    Parameters
    ----------
    positions : ndarray, shape (frame, joint, 3), m
        The movement.
    delay_s : ndarray, shape (frame,), s
        Delay of each frame, 0 or more.
    frame_rate_hz : float
        Frames a second.

    Returns
    -------
    ndarray, shape (frame, joint, 3), m
    """
    last = len(positions) - 1
    at = np.clip(np.arange(last + 1) - delay_s * frame_rate_hz, 0.0, last)
    before = np.floor(at).astype(np.int64)
    share = (at - before)[:, None, None]
    return np.asarray((1.0 - share) * positions[before] + share * positions[np.minimum(before + 1, last)])


def _smooth_noise(shape: tuple[int, int], correlation_frames: float, rng: np.random.Generator) -> Floats:
    """Draw noise of unit variance whose correlation falls to 1/e within some frames."""
    # White noise smoothed by a Gaussian of width s has the correlation exp(-lag^2 / 4 s^2).
    width = max(correlation_frames / 2.0, 1e-3)
    margin = int(np.ceil(4.0 * width))
    white = rng.normal(size=(shape[0] + 2 * margin, shape[1]))
    smooth = gaussian_filter1d(white, width, axis=0, mode="wrap")[margin : margin + shape[0]]
    return np.asarray(smooth * np.sqrt(2.0 * width * np.sqrt(np.pi)))
