"""Features of poses against a slow implementation of their definitions, and against literal poses."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.library.calibrate import fit_scaler
from studykit.motion import features, kinematics, rotation
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY

RATE = 30.0


def moving(frames: int = 40, seed: int = 3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    turns = rng.normal(scale=0.3, size=(1, 24, 3)) + np.cumsum(
        rng.normal(scale=0.05, size=(frames, 24, 3)), axis=0
    )
    return kinematics.centred_positions(NEUTRAL_BODY, rotation.exp(turns))


def kinetic_by_definition(p: np.ndarray, i: int, joint: int) -> tuple[float, float, float]:
    """Follow the windowed sums of Onuma et al. (2008) term by term, windows cut off at the ends."""
    frames, dt, window = len(p), 1.0 / RATE, range(-2, 3)
    steps = [k for k in window if i + k - 1 >= 0 and i + k < frames]
    velocity = sum((p[i + k, joint] - p[i + k - 1, joint]) / dt for k in steps) / len(steps)
    bends = [k for k in window if i + k - 1 >= 0 and i + k + 1 < frames]
    acceleration = sum(
        (p[i + k + 1, joint] - 2 * p[i + k, joint] + p[i + k - 1, joint]) / dt**2 for k in bends
    ) / len(bends)
    return (
        velocity[0] ** 2 + velocity[2] ** 2,
        velocity[1] ** 2,
        float(np.sqrt((acceleration**2).sum())),
    )


@pytest.mark.parametrize("frames", [5, 6, 40])
def test_kinetic_values_follow_their_definition_to_the_very_ends(frames) -> None:
    positions = moving(frames)
    kinetic = features.kinetic(positions, RATE).reshape(frames, 24, 3)
    for i in range(frames):
        for joint in range(24):
            assert kinetic[i, joint] == pytest.approx(
                kinetic_by_definition(positions, i, joint), rel=1e-9, abs=1e-12
            )


def test_the_public_copies_mistake_would_be_noticed() -> None:
    # They forget to divide the second position by the frame time: what they call effort is a distance.
    far, near = moving() + np.array([10.0, 0.0, 0.0]), moving()
    effort = slice(2, None, 3)
    assert features.kinetic(far, RATE)[:, effort] == pytest.approx(
        features.kinetic(near, RATE)[:, effort], rel=1e-6
    )


def test_97_values_a_pose_and_11640_a_segment() -> None:
    values = features.pose_features(moving(120), RATE)
    assert values.shape == (120, 97)
    assert values.size == 11_640
    assert len(features.FEATURE_NAMES) == len(set(features.FEATURE_NAMES)) == 97
    assert features.FEATURE_NAMES[3:6] == ("left_hip_horizontal", "left_hip_vertical", "left_hip_effort")
    assert np.all(values[:, :3] == 0.0)  # the pelvis never leaves itself


@pytest.mark.parametrize("angle_rad", [0.7, -2.9, 3.1])
def test_it_does_not_matter_where_the_dancer_stands_or_looks(angle_rad) -> None:
    positions = moving()
    turned = rotation.rotate(rotation.yaw(angle_rad), positions)
    assert features.pose_features(turned, RATE) == pytest.approx(
        features.pose_features(positions, RATE), rel=1e-9, abs=1e-11
    )
    moved = turned + np.array([3.0, 0.4, -8.0])
    assert features.pose_features(moved, RATE) == pytest.approx(
        features.pose_features(positions, RATE), rel=1e-6, abs=1e-9
    )


def mirrored(positions: np.ndarray) -> np.ndarray:
    return positions[:, NEUTRAL_BODY.mirror] * [-1.0, 1.0, 1.0]


def other_side(name: str) -> str:
    return name.replace("left", "?").replace("right", "left").replace("?", "right")


def test_mirroring_swaps_the_sides_and_turns_the_twist_round() -> None:
    positions = moving()
    values, seen = features.pose_features(positions, RATE), features.pose_features(mirrored(positions), RATE)
    names = features.FEATURE_NAMES
    for column, name in enumerate(names):
        sign = -1.0 if name == "trunk_twist" else 1.0
        own = values[:, names.index(other_side(name))]
        assert seen[:, column] == pytest.approx(sign * own, rel=1e-9, abs=1e-11), name


def shape(name: str, **turns: tuple[float, float, float]) -> float:
    """Give one geometric value of the rest pose with some joints turned (degrees about X, Y, Z)."""
    rotations = rotation.identity(1, 24)
    for joint, degrees in turns.items():
        rotations[:, JOINT_NAMES.index(joint)] = rotation.exp(np.radians(degrees))
    pose = kinematics.centred_positions(NEUTRAL_BODY, rotations)
    return float(features.geometric(pose)[0, features.GEOMETRIC_NAMES.index(name)])


def test_literal_poses() -> None:
    straight = np.degrees(shape("knee_left"))
    assert np.degrees(shape("knee_left", left_knee=(90, 0, 0))) == pytest.approx(straight - 90.0, abs=12.0)
    assert np.degrees(shape("shoulder_elevation_left", left_shoulder=(0, 0, 80))) > 160.0  # arm up
    assert np.degrees(shape("shoulder_elevation_left", left_shoulder=(0, 0, -80))) < 20.0  # arm down
    assert np.degrees(shape("trunk_inclination", pelvis=(90, 0, 0))) == pytest.approx(90.0, abs=6.0)
    # The chest turned to the left: twist grows.
    assert shape("trunk_twist", spine3=(0, 30, 0)) - shape("trunk_twist") == pytest.approx(
        np.radians(30.0), abs=0.03
    )
    assert shape("hand_over_neck_right", right_shoulder=(0, 0, -80)) > 0.2  # right arm up
    assert shape("foot_raised_left", left_hip=(-90, 0, 0)) > 0.2
    assert shape("foot_fore_aft_left", left_hip=(-40, 0, 0)) > 0.2 > shape("foot_fore_aft_left")
    assert shape("hands_apart", left_shoulder=(0, -90, 0), right_shoulder=(0, 90, 0)) < 0.4  # arms ahead


def test_a_scaler_makes_every_channel_comparable() -> None:
    segments = np.stack([features.pose_features(moving(120, seed), RATE) for seed in range(8)])
    segments[..., 90] = 0.25  # a channel that never changes
    scaler = fit_scaler(segments.astype(np.float32))
    poses = segments.reshape(-1, 97)
    logarithmic = scaler.logarithmic(poses)
    medians = [np.median(column[column > 0.0]) if (column > 0.0).any() else 1.0 for column in poses.T[:72]]
    assert scaler.kinetic_medians == pytest.approx(medians, rel=1e-5)
    assert logarithmic[:, :72] == pytest.approx(np.log(1.0 + poses[:, :72] / medians), rel=1e-4)
    assert np.array_equal(logarithmic[:, 72:], poses[:, 72:])

    alive = np.ones(97, dtype=bool)
    alive[[0, 1, 2, 90]] = False
    unclipped = (logarithmic - scaler.means)[:, alive] / scaler.deviations[alive]
    assert unclipped.mean(axis=0) == pytest.approx(np.zeros(93), abs=1e-4)
    assert unclipped.std(axis=0) == pytest.approx(np.ones(93), abs=1e-4)
    standard = scaler.standardised(segments)
    assert np.all(standard[..., ~alive] == 0.0)
    assert standard.reshape(-1, 97)[:, alive] == pytest.approx(np.clip(unclipped, -5.0, 5.0), abs=1e-9)
    assert np.abs(scaler.standardised(1e6 * segments)).max() == 5.0
