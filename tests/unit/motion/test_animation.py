from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import foot_contact, join_quality, kinematics, rotation, stage
from studykit.motion.animation import REACH, animate
from studykit.motion.blending import joined
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY

FRAMES = 60
INDEX = NEUTRAL_BODY.index
ARM = tuple(INDEX(f"right_{part}") for part in ("elbow", "wrist", "hand"))
LEGS = tuple(INDEX(f"{side}_{part}") for side in ("left", "right") for part in ("hip", "knee", "ankle"))
BALLS = list(foot_contact.POINTS[2:])


def swaying(seed: int, frames: int = FRAMES) -> Motion:
    """Stand with both feet on one spot, knees bent, while arms and trunk swing."""
    rng = np.random.default_rng(seed)
    phase = np.arange(frames)[:, None] / 30.0
    turns = np.zeros((frames, 24, 3))
    for joint in range(24):
        if joint not in LEGS and joint not in BALLS and joint > 0:
            turns[:, joint] = rng.normal(scale=0.3, size=3) + 0.2 * rng.normal(size=3) * np.sin(
                5.0 * phase + rng.uniform(0.0, 6.0)
            )
    bend, spread = rng.uniform(0.2, 0.7), rng.uniform(0.0, 0.3)
    for sign, side in ((1.0, "left"), (-1.0, "right")):
        apart = sign * spread
        turns[:, INDEX(f"{side}_hip")] = [-bend, 0.0, apart]
        turns[:, INDEX(f"{side}_knee")] = [2.0 * bend, 0.0, 0.0]
        turns[:, INDEX(f"{side}_ankle")] = [-bend, 0.0, -apart]
    rotations = rotation.exp(turns)
    rotations[:, 0] = rotation.yaw(rng.uniform(-3.0, 3.0))
    feet = kinematics.centred_positions(NEUTRAL_BODY, rotations[0])[BALLS, 1]
    roots = np.tile([rng.normal(), -feet.min(), rng.normal()], (frames, 1))
    return Motion(skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=roots, frame_rate_hz=30.0)


def dancing(seed: int, frames: int = FRAMES) -> Motion:
    """Swing all joints, the feet off the floor, and travel."""
    rng = np.random.default_rng(seed)
    phase = np.arange(frames)[:, None, None] / 30.0
    turns = rng.normal(scale=0.5, size=(1, 24, 3)) + rng.normal(scale=0.3, size=(1, 24, 3)) * np.sin(
        2.0 * phase + rng.uniform(0.0, 6.0, size=(1, 24, 3))
    )
    rotations = rotation.exp(turns)
    rotations[:, 0] = rotation.yaw(rng.uniform(-3.0, 3.0) + 0.5 * rng.normal() * phase[:, 0, 0])
    way = rng.normal(scale=0.5, size=(1, 3)) * [1.0, 0.0, 1.0] * phase[:, 0] + [0.0, 1.8, 0.0]
    return Motion(skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=way, frame_rate_hz=30.0)


def turns_between(first: Motion, second: Motion) -> np.ndarray:
    return np.linalg.norm(rotation.between(first.rotations, second.rotations), axis=-1)


def about(joins: np.ndarray, frames: int) -> np.ndarray:
    near = np.zeros(frames, dtype=bool)
    for join in joins:
        near[join - REACH : join + REACH] = True
    return near


@pytest.mark.parametrize("make", [swaying, dancing])
@pytest.mark.parametrize("blend", ["offset", "bridge"])
def test_only_twenty_frames_at_a_join_are_other_than_in_the_segments(make, blend) -> None:
    segments = [make(seed, FRAMES + 5 * seed) for seed in range(4)]
    joins = np.cumsum([len(segment) for segment in segments])[:-1]
    motion = animate(segments, blend=blend, stage_m=(2.0, 2.0))
    assert len(motion) == sum(len(segment) for segment in segments)
    near = about(joins, len(motion))
    danced = np.concatenate([segment.rotations for segment in segments])
    assert motion.rotations[~near, 1:] == pytest.approx(danced[~near, 1:], abs=1e-14)
    blended = joined(segments, blend=blend)
    assert motion.rotations[~near, 0] == pytest.approx(blended.rotations[~near, 0], abs=1e-14)
    assert motion.root_positions[~near, 1] == pytest.approx(blended.root_positions[~near, 1])
    assert turns_between(motion, blended)[near].max() > 1e-3


def test_nothing_is_cleaned_where_that_is_not_wanted() -> None:
    segments = [dancing(seed) for seed in range(3)]
    motion, blended = animate(segments, is_cleaned=False), joined(segments)
    assert motion.rotations == pytest.approx(blended.rotations, abs=1e-14)
    assert np.array_equal(motion.root_positions, blended.root_positions)


