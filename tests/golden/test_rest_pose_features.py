"""The 25 shapes of the neutral rest pose, worked out from the joints of the neutral mean body."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import features, kinematics, rotation
from studykit.motion.skeleton import NEUTRAL_BODY

# Angles in rad, distances as shares of 1.2902 m (pelvis to neck, thigh and shank).
REST = [
    3.010, 3.038, 2.983, 2.980, 1.534, 1.523, 0.135, 0.144, 1.885, 1.824, 0.084, -0.032, -0.052,
    -0.040, -0.017, -0.039, 1.058, 0.635, 0.633, 0.140, 0.043, 0.038, -0.097, -0.101, 1.160,
]  # fmt: skip


@pytest.mark.parametrize("yaw_rad", [0.0, 2.1])
def test_the_rest_pose_has_the_shapes_of_the_mean_body(yaw_rad) -> None:
    rotations = rotation.identity(1, 24)
    rotations[:, 0] = rotation.yaw(yaw_rad)
    shapes = features.geometric(kinematics.centred_positions(NEUTRAL_BODY, rotations))[0]
    assert shapes == pytest.approx(np.array(REST), abs=2e-3)
