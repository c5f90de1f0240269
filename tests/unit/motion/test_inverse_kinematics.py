"""Turns found from positions put every joint back where it was."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from studykit.library import joint_limit
from studykit.motion import kinematics, rotation
from studykit.motion.inverse_kinematics import (
    fit,
    measured_body,
    rotations_from_positions,
    shortest_swing,
)
from studykit.motion.skeleton import AIST_BODY, NEUTRAL_BODY


def possible_poses(count: int) -> np.ndarray:
    """Give poses anywhere within the limits of a person's joints, facing anywhere."""
    rng = np.random.default_rng(11)
    rotations = joint_limit.rotations(rng.uniform(joint_limit.LOW, joint_limit.HIGH, size=(count, 24, 3)))
    rotations[:, 0] = rotation.exp(rng.normal(scale=1.5, size=(count, 3)))
    return rotations


@pytest.mark.parametrize("skeleton", [NEUTRAL_BODY, AIST_BODY])
def test_every_joint_is_put_back(skeleton) -> None:
    positions = kinematics.centred_positions(skeleton, possible_poses(200))
    found = rotations_from_positions(positions + np.array([3.0, 1.0, -2.0]), skeleton)
    assert np.abs(kinematics.centred_positions(skeleton, found) - positions).max() < 1e-6


def test_only_directions_matter() -> None:
    positions = kinematics.centred_positions(NEUTRAL_BODY, possible_poses(20))
    assert rotations_from_positions(1.2 * positions) == pytest.approx(rotations_from_positions(positions))


def test_the_rest_pose_needs_no_turn() -> None:
    rest = kinematics.centred_positions(NEUTRAL_BODY, rotation.identity(1, 24))
    assert rotation.log(rotations_from_positions(rest)) == pytest.approx(np.zeros((1, 24, 3)), abs=1e-7)


def test_pelvis_and_chest_are_found_as_they_were_turned() -> None:
    # Joints with three bones leave nothing open.
    rotations = possible_poses(50)
    positions = kinematics.centred_positions(NEUTRAL_BODY, rotations)
    world, found = (
        kinematics.global_rotations(NEUTRAL_BODY, r) for r in (rotations, rotations_from_positions(positions))
    )
    for joint in (0, NEUTRAL_BODY.index("spine3")):
        assert rotation.between(world[:, joint], found[:, joint]) == pytest.approx(
            np.zeros((50, 3)), abs=1e-6
        )


def test_bones_that_do_not_fit_are_turned_as_well_as_can_be() -> None:
    # A camera's noise can turn three bones inside out; a body never is.
    rng = np.random.default_rng(6)
    positions = rng.normal(scale=0.3, size=(100, 24, 3))
    found = rotations_from_positions(positions)[:, 0]
    children = NEUTRAL_BODY.children(0)
    rest, seen = NEUTRAL_BODY.offsets[list(children)], positions[:, list(children)] - positions[:, :1]
    rest = rest / np.linalg.norm(rest, axis=-1, keepdims=True)
    seen = seen / np.linalg.norm(seen, axis=-1, keepdims=True)
    for frame in range(100):
        best = Rotation.align_vectors(seen[frame], rest)[0].as_quat(scalar_first=True)
        assert rotation.log(rotation.multiply(rotation.inverse(best), found[frame])) == pytest.approx(
            np.zeros(3), abs=1e-5
        )


def test_an_arm_that_points_the_opposite_way() -> None:
    rotations = rotation.identity(1, 24)
    across = np.cross(NEUTRAL_BODY.offsets[NEUTRAL_BODY.index("left_elbow")], [0.0, 0.0, 1.0])
    rotations[:, NEUTRAL_BODY.index("left_shoulder")] = rotation.exp(np.pi * across / np.linalg.norm(across))
    positions = kinematics.centred_positions(NEUTRAL_BODY, rotations)
    found = kinematics.centred_positions(NEUTRAL_BODY, rotations_from_positions(positions))
    assert found == pytest.approx(positions, abs=1e-6)


def test_a_trembling_camera_turns_no_short_bone() -> None:
    rest = kinematics.centred_positions(NEUTRAL_BODY, rotation.identity(300, 24))
    seen = rest + np.random.default_rng(3).normal(scale=0.005, size=rest.shape)
    chest = NEUTRAL_BODY.index("spine3")

    def trembling(shortest_bone_m: float) -> float:
        found = rotations_from_positions(seen, shortest_bone_m=shortest_bone_m)
        return float(np.linalg.norm(rotation.log(found[:, chest]), axis=-1).mean())

    assert trembling(0.08) < 0.7 * trembling(0.0)


# --- a body put where its joints were seen ---------------------------------------------------------------

RATE_HZ = 60.0


