from __future__ import annotations

import numpy as np
import pytest

from studykit.analysis.common_body import COMMON_JOINTS, common_space, resampled
from studykit.core.errors import InputError
from studykit.motion import rotation
from studykit.motion.kinematics import joint_positions, turned
from studykit.motion.motion import JointTracks, Motion
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY


def standing(frames: int) -> Motion:
    still = np.zeros((frames, 24, 4))
    still[..., 0] = 1.0
    return Motion(
        skeleton=NEUTRAL_BODY, rotations=still, root_positions=np.full((frames, 3), 2.0), frame_rate_hz=30.0
    )


def rest_pose() -> np.ndarray:
    centred = joint_positions(standing(1))[0] - 2.0
    return centred[[NEUTRAL_BODY.index(name) for name in COMMON_JOINTS]]


def test_the_neutral_body_stays_as_it_is_but_for_its_slight_turn() -> None:
    space = common_space(joint_positions(standing(40)), JOINT_NAMES)
    assert space.shape == (40, 15, 3)
    np.testing.assert_allclose(space[0], rest_pose(), atol=0.02)
    np.testing.assert_allclose(np.linalg.norm(space[7], axis=-1), np.linalg.norm(rest_pose(), axis=-1))


def test_turns_after_the_first_second_are_part_of_the_dance() -> None:
    motion = turned(standing(90), 2.0)
    rotations = np.array(motion.rotations)
    rotations[45:, 0] = rotation.multiply(rotation.yaw(np.pi / 2), rotations[45:, 0])
    spun = joint_positions(
        Motion(
            skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=np.zeros((90, 3)), frame_rate_hz=30.0
        )
    )
    space = common_space(spun, JOINT_NAMES)
    np.testing.assert_allclose(
        space[:45], common_space(joint_positions(standing(45)), JOINT_NAMES), atol=1e-12
    )
    np.testing.assert_allclose(space[45:], rotation.rotate(rotation.yaw(np.pi / 2), space[:45]), atol=1e-12)


def test_facing_comes_from_a_median_that_one_bad_frame_cannot_move() -> None:
    positions = joint_positions(turned(standing(40), np.pi))  # where angles jump from pi to -pi
    positions[3] = joint_positions(turned(standing(1), 1.0))[0]
    rng = np.random.default_rng(1)
    noisy = positions + rng.normal(0.0, 0.003, positions.shape)
    expected = common_space(joint_positions(standing(40)), JOINT_NAMES)
    np.testing.assert_allclose(common_space(positions, JOINT_NAMES)[10:], expected[10:], atol=1e-12)
    np.testing.assert_allclose(common_space(noisy, JOINT_NAMES)[10:], expected[10:], atol=0.05)


def test_joints_that_a_camera_does_not_know_are_bridged() -> None:
    known = [
        name
        for name in JOINT_NAMES
        if name not in {"spine1", "spine2", "left_collar", "right_collar", "neck"}
    ]
    positions = 1.1 * joint_positions(standing(30))
    places = [NEUTRAL_BODY.index(name) for name in known]
    space = common_space(positions[:, places], known)
    whole = common_space(positions, JOINT_NAMES)
    neck = COMMON_JOINTS.index("neck")
    assert np.isnan(space[:, neck]).all()
    np.testing.assert_allclose(np.delete(space, neck, 1), np.delete(whole, neck, 1), atol=0.02)


def test_a_frame_without_the_pelvis_is_not_seen() -> None:
    positions = joint_positions(standing(30))
    positions[0, 0] = np.nan
    space = common_space(positions, JOINT_NAMES)
    assert np.isnan(space[0]).all()
    assert np.isfinite(space[1:]).all()


def test_bodies_that_cannot_be_compared_are_an_error() -> None:
    positions = joint_positions(standing(5))
    with pytest.raises(InputError, match='"nose" is no joint'):
        common_space(positions, [*JOINT_NAMES[:-1], "nose"])
    with pytest.raises(InputError, match='"pelvis" is missing'):
        common_space(positions[:, 1:], JOINT_NAMES[1:])
    with pytest.raises(ValueError, match="shape"):
        common_space(positions, JOINT_NAMES[1:])
    positions[:, NEUTRAL_BODY.index("left_hip")] = np.nan
    with pytest.raises(InputError, match="never seen together"):
        common_space(positions, JOINT_NAMES)


def test_resampling_follows_straight_lines_and_leaves_long_gaps_open() -> None:
    times = np.array([0.0, 0.1, 0.2, 0.7, 0.8])
    positions = np.zeros((5, 2, 3))
    positions[:, 0, 0] = times**1
    positions[:, 1, 1] = 2.0 * times
    positions[1, 1] = np.nan
    tracks = JointTracks(
        positions=positions, confidence=np.ones((5, 2)), times_s=times, joint_names=("pelvis", "head")
    )
    wanted = np.array([-0.1, 0.0, 0.05, 0.1, 0.2, 0.4, 0.75, 0.8, 0.9])
    found = resampled(tracks, wanted, longest_gap_s=0.21)
    inside = np.array([False, True, True, True, True, False, True, True, False])
    np.testing.assert_allclose(found[inside, 0, 0], wanted[inside], atol=1e-12)
    np.testing.assert_allclose(found[inside, 1, 1], 2.0 * wanted[inside], atol=1e-12)
    assert np.isnan(found[~inside]).all()
    narrower = resampled(tracks, wanted, longest_gap_s=0.11)
    assert np.isnan(narrower[[2, 3], 1]).all()
    assert np.isfinite(narrower[[2, 3], 0]).all()
