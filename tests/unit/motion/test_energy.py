"""Energies of movements whose energy is known on paper."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import body, energy, kinematics, rotation
from studykit.motion.skeleton import NEUTRAL_BODY

ELBOW = NEUTRAL_BODY.index("right_elbow")
FRAMES = 120


def arm_turning(angles: np.ndarray, axis=(0.0, 0.0, 1.0)) -> np.ndarray:
    """Give rotations of a body that moves nothing but its right forearm."""
    rotations = rotation.identity(len(angles), 24)
    rotations[:, ELBOW] = rotation.exp(angles[:, None] * np.array(axis))
    return rotations


def test_a_forearm_that_spins_evenly() -> None:
    spin, rate = 3.0, 30.0
    rotations = arm_turning(spin * np.arange(FRAMES) / rate)
    segments = body.segments()
    # E = m (k L)^2 w^2 / (2 x 24), once for each of the 119 steps between 120 poses.
    expected = np.zeros(24)
    expected[ELBOW] = (
        segments.masses[ELBOW]
        * (segments.gyration_radii[ELBOW] * segments.lengths[ELBOW]) ** 2
        * spin**2
        * (FRAMES - 1)
        / (2 * 24)
    )
    assert energy.rotational_energy(rotations, rate) == pytest.approx(expected, rel=1e-9, abs=1e-18)


def test_what_hangs_on_a_spinning_forearm_travels_on_circles() -> None:
    spin, rate = 3.0, 30.0
    rotations = arm_turning(spin * np.arange(FRAMES) / rate)
    positions = kinematics.centred_positions(NEUTRAL_BODY, rotations)
    expected = np.zeros(24)
    for name in ("right_wrist", "right_hand"):
        joint = NEUTRAL_BODY.index(name)
        radius = np.linalg.norm((positions[0, joint] - positions[0, ELBOW])[:2])  # from an axis along Z
        speed = 2.0 * radius * np.sin(0.5 * spin / rate) * rate  # along the chord
        expected[joint] = body.segments().masses[joint] * speed**2 * (FRAMES - 1) / (2 * 24)
    assert energy.linear_energy(positions, rate) == pytest.approx(expected, rel=1e-6, abs=1e-15)


@pytest.mark.parametrize("speed", [0.5, 1.4, 3.0])
def test_all_joints_at_walking_speed(speed) -> None:
    way = speed * np.arange(FRAMES)[:, None, None] / 30.0 * np.array([0.6, 0.0, 0.8])
    energies = energy.linear_energy(way + np.zeros((FRAMES, 24, 3)), 30.0)
    assert energies == pytest.approx(body.segments().masses * speed**2 * (FRAMES - 1) / 48.0, rel=1e-6)
    assert energies.sum() == pytest.approx(speed**2 * (FRAMES - 1) / 48.0, rel=1e-6)


def test_a_pendulum_has_half_of_its_greatest_energy_on_average() -> None:
    rate, swing, omega, periods = 4000.0, 0.9, 2.0 * np.pi, 3
    times = np.arange(int(periods * rate) + 1) / rate  # whole periods: 1 Hz
    rotations = arm_turning(swing * np.cos(omega * times), axis=(0.0, 0.6, 0.8))
    mean = energy.rotational_energy(rotations, rate).sum() / (len(times) - 1)
    expected = body.segments().inertias[ELBOW] * (swing * omega) ** 2 / 2.0 / 48.0
    assert mean == pytest.approx(expected, rel=1e-6)


def test_120_poses_have_119_steps() -> None:
    still = np.zeros((FRAMES, 24, 3))
    jumped = still.copy()
    jumped[60:] += [0.1, 0.0, 0.0]
    assert energy.linear_energy(jumped, 30.0).sum() == pytest.approx(3.0**2 / 48.0)
    assert energy.linear_energy(still[:1], 30.0).sum() == 0.0
    assert energy.rotational_energy(rotation.identity(1, 24), 30.0).sum() == 0.0


def test_the_mask_scales_each_joint() -> None:
    rng = np.random.default_rng(4)
    rotations = rotation.exp(np.cumsum(rng.normal(scale=0.02, size=(40, 24, 3)), axis=0))
    whole = energy.rotational_energy(rotations, 30.0)
    mask = np.ones(24)
    mask[[ELBOW, 17]] = 0.0, 0.25
    spared = energy.rotational_energy(rotations, 30.0, joint_weights=mask)
    assert spared == pytest.approx(whole * mask, rel=1e-12)
    assert spared[ELBOW] == 0.0 < whole[ELBOW]


def test_a_frame_rate_twice_too_high_would_be_noticed() -> None:
    rotations = arm_turning(np.sin(np.arange(FRAMES) / 10.0))
    positions = kinematics.centred_positions(NEUTRAL_BODY, rotations)
    for measured in (
        lambda rate: energy.linear_energy(positions, rate).sum(),
        lambda rate: energy.rotational_energy(rotations, rate).sum(),
    ):
        assert measured(120.0) == pytest.approx(4.0 * measured(60.0), rel=1e-12)
