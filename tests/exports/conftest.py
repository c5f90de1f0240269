"""A lively movement, and a dance of it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY


@pytest.fixture(scope="session")
def motion() -> Motion:
    """Give 2 s in which every joint turns about every axis and the root goes round and round."""
    rng = np.random.default_rng(11)
    frames = np.arange(60)[:, None, None]
    swing = rng.uniform(0.2, 0.7, size=(24, 3)) * np.sin(
        rng.uniform(0.05, 0.2, size=(24, 3)) * frames + rng.uniform(0.0, 6.0, size=(24, 3))
    )
    rotations = rotation.exp(swing)
    rotations[:, 0] = rotation.multiply(rotation.yaw(0.25 * frames[:, 0, 0]), rotations[:, 0])
    rotations[::7] *= -1.0  # the same turns, written the other way
    way = np.array([0.4, 0.95, -0.3]) + np.cumsum(rng.normal(scale=0.01, size=(60, 3)), axis=0)
    return Motion(skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=way, frame_rate_hz=30.0)


@pytest.fixture(scope="session")
def joints(motion: Motion) -> NDArray[np.float64]:
    """Give where its joints are, shape (frame, joint, 3), m."""
    return kinematics.joint_positions(motion)