def test_one_segment_is_left_as_it_is() -> None:
    segment = swaying(0)
    assert np.array_equal(animate([segment]).root_positions, segment.root_positions)
    assert turns_between(animate([segment]), segment).max() < 1e-7


def test_segments_too_short_to_be_cleaned_are_refused() -> None:
    with pytest.raises(ValueError, match="23 frames, expected at least 24"):
        animate([dancing(0), dancing(1, 23)])


def held_apart(motion: Motion, segments: list[Motion]) -> tuple[float, float]:
    """Give how far the steadier and the other ball of the foot get from their places at a join, m."""
    join = len(segments[0])
    balls = kinematics.joint_positions(motion)[join - REACH : join + REACH, BALLS]
    ranges = np.linalg.norm(np.ptp(balls, axis=0), axis=-1)
    return float(ranges.min()), float(ranges.max())


@pytest.mark.parametrize("seed", range(5))
def test_the_foot_that_leads_stands_still_while_one_stance_becomes_another(seed) -> None:
    segments = [swaying(seed), swaying(seed + 50)]
    motion = animate(segments)
    assert held_apart(motion, segments)[0] < 1e-3
    # Without cleaning, both slide.
    assert held_apart(joined(segments), segments)[0] > 0.01
    # The other foot stands before and after it has stepped.
    balls = kinematics.joint_positions(motion)[:, BALLS]
    join = len(segments[0])
    for part in (slice(join - REACH - 2, join - 8), slice(join + 8, join + REACH + 2)):
        assert np.ptp(balls[part], axis=0).max() < 1e-3


def test_legs_alone_bring_feet_to_the_floor() -> None:
    segments = [swaying(1), swaying(2)]
    motion = animate(segments)
    # Arms and trunk are as without feet: as high above the floor, so that no foot stands.
    high = [
        Motion(
            skeleton=NEUTRAL_BODY,
            rotations=s.rotations,
            root_positions=s.root_positions + np.array([0.0, 1.0, 0.0]),
            frame_rate_hz=30.0,
        )
        for s in segments
    ]
    differ = turns_between(motion, animate(high)).max(axis=0)
    others = [joint for joint in range(24) if joint not in LEGS]
    assert differ[others].max() < 1e-7
    assert differ[list(LEGS)].min() > 0.01


def test_joints_that_are_held_turn_as_the_blend_has_them() -> None:
    for make in (dancing, swaying):
        segments = [make(seed) for seed in range(3)]
        knee = INDEX("left_knee")
        blended, motion = joined(segments), animate(segments, held=(*ARM, knee))
        assert turns_between(motion, blended)[:, [*ARM, knee]].max() < 1e-7
        assert turns_between(motion, blended)[:, INDEX("left_elbow")].max() > 1e-3
        speeds = [
            kinematics.angular_speeds(m.rotations, 30.0).max(axis=0)[list(ARM)] for m in (motion, blended)
        ]
        assert speeds[0] == pytest.approx(speeds[1])


def test_a_body_all_of_which_is_held_is_left_to_the_blend() -> None:
    segments = [swaying(seed) for seed in range(3)]
    assert turns_between(animate(segments, held=range(24)), joined(segments)).max() < 1e-7


def test_turning_the_room_turns_the_dance() -> None:
    segments = [swaying(seed) for seed in range(3)]
    motion = kinematics.turned(animate(segments), 0.7)
    turned = animate([kinematics.turned(segment, 0.7) for segment in segments])
    assert turns_between(motion, turned).max() < 1e-6
    assert turned.root_positions == pytest.approx(motion.root_positions, abs=1e-7)


def test_jolts_become_softer_and_energy_is_neither_won_nor_lost() -> None:
    segments = [dancing(seed) for seed in range(8)]
    found, before = (join_quality.join_quality(segments, m) for m in (animate(segments), joined(segments)))
    assert np.median(found.accelerations) < 0.6 * np.median(before.accelerations)
    assert abs(found.linear_energy - 1.0) < abs(before.linear_energy - 1.0)
    assert before.linear_energy > 1.1


def test_a_dance_stays_on_its_stage() -> None:
    segments = [dancing(seed) for seed in range(8)]
    free, kept = animate(segments), animate(segments, stage_m=(2.0, 1.5))
    assert stage.excess_m(free.root_positions, (2.0, 1.5)) > 0.1
    assert stage.excess_m(kept.root_positions, (2.0, 1.5)) < 2e-3
    # No foot stands here, so that joints have nothing to do with it.
    assert turns_between(free, kept).max() < 1e-7