def steps(*, twist_rad: float = 0.6, frames: int = 240) -> np.ndarray:
    """Give somebody who turns thighs and upper arms about themselves and bends knees and elbows."""
    time = np.arange(frames)[:, None] / RATE_HZ
    turns = np.zeros((frames, 24, 3))
    index = NEUTRAL_BODY.index
    for number, side in enumerate(("left", "right")):
        sign = 1.0 - 2.0 * number
        phase = np.pi * number
        thigh = _unit(NEUTRAL_BODY.offsets[index(f"{side}_knee")])
        arm = _unit(NEUTRAL_BODY.offsets[index(f"{side}_elbow")])
        twist = twist_rad * np.sin(1.3 * time + phase)
        lift = rotation.exp(
            np.concatenate((-0.5 - 0.4 * np.sin(2 * time + phase), 0 * time, 0 * time), axis=1)
        )
        turns[:, index(f"{side}_hip")] = rotation.log(rotation.multiply(lift, rotation.exp(twist * thigh)))
        turns[:, index(f"{side}_knee"), 0] = (0.9 + 0.5 * np.sin(3 * time + phase))[:, 0]
        down = rotation.exp(np.concatenate((0 * time, 0 * time, sign * (-0.9 + 0.3 * np.sin(time))), axis=1))
        turns[:, index(f"{side}_shoulder")] = rotation.log(rotation.multiply(down, rotation.exp(twist * arm)))
        turns[:, index(f"{side}_elbow"), 1] = (-sign * (1.0 + 0.4 * np.sin(2 * time + phase)))[:, 0]
    turns[:, 0, 1] = 1.5 * time[:, 0]
    return rotation.exp(turns)


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)


def seen(rotations: np.ndarray, skeleton=NEUTRAL_BODY) -> np.ndarray:
    return kinematics.centred_positions(skeleton, rotations) + np.array([1.0, 0.9, -2.0])


