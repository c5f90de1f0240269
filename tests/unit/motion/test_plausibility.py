"""What no body does is refused whole; what bodies do, however oddly, is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.plausibility import implausible
from studykit.motion.skeleton import NEUTRAL_BODY

SECONDS, RATE = 8, 60.0


def squats(depth_rad: float = 1.2) -> Motion:
    """Give deep squats on flat feet, the pelvis as far over the floor as the body reaches down."""
    time = np.arange(int(SECONDS * RATE)) / RATE
    return folded(depth_rad * (0.5 - 0.5 * np.cos(2.0 * np.pi * 0.5 * time)))


def folded(bend: np.ndarray) -> Motion:
    """Give legs folded by angles (rad), the lowest joint on the floor."""
    turns = np.zeros((len(bend), 24, 3))
    for side in ("left", "right"):
        turns[:, NEUTRAL_BODY.index(f"{side}_hip"), 0] = -bend
        turns[:, NEUTRAL_BODY.index(f"{side}_knee"), 0] = 2.0 * bend
        turns[:, NEUTRAL_BODY.index(f"{side}_ankle"), 0] = -bend
    rotations = rotation.exp(turns)
    root = np.zeros((len(bend), 3))
    root[:, 1] = -kinematics.centred_positions(NEUTRAL_BODY, rotations)[..., 1].min(axis=1)
    return Motion(skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=root, frame_rate_hz=RATE)


def jumps(tuck_rad: float, crouch_rad: float, *, high_m: float = 0.3) -> Motion:
    """Give a jump every second, crouching on the floor, legs drawn up in the air; the pelvis flies freely."""
    flight = 2.0 * np.sqrt(2.0 * high_m / 9.81)
    phase = np.arange(int(4 * RATE)) / RATE % 1.0
    in_air = phase >= 1.0 - flight
    part = np.where(in_air, (phase - (1.0 - flight)) / flight, phase / (1.0 - flight))
    bend = np.where(in_air, tuck_rad, crouch_rad) * np.sin(np.pi * part) ** 2
    motion = folded(bend)
    root = np.array(motion.root_positions)
    root[in_air, 1] = root[:, 1].max() + 4.0 * high_m * (part * (1.0 - part))[in_air]
    return replace(motion, root_positions=root)


def turned(motion: Motion, degrees: tuple[float, float, float]) -> Motion:
    turn = rotation.exp(np.radians(degrees))
    rotations = np.array(motion.rotations)
    rotations[:, 0] = rotation.multiply(turn, rotations[:, 0])
    return replace(motion, rotations=rotations, root_positions=rotation.rotate(turn, motion.root_positions))


def test_squats_are_plausible_whichever_way_they_face() -> None:
    for degrees in (0.0, 90.0, -135.0):
        assert implausible(turned(squats(), (0.0, degrees, 0.0))) is None


@pytest.mark.parametrize("crouch_rad", [0.5, 0.75, 1.0])
@pytest.mark.parametrize("tuck_rad", [0.8, 1.2, 1.6])
def test_jumps_with_drawn_up_legs_are_plausible_and_their_unit_is_still_checked(
    tuck_rad: float, crouch_rad: float
) -> None:
    motion = jumps(tuck_rad, crouch_rad)
    assert implausible(motion) is None
    for factor in (0.001, 0.01, 0.1, 10.0, 100.0, 1000.0):
        fault = implausible(replace(motion, root_positions=factor * motion.root_positions))
        assert fault is not None
        assert "units_m" in fault.remedy


def test_a_way_upside_down_under_squats_is_noticed() -> None:
    motion = squats()
    fault = implausible(replace(motion, root_positions=motion.root_positions * [1.0, -1.0, 1.0]))
    assert fault is not None
    assert "the pelvis sinks by -1 m" in fault.problem


def test_standing_still_is_plausible() -> None:
    still = squats(0.0)
    assert implausible(still) is None
    assert implausible(replace(still, frame_rate_hz=120.0)) is None


@pytest.mark.parametrize(
    ("degrees", "how"),
    [
        ((90.0, 0.0, 0.0), "on its side"),
        ((-90.0, 0.0, 0.0), "on its side"),
        ((0.0, 0.0, 90.0), "on its side"),
        ((180.0, 0.0, 0.0), "upside down"),
    ],
)
def test_a_wrong_axis_is_noticed(degrees, how) -> None:
    fault = implausible(turned(squats(), degrees))
    assert fault is not None
    assert how in fault.problem
    assert "up" in fault.remedy


def test_rolling_over_the_floor_is_no_wrong_axis() -> None:
    # Lying, but with the trunk pointing all round: floor work, not a file with Z up.
    motion = squats(0.3)
    rotations = np.array(motion.rotations)
    round_and_round = rotation.yaw(np.linspace(0.0, 2.0 * np.pi, len(motion)))
    lying = rotation.exp(np.radians([-90.0, 0.0, 0.0]))
    rotations[:, 0] = rotation.multiply(rotation.multiply(round_and_round, lying), rotations[:, 0])
    root = np.tile([0.0, 0.15, 0.0], (len(motion), 1))
    assert implausible(replace(motion, rotations=rotations, root_positions=root)) is None


@pytest.mark.parametrize("factor", [0.001, 0.01, 100.0, 1000.0])
def test_a_way_in_the_wrong_unit_is_noticed(factor: float) -> None:
    motion = squats()
    fault = implausible(replace(motion, root_positions=factor * motion.root_positions))
    assert fault is not None
    assert "units_m" in fault.remedy


def test_transposed_rotations_are_noticed() -> None:
    fault = implausible(replace(squats(), rotations=rotation.inverse(squats().rotations)))
    assert fault is not None
    assert "knees bend forwards in 100%" in fault.problem


def test_thighs_twisted_back_to_front_are_noticed() -> None:
    # Knees bend backwards against their own thighs, which face backwards: mirrored positions look so.
    motion = squats()
    turns = rotation.log(motion.rotations)
    for side in ("left", "right"):
        turns[:, NEUTRAL_BODY.index(f"{side}_hip")] *= -1.0
    rotations = rotation.exp(turns)
    half = rotation.yaw(np.pi)
    for side in ("left", "right"):
        hip = NEUTRAL_BODY.index(f"{side}_hip")
        rotations[:, hip] = rotation.multiply(rotations[:, hip], half)
    fault = implausible(replace(motion, rotations=rotations))
    assert fault is not None
    assert "knees bend forwards" in fault.problem


@pytest.mark.parametrize("rate", [1.0, 5000.0])
def test_a_rate_that_no_camera_has_is_noticed(rate: float) -> None:
    fault = implausible(replace(squats(), frame_rate_hz=rate))
    assert fault is not None
    assert "--fps" in fault.remedy


def test_a_rate_far_too_high_is_noticed_by_the_limbs() -> None:
    motion = squats(0.0)
    turns = np.zeros((len(motion), 24, 3))
    swing = 0.8 * np.sin(2.0 * np.pi * np.arange(len(motion)) / RATE)
    turns[:, NEUTRAL_BODY.index("left_shoulder"), 1] = swing
    waving = replace(motion, rotations=rotation.exp(turns))
    assert implausible(waving) is None
    fault = implausible(replace(waving, frame_rate_hz=20.0 * RATE))
    assert fault is not None
    assert "hands and feet move at" in fault.problem
    assert "frame rate" in fault.remedy


def test_a_body_thrown_about_is_noticed() -> None:
    motion = squats(0.1)
    fault = implausible(
        replace(
            motion,
            root_positions=motion.root_positions * [1.0, 1.0, 1.0] + 0.25 * np.arange(len(motion))[:, None],
        )
    )
    assert fault is not None
    assert "travels at" in fault.problem
