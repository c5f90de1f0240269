"""How hard a movement is: kinetic energy of joints that travel and turn (Eq. 7-8, 10-11)."""

from __future__ import annotations

import numpy as np

from studykit.core.arrays import Floats
from studykit.motion import body
from studykit.motion.kinematics import angular_speeds, linear_velocities


def linear_energy(positions: Floats, frame_rate_hz: float) -> Floats:
    """Give how much each joint's travelling asks of the dancer, summed over all poses (Eq. 8).

    Parameters
    ----------
    positions : ndarray, shape (frame, 24, 3), m
        Pelvis-centred joint positions.
    frame_rate_hz : float
        Frames a second.

    Returns
    -------
    ndarray, shape (24,), J per kg of body mass
        Their sum is the sum of E_L over the poses. The first pose, which has no predecessor, counts nothing.

    Examples
    --------
    A body whose joints all move at 1 m/s for 30 poses: 30 x 1/48 x 1.

    >>> steps = np.arange(31.0)[:, None, None] / 30.0 * np.array([1.0, 0.0, 0.0])
    >>> round(float(linear_energy(steps + np.zeros((31, 24, 3)), 30.0).sum()), 6)
    0.625
    """
    return np.asarray(linear_energy_steps(positions, frame_rate_hz).sum(axis=0))


def linear_energy_steps(positions: Floats, frame_rate_hz: float) -> Floats:
    """Give the summands of `linear_energy`, one row for each step, shape (frame - 1, 24)."""
    squares = np.sum(linear_velocities(positions, frame_rate_hz) ** 2, axis=-1)
    return np.asarray(body.segments().masses * squares / (2.0 * positions.shape[1]))


def rotational_energy(
    rotations: Floats, frame_rate_hz: float, *, joint_weights: Floats | None = None
) -> Floats:
    """Give how much each joint's turning asks of the dancer, summed over all poses (Eq. 11).

    Parameters
    ----------
    rotations : ndarray, shape (frame, 24, 4)
        Parent-relative unit quaternions.
    frame_rate_hz : float
        Frames a second.
    joint_weights : ndarray, shape (24,), optional
        The paper's mask a_j, 0 to 1; all 1 if not given.

    Returns
    -------
    ndarray, shape (24,), J per kg of body mass
        Their sum is the sum of E_R over the poses.
    """
    energies = rotational_energy_steps(rotations, frame_rate_hz).sum(axis=0)
    return np.asarray(energies if joint_weights is None else energies * joint_weights)


def rotational_energy_steps(rotations: Floats, frame_rate_hz: float) -> Floats:
    """Give the summands of `rotational_energy`: one row for each step, shape (frame - 1, 24)."""
    squares = angular_speeds(rotations, frame_rate_hz) ** 2
    return np.asarray(body.segments().inertias * squares / (2.0 * rotations.shape[1]))
