"""Dancer and guide face the same way: found from the whole dance, not from its first second."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.analysis.common_body import same_front
from studykit.analysis.dynamic_time_warping import align, common_space
from studykit.core.arrays import Floats
from studykit.motion import rotation
from studykit.motion.kinematics import joint_positions
from studykit.motion.motion import Motion
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY

FRAMES, BAND, DELAY = 240, 30, 9


def dance(*, turned_rad: float) -> Floats:
    """Arms that swing, by a body that first turns by an angle within its first second."""
    times = np.arange(FRAMES) / 30.0
    vectors = np.zeros((FRAMES, 24, 3))
    vectors[:, NEUTRAL_BODY.index("left_shoulder"), 2] = 0.8 * np.sin(2.0 * times)
    vectors[:, NEUTRAL_BODY.index("right_shoulder"), 2] = 0.6 * np.cos(3.0 * times)
    vectors[:, 0, 1] = turned_rad * np.clip(times, 0.0, 1.0)
    motion = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.exp(vectors),
        root_positions=np.zeros((FRAMES, 3)),
        frame_rate_hz=30.0,
    )
    return joint_positions(motion)


def late(positions: Floats) -> Floats:
    """The same dance, a little late, by somebody who stands turned to the camera by half a radian."""
    waited = np.concatenate((np.repeat(positions[:1], DELAY, axis=0), positions[:-DELAY]))
    return rotation.rotate(rotation.yaw(0.5), waited)


def both(turned_rad: float) -> tuple[Floats, Floats]:
    guide = dance(turned_rad=turned_rad)
    return common_space(guide, JOINT_NAMES), common_space(late(guide), JOINT_NAMES)


def test_a_turn_at_the_beginning_costs_a_late_dancer_nothing() -> None:
    still, turning = (
        align(guide, same_front(guide, danced, BAND), BAND).distance_m
        for guide, danced in map(both, (0.0, 2.0))
    )
    assert still < 0.005
    assert turning < 0.015


def test_the_first_second_alone_would_be_a_wrong_front() -> None:
    guide, danced = both(2.0)
    assert align(guide, danced, BAND).distance_m > 0.05


@pytest.mark.parametrize("angle", [-3.0, -0.4, 0.0, 1.2])
def test_any_front_is_found_again(angle: float) -> None:
    guide, _ = both(1.0)
    found = same_front(guide, rotation.rotate(rotation.yaw(angle), guide), BAND)
    np.testing.assert_allclose(found, guide, atol=1e-9)


def test_what_was_not_seen_stays_unseen_and_changes_nothing() -> None:
    guide, danced = both(1.0)
    danced[:40], danced[100:130, 3] = np.nan, np.nan
    found = same_front(guide, rotation.rotate(rotation.yaw(0.7), danced), BAND)
    np.testing.assert_allclose(found, same_front(guide, danced, BAND), atol=1e-9)
    np.testing.assert_array_equal(np.isnan(found), np.isnan(danced))


def test_somebody_seen_for_a_moment_only_is_turned_by_what_was_seen() -> None:
    guide, _ = both(1.0)
    danced = np.full_like(guide, np.nan)
    danced[:5] = rotation.rotate(rotation.yaw(0.9), guide[:5])
    np.testing.assert_allclose(same_front(guide, danced, BAND)[:5], guide[:5], atol=1e-6)
