"""Known answers of kinematics: pendulums, spinning rods, straight walks."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY, Skeleton

ARM = Skeleton(
    joint_names=("shoulder", "elbow", "wrist"),
    parents=(-1, 0, 1),
    offsets=[[0, 0, 0], [0, -0.3, 0], [0, -0.25, 0]],
    mirror=(0, 1, 2),
)


def test_an_arm_bent_at_the_elbow() -> None:
    half_up = rotation.exp(np.array([[0, 0, np.pi / 2], [0, 0, np.pi / 2], [0, 0, 0]]))
    motion = Motion(
        skeleton=ARM, rotations=half_up[None], root_positions=[[1.0, 1.4, 0.0]], frame_rate_hz=30.0
    )
    # Upper arm to +X, forearm another quarter turn: straight up.
    assert kinematics.joint_positions(motion)[0] == pytest.approx(
        np.array([[1.0, 1.4, 0.0], [1.3, 1.4, 0.0], [1.3, 1.65, 0.0]])
    )


def test_a_rod_spinning_evenly_has_one_speed_everywhere_in_time() -> None:
    rate, spin = 59.94, 2.5
    angles = spin * np.arange(40) / rate
    rotations = rotation.identity(40, 3)
    rotations[:, 0] = rotation.yaw(angles)
    turning = kinematics.angular_speeds(rotations, rate)
    assert turning[:, 0] == pytest.approx(np.full(39, spin), abs=1e-12)
    assert kinematics.angular_speeds(-rotations * np.where(np.arange(40) % 2, 1, -1)[:, None, None], rate)[
        :, 0
    ] == pytest.approx(np.full(39, spin), abs=1e-12)  # a quaternion and its negative are the same turn
    assert np.all(turning[:, 1:] == 0.0)


def test_a_straight_walk_has_its_speed() -> None:
    positions = np.arange(5)[:, None, None] / 30.0 * np.array([0.0, 0.0, 1.2]) + np.ones((5, 24, 3))
    assert kinematics.linear_velocities(positions, 30.0) == pytest.approx(
        np.broadcast_to([0.0, 0.0, 1.2], (4, 24, 3))
    )


def test_a_pendulum_moves_as_fast_as_its_angle_says() -> None:
    rate, length, swing, omega = 2000.0, 0.55, 0.8, 3.0
    times = np.arange(4000) / rate
    rotations = rotation.identity(4000, 3)
    rotations[:, 0] = rotation.exp(swing * np.cos(omega * times)[:, None] * np.array([0.0, 0.0, 1.0]))
    wrist = kinematics.centred_positions(ARM, rotations)[:, 2:]
    speed = np.linalg.norm(kinematics.linear_velocities(wrist, rate)[:, 0], axis=-1)
    middle = times[:-1] + 0.5 / rate
    assert speed == pytest.approx(length * swing * omega * np.abs(np.sin(omega * middle)), abs=1e-5)


def test_smpl_turned_about_a_point_of_its_own() -> None:
    rest = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.identity(1, 24),
        root_positions=[[2.0, 0.9, 0.0]],
        frame_rate_hz=30.0,
    )
    assert kinematics.turned(rest, np.pi / 2).root_positions[0] == pytest.approx([0.0, 0.9, -2.0])
    stays = kinematics.turned(rest, np.pi / 2, about=np.array([2.0, 0.0, 0.0]))
    assert stays.root_positions[0] == pytest.approx([2.0, 0.9, 0.0])
