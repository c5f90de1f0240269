"""Features of clips: closed forms, what may and may not change them, and the known slips."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.motion import kinematics, rotation
from studykit.motion.clip_features import (
    GEOMETRIC_CLIP_NAMES,
    KINETIC_CLIP_NAMES,
    geometric_clip_features,
    kinetic_clip_features,
)
from studykit.motion.mirroring import mirrored
from studykit.motion.motion import Motion
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY, Skeleton

SWAP = list(NEUTRAL_BODY.mirror)
IMAGE = np.array([-1.0, 1.0, 1.0])
SYMMETRIC = Skeleton(
    joint_names=JOINT_NAMES,
    parents=NEUTRAL_BODY.parents,
    offsets=(NEUTRAL_BODY.offsets + NEUTRAL_BODY.offsets[SWAP] * IMAGE) / 2.0,
    mirror=NEUTRAL_BODY.mirror,
)
REST = kinematics.centred_positions(NEUTRAL_BODY, rotation.identity(24))


def standing(frames: int) -> np.ndarray:
    return np.tile(REST + np.array([0.0, 1.0, 0.0]), (frames, 1, 1))


def named(values: np.ndarray) -> dict[str, float]:
    return dict(zip(GEOMETRIC_CLIP_NAMES, values, strict=True))


def dancing(seed: int, frames: int = 120, skeleton: Skeleton = NEUTRAL_BODY) -> Motion:
    rng = np.random.default_rng(seed)
    times = np.arange(frames)[:, None, None] / 30.0
    turns = rng.normal(scale=0.9, size=(1, 24, 3)) * np.sin(
        rng.uniform(2.0, 9.0, (1, 24, 3)) * times + rng.uniform(0.0, 6.0, (1, 24, 3))
    )
    return Motion(
        skeleton=skeleton,
        rotations=rotation.exp(turns),
        root_positions=[0.0, 1.0, 0.0] + 0.8 * np.sin(3.0 * times[:, 0] * [1.0, 0.2, 0.5]),
        frame_rate_hz=30.0,
    )


def test_a_joint_on_a_circle_has_the_speed_and_the_acceleration_of_its_chords() -> None:
    radius, turn, rate, frames = 0.4, 2.0 * np.pi * 0.7, 30.0, 90
    angles = turn * np.arange(frames) / rate
    joints = standing(frames)
    joints[:, 21] += radius * np.stack((np.cos(angles), np.zeros(frames), np.sin(angles)), axis=-1)
    values = dict(zip(KINETIC_CLIP_NAMES, kinetic_clip_features(joints, rate), strict=True))

    # Five steps inside, four and three near the ends: chords of so many steps, over their time.
    step = turn / rate
    chords = {n: 2.0 * radius * np.sin(n * step / 2.0) * rate / n for n in (3, 4, 5)}
    speeds = 2 * chords[3] ** 2 + 2 * chords[4] ** 2 + (frames - 5) * chords[5] ** 2
    assert values["right_wrist_horizontal"] == pytest.approx(speeds / (frames - 1), rel=1e-9)
    assert values["right_wrist_vertical"] == pytest.approx(0.0, abs=1e-20)
    # A mean of n neighbouring second differences on a circle is shorter by sin(n a/2) / (n sin(a/2)).
    second = 4.0 * radius * np.sin(step / 2.0) ** 2 * rate**2
    means = {n: second * np.sin(n * step / 2.0) / (n * np.sin(step / 2.0)) for n in (2, 3, 4, 5)}
    # The last frame has two, the first and the last but one three, their neighbours four.
    efforts = means[2] + 2 * means[3] + 2 * means[4] + (frames - 6) * means[5]
    assert values["right_wrist_effort"] == pytest.approx(efforts / (frames - 1), rel=1e-9)


def test_a_joint_swinging_on_a_sine_spends_two_over_pi_of_its_greatest_acceleration() -> None:
    swing, turn, rate = 0.3, 2.0 * np.pi, 6000.0
    joints = standing(3 * 6000 + 1)
    joints[:, 20, 1] += swing * np.sin(turn * np.arange(len(joints)) / rate)
    values = dict(zip(KINETIC_CLIP_NAMES, kinetic_clip_features(joints, rate), strict=True))
    assert values["left_wrist_effort"] == pytest.approx(swing * turn**2 * 2.0 / np.pi, rel=1e-5)
    assert values["left_wrist_vertical"] == pytest.approx((swing * turn) ** 2 / 2.0, rel=1e-5)
    assert values["left_wrist_horizontal"] == 0.0


def test_the_slip_measures_the_distance_from_the_origin() -> None:
    still = standing(60) - REST[12]  # the neck lies 1 m from the origin
    slipped = kinetic_clip_features(still, 60.0, compat="aistpp")[2::3]
    # With p still, the slip leaves (-p + p / dt) / dt.
    expected = np.linalg.norm(still[0], axis=-1) * 60.0 * 59.0
    assert slipped == pytest.approx(expected, rel=1e-9)
    assert slipped[12] == pytest.approx(3540.0)
    assert np.all(kinetic_clip_features(still, 60.0) == 0.0)


def test_where_the_dance_stands_and_faces_changes_nothing() -> None:
    motion = dancing(1)
    moved = kinematics.turned(motion, 1.3, about=np.array([2.0, 0.0, -1.0]))
    own, other = (
        kinematics.joint_positions(one) + np.array([0.0, shift, 0.0])
        for one, shift in ((motion, 0), (moved, 2))
    )
    assert kinetic_clip_features(other, 30.0) == pytest.approx(kinetic_clip_features(own, 30.0), rel=1e-9)
    assert geometric_clip_features(other, 30.0) == pytest.approx(geometric_clip_features(own, 30.0))
    # The slip changes with the place.
    own, other = (kinetic_clip_features(one, 60.0, compat="aistpp") for one in (own, other))
    assert not np.allclose(other[2::3], own[2::3], rtol=0.1)


@pytest.mark.parametrize("seed", range(5))
def test_in_the_mirror_left_and_right_change_places(seed) -> None:
    motion = dancing(seed, skeleton=SYMMETRIC)
    own, image = (
        named(geometric_clip_features(kinematics.joint_positions(one), 30.0, skeleton=SYMMETRIC))
        for one in (motion, mirrored(motion))
    )
    other = {"left": "right", "right": "left"}
    for name, share in own.items():
        stem, _, side = name.rpartition("_")
        assert image[f"{stem}_{other[side]}" if side in other else name] == pytest.approx(share), name
    kinetic, of_image = (
        kinetic_clip_features(kinematics.joint_positions(one), 30.0).reshape(24, 3)
        for one in (motion, mirrored(motion))
    )
    assert of_image == pytest.approx(kinetic[SWAP], rel=1e-9, abs=1e-12)


def test_the_program_knows_no_mirror() -> None:
    """Why the default does not follow it: three of its planes ask for the wrong side."""
    differs = set()
    for seed in range(5):
        motion = dancing(seed, skeleton=SYMMETRIC)
        own, image = (
            named(geometric_clip_features(kinematics.joint_positions(one), 60.0, compat="aistpp"))
            for one in (motion, mirrored(motion))
        )
        differs |= {
            stem
            for stem in ("hand_forward", "foot_behind", "hand_fast", "knee_bent")
            if not np.isclose(image[f"{stem}_left"], own[f"{stem}_right"])
        }
    assert differs == {"hand_forward", "foot_behind"}


def moving(joint: str, velocity: tuple[float, float, float]) -> dict[str, float]:
    joints = standing(31)
    joints[:, JOINT_NAMES.index(joint)] += np.arange(31)[:, None] / 30.0 * np.array(velocity)
    return named(geometric_clip_features(joints, 30.0))


def test_each_gesture_is_told_by_its_name() -> None:
    assert moving("right_wrist", (0.0, 0.0, 0.6))["hand_forward_right"] == 1.0
    assert moving("right_wrist", (0.0, 0.0, -0.6))["hand_forward_right"] == 0.0
    assert moving("left_wrist", (0.0, 0.0, 0.6))["hand_forward_left"] == 1.0
    assert moving("left_wrist", (0.0, 0.7, 0.0))["hand_up_left"] == 1.0
    assert moving("left_wrist", (0.0, -0.7, 0.0))["hand_up_left"] == 0.0
    assert moving("right_wrist", (0.5, 0.0, 0.0))["hands_approaching"] == 1.0
    assert moving("right_wrist", (-0.5, 0.0, 0.0))["hands_approaching"] == 0.0
    assert moving("right_wrist", (-0.5, 0.0, 0.0))["hand_from_root_right"] == 1.0
    assert moving("right_wrist", (-0.5, 0.0, 0.0))["hand_from_root_left"] == 0.0
    assert moving("left_ankle", (0.0, 0.0, 0.7))["foot_fast_left"] == 1.0
    assert moving("pelvis", (0.0, 0.0, 0.7))["root_fast"] == 1.0
    # At 0.4 m/s a hand is not fast: 2.5 upper arms a second are 0.65 m/s.
    assert moving("left_wrist", (0.0, 0.0, 0.4))["hand_fast_left"] == 0.0


def test_a_frame_taken_for_half_as_long_makes_slow_hands_fast() -> None:
    joints = standing(61)
    joints[:, 20, 2] += 0.4 * np.arange(61) / 60.0
    assert named(geometric_clip_features(joints, 60.0))["hand_fast_left"] == 0.0
    assert named(geometric_clip_features(joints, 60.0, compat="aistpp"))["hand_fast_left"] == 1.0


@pytest.mark.parametrize(
    ("joint", "place", "name"),
    [
        ("pelvis", (0.0, 1.0, -0.4), "root_behind"),
        ("right_ankle", (-0.1, 0.6, 0.2), "foot_raised_right"),
        ("left_wrist", (0.3, 1.8, 0.0), "hand_over_neck_left"),
        ("right_wrist", (-0.3, 0.3, 0.0), "hand_low_right"),
        ("left_wrist", (0.95, 1.2, 0.0), "hands_apart"),
        ("left_ankle", (0.6, 0.1, 0.0), "feet_apart"),
        ("right_wrist", (-0.2, 1.3, 0.0), "elbow_bent_right"),
        ("left_knee", (0.3, 1.1, 0.5), "leg_out_left"),
        ("right_ankle", (-0.1, 0.6, -0.3), "knee_bent_right"),
    ],
)
def test_each_posture_is_told_by_its_name(joint, place, name) -> None:
    joints = standing(5)
    if name != "hands_apart":
        assert named(geometric_clip_features(joints, 30.0))[name] == 0.0
    else:
        joints[:, JOINT_NAMES.index("right_wrist")] = -0.1, 1.2, 0.0
    joints[:, JOINT_NAMES.index(joint)] = place
    assert named(geometric_clip_features(joints, 30.0))[name] == 1.0


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_foot_is_behind_unless_it_steps_before_the_other_leg(side) -> None:
    # The other leg's plane leans forward to its toes, so that an ankle beside its fellow is behind it.
    for place, behind in ((-0.5, 1.0), (0.0, 1.0), (0.4, 0.0)):
        joints = standing(5)
        joints[:, JOINT_NAMES.index(f"{side}_ankle"), 2] += place
        assert named(geometric_clip_features(joints, 30.0))[f"foot_behind_{side}"] == behind


def test_standing_up_is_not_lying() -> None:
    turned = standing(5) @ np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    assert named(geometric_clip_features(standing(5), 30.0))["spine_horizontal"] == 0.0
    assert named(geometric_clip_features(turned, 30.0))["spine_horizontal"] == 1.0
    # Arms held out at rest are away from the spine, legs are not.
    rest = named(geometric_clip_features(standing(5), 30.0))
    assert (rest["arm_out_left"], rest["leg_out_left"]) == (1.0, 0.0)


@pytest.mark.parametrize("features", [kinetic_clip_features, geometric_clip_features])
@pytest.mark.parametrize(
    ("joints", "rate", "compat", "problem"),
    [
        (standing(3), 30.0, None, "positions have the shape"),
        (standing(9)[:, :22], 30.0, None, "positions have the shape"),
        (standing(9)[:, 0], 30.0, None, "positions have the shape"),
        (np.full((9, 24, 3), np.nan), 30.0, None, "not a finite number"),
        (standing(9), 0.0, None, "not a finite number"),
        (standing(9), np.nan, None, "not a finite number"),
        (standing(9), 30.0, "aistpp", "60 frames a second"),
    ],
)
def test_clips_that_cannot_be_measured_are_refused(features, joints, rate, compat, problem) -> None:
    with pytest.raises(InputError, match=problem):
        features(joints, rate, compat=compat)