def angles(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return np.degrees(np.linalg.norm(rotation.between(first, second), axis=-1))


def step_sizes(rotations: np.ndarray) -> np.ndarray:
    return np.radians(angles(rotations[:-1], rotations[1:]))


@pytest.mark.parametrize("skeleton", [NEUTRAL_BODY, AIST_BODY])
@pytest.mark.parametrize("rounds", [0, 3])
def test_the_body_is_where_it_was_seen(skeleton, rounds) -> None:
    for rotations in (possible_poses(100), steps()):
        positions = seen(rotations, skeleton)
        found = fit(positions, skeleton, frame_rate_hz=RATE_HZ, rounds=rounds)
        assert found.errors.max() < 1e-6
        again = kinematics.centred_positions(skeleton, found.rotations) + found.root_positions[:, None]
        assert np.linalg.norm(again - positions, axis=-1) == pytest.approx(found.errors, abs=1e-12)


def test_bent_limbs_tell_how_they_are_twisted() -> None:
    rotations = steps()
    found = fit(seen(rotations), NEUTRAL_BODY, frame_rate_hz=RATE_HZ).rotations
    untwisted = rotations_from_positions(seen(rotations))  # wrong: the shortest swing from the parent
    for name in ("hip", "knee", "shoulder", "elbow"):
        for side in ("left", "right"):
            joint = NEUTRAL_BODY.index(f"{side}_{name}")
            assert np.median(angles(rotations, found)[:, joint]) < 5.0, name
            assert np.median(angles(rotations, untwisted)[:, joint]) > 10.0, name


def test_knees_bend_backwards_and_elbows_forwards_about_their_hinges() -> None:
    found = rotation.log(fit(seen(steps()), NEUTRAL_BODY, frame_rate_hz=RATE_HZ).rotations)
    for name, axis in (
        ("left_knee", [1, 0, 0]),
        ("right_knee", [1, 0, 0]),
        ("left_elbow", [0, -1, 0]),
        ("right_elbow", [0, 1, 0]),
    ):
        turns = found[:, NEUTRAL_BODY.index(name)]
        assert np.all(turns @ np.array(axis) > 0.97 * np.linalg.norm(turns, axis=-1))


def test_a_limb_that_is_straight_for_a_while_does_not_jump() -> None:
    rotations = steps(twist_rad=1.0)
    turns = rotation.log(rotations)
    knee, elbow = NEUTRAL_BODY.index("left_knee"), NEUTRAL_BODY.index("right_elbow")
    straight = np.clip(np.abs(np.arange(240) - 120) / 30.0 - 1.0, 0.0, 1.0)  # for a second
    turns[:, [knee, elbow]] *= straight[:, None, None]
    truth = rotation.exp(turns)
    found = fit(seen(truth), NEUTRAL_BODY, frame_rate_hz=RATE_HZ).rotations
    assert step_sizes(found).max() < 2.0 * step_sizes(truth).max() + 0.05


def test_a_leg_swung_past_the_opposite_of_rest_does_not_jump() -> None:
    # Straight up: there the shortest swing from rest turns half round from frame to frame.
    rotations = rotation.identity(200, 24)
    lift = np.linspace(0.0, -np.pi - 0.3, 200)
    rotations[:, NEUTRAL_BODY.index("left_hip")] = rotation.exp(np.stack((lift, 0 * lift, 0 * lift), axis=-1))
    bent = np.full(200, 0.6)
    rotations[:, NEUTRAL_BODY.index("left_knee")] = rotation.exp(
        np.stack((bent, 0 * bent, 0 * bent), axis=-1)
    )
    aside = rotation.exp(np.array([0.0, 0.0, 0.02]))
    hip = NEUTRAL_BODY.index("left_hip")
    rotations[:, hip] = rotation.multiply(aside, rotations[:, hip])
    positions = seen(rotations)
    assert step_sizes(rotations_from_positions(positions)).max() > 0.5
    found = fit(positions, NEUTRAL_BODY, frame_rate_hz=RATE_HZ).rotations
    assert step_sizes(found).max() < 0.1


def test_turning_the_room_turns_only_the_root() -> None:
    rotations, turn = steps(frames=60), rotation.exp(np.array([0.2, 2.0, -0.1]))
    positions = seen(rotations)
    found = fit(positions, NEUTRAL_BODY, frame_rate_hz=RATE_HZ).rotations
    turned = fit(rotation.rotate(turn, positions), NEUTRAL_BODY, frame_rate_hz=RATE_HZ).rotations
    assert angles(turned[:, 1:], found[:, 1:]).max() < 1e-4
    assert angles(turned[:, 0], rotation.multiply(turn, found[:, 0])).max() < 1e-4


def test_a_mirrored_body_moves_mirrored() -> None:
    mirror = list(NEUTRAL_BODY.mirror)
    other = replace(NEUTRAL_BODY, offsets=NEUTRAL_BODY.offsets[mirror] * [-1.0, 1.0, 1.0])
    positions = seen(steps(frames=60))
    found = fit(positions, NEUTRAL_BODY, frame_rate_hz=RATE_HZ).rotations
    mirrored = fit(positions[:, mirror] * [-1.0, 1.0, 1.0], other, frame_rate_hz=RATE_HZ).rotations
    assert angles(mirrored, found[:, mirror] * [1.0, 1.0, -1.0, -1.0]).max() < 1e-4


def test_bones_that_change_their_length_are_met_half_way() -> None:
    rng = np.random.default_rng(0)
    positions = seen(steps(frames=90))
    positions += rng.normal(scale=0.01, size=positions.shape)
    closed = fit(positions, NEUTRAL_BODY, frame_rate_hz=RATE_HZ, rounds=0)
    better = fit(positions, NEUTRAL_BODY, frame_rate_hz=RATE_HZ)
    assert closed.errors.mean() > 0.015
    assert better.errors.mean() < 0.6 * closed.errors.mean()
    assert np.all(np.sum(better.errors**2, axis=1) <= np.sum(closed.errors**2, axis=1) + 1e-12)


def test_points_of_no_body_do_not_fit() -> None:
    rng = np.random.default_rng(1)
    positions = seen(steps(frames=30))[:, rng.permutation(24)]
    assert fit(positions, NEUTRAL_BODY, frame_rate_hz=RATE_HZ).errors.mean() > 0.1


def test_a_single_frame_and_points_on_one_spot_are_no_trouble() -> None:
    assert fit(seen(steps(frames=1)), NEUTRAL_BODY, frame_rate_hz=RATE_HZ).errors.max() < 1e-6
    assert np.all(np.isfinite(fit(np.zeros((3, 24, 3)), NEUTRAL_BODY, frame_rate_hz=RATE_HZ).rotations))


def test_a_body_is_measured_by_its_median_bones() -> None:
    positions = 1.1 * seen(steps(frames=31), AIST_BODY)
    positions[:15] *= 1.5  # less than half of the frames
    body = measured_body(positions, AIST_BODY)
    assert body.offsets == pytest.approx(1.1 * AIST_BODY.offsets, abs=1e-9)


def test_the_shortest_swing_carries_one_direction_onto_another_and_no_farther() -> None:
    rng = np.random.default_rng(4)
    start, end = rng.normal(size=(2, 50, 3))
    end[0] = -2.0 * start[0]
    swing = shortest_swing(start, end)
    unit_start, unit_end = (v / np.linalg.norm(v, axis=-1, keepdims=True) for v in (start, end))
    assert rotation.rotate(swing, unit_start) == pytest.approx(unit_end, abs=1e-9)
    between = np.arccos(np.clip(np.sum(unit_start * unit_end, axis=-1), -1.0, 1.0))
    assert np.linalg.norm(rotation.log(swing), axis=-1) == pytest.approx(between, abs=1e-6)
