from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from studykit.core.seeding import stream
from studykit.library.sample import synthetic_takes
from studykit.motion import energy, rotation
from studykit.motion.kinematics import joint_positions
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY
from studykit.participant.effects import PAPER
from studykit.participant.movement import LARGEST_ERROR_M, wrong_turns
from studykit.participant.person import Person, cohort
from studykit.session import simulated_movement

PERSON = replace(cohort(1, 0)[0], height_m=1.70)
TALL = replace(PERSON, height_m=1.87)
FRAMES = 960


@cache
def guide(kind: str) -> Motion:
    """A dance of 32 s: standing still, every joint swinging with a phase of its own, or made up in style."""
    if kind == "made up":
        made_up = synthetic_takes(10, seed=1)[0].takes()[0].motion
        return part(made_up, FRAMES)
    times_s = np.arange(FRAMES) / 30.0
    phases = np.arange(24 * 3.0).reshape(24, 3)
    swings = np.sin(2 * np.pi * 0.5 * times_s[:, None, None] + phases)
    return Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.exp({"still": 0.0, "swinging": 0.4}[kind] * swings),
        root_positions=np.array([0.0, 0.9, 0.0]) + 0.1 * swings[:, 0],
        frame_rate_hz=30.0,
    )


def part(motion: Motion, frames: int) -> Motion:
    return replace(motion, rotations=motion.rotations[:frames], root_positions=motion.root_positions[:frames])


def bone_lengths(positions: np.ndarray) -> np.ndarray:
    return np.linalg.norm(positions[:, 1:] - positions[:, NEUTRAL_BODY.parents[1:]], axis=-1)


def keeps_its_bones(positions: np.ndarray, person: Person) -> bool:
    own = NEUTRAL_BODY.bone_lengths[1:] * person.height_m / 1.70
    return bool(np.abs(bone_lengths(positions) - own).max() < 1e-9)


def distance_m(danced: Motion, shown: Motion) -> float:
    return float(np.linalg.norm(joint_positions(danced) - joint_positions(shown), axis=-1).mean())


@pytest.mark.parametrize("kind", ["still", "swinging", "made up"])
@pytest.mark.parametrize("error_m", [0.004, 0.05, 0.12])
@pytest.mark.parametrize("person", [PERSON, TALL])
@pytest.mark.parametrize("frames", [120, FRAMES])
def test_the_error_is_as_large_as_asked_whatever_the_dance(
    kind: str, error_m: float, person: Person, frames: int
) -> None:
    shown = part(simulated_movement.own_size(guide(kind), person), frames)
    danced = simulated_movement.copy(shown, error_m, stream(1, "copy"))
    assert distance_m(danced, shown) == pytest.approx(error_m, rel=0.01)


def test_turns_of_one_size_would_not_miss_every_dance_by_as_much() -> None:
    def missed(kind: str, frames: int) -> float:
        shown = part(guide(kind), frames)
        turns = wrong_turns(NEUTRAL_BODY.joint_names, frames, stream(1, "copy"), frame_rate_hz=30.0)
        rotations = rotation.multiply(shown.rotations, rotation.exp(0.5 * turns))
        return distance_m(replace(shown, rotations=rotations), shown)

    assert abs(missed("still", 120) / missed("made up", FRAMES) - 1.0) > 0.02


@pytest.mark.parametrize("kind", ["swinging", "made up"])
def test_bones_keep_their_length(kind: str) -> None:
    danced = simulated_movement.perform(guide(kind), TALL, 0.1, stream(1, "perform"))
    assert keeps_its_bones(joint_positions(danced), TALL)


def test_joints_that_stray_one_by_one_would_be_noticed() -> None:
    positions = joint_positions(guide("swinging"))
    strays = wrong_turns(NEUTRAL_BODY.joint_names, FRAMES, stream(1, "stray"), frame_rate_hz=30.0)
    assert keeps_its_bones(positions, PERSON)
    assert not keeps_its_bones(positions + 0.01 * strays, PERSON)


def test_without_error_and_delay_the_guide_is_danced_in_ones_own_body() -> None:
    own = simulated_movement.own_size(guide("made up"), TALL)
    danced = simulated_movement.delayed(
        simulated_movement.copy(own, 0.0, stream(1, "copy")), np.zeros(FRAMES)
    )
    np.testing.assert_allclose(joint_positions(danced), joint_positions(own), atol=1e-9)
    np.testing.assert_allclose(
        joint_positions(own), 1.1 * joint_positions(guide("made up")), rtol=0.0, atol=1e-9
    )


@pytest.mark.parametrize("intensity", ["light", "intense"])
@pytest.mark.parametrize("variety", ["easy", "hard"])
def test_who_errs_as_planted_still_dances_as_hard_as_the_guide(intensity: str, variety: str) -> None:
    shown = guide("made up")
    error_m = PAPER.movement_error.expected(f"{intensity}-{variety}-off")
    danced = simulated_movement.perform(shown, PERSON, error_m, stream(4, "perform"))

    def energies(motion: Motion) -> np.ndarray:
        centred = joint_positions(motion) - motion.root_positions[:, None]
        return np.array(
            [
                energy.linear_energy(centred, 30.0).sum(),
                energy.rotational_energy(motion.rotations, 30.0).sum(),
            ]
        )

    ratios = energies(danced) / energies(shown)
    assert np.all((ratios > 0.5) & (ratios < 2.0)), ratios


def test_hands_and_feet_stray_further_than_the_trunk() -> None:
    shown = guide("swinging")
    danced = simulated_movement.copy(shown, 0.1, stream(1, "x"))
    strays = np.linalg.norm(joint_positions(danced) - joint_positions(shown), axis=-1).mean(axis=0)
    trunk = [NEUTRAL_BODY.index(name) for name in ("pelvis", "spine1", "spine2", "spine3", "neck")]
    ends = [NEUTRAL_BODY.index(f"{side}_{name}") for side in ("left", "right") for name in ("hand", "foot")]
    assert min(strays[ends]) > 3 * max(strays[trunk])


@pytest.mark.parametrize("error_m", [-0.01, 0.5, np.nan])
def test_an_error_that_no_plausible_turns_make_is_refused(error_m: float) -> None:
    with pytest.raises(ValueError, match=r"expected 0 to 0\.1\d\d: the shoulders .* at most 1 rad"):
        simulated_movement.copy(guide("made up"), error_m, stream(1, "copy"))


@pytest.mark.parametrize("seed", range(5))
def test_even_small_people_can_err_as_much_as_anybody_is_told_to(seed: int) -> None:
    small = replace(PERSON, height_m=1.52)
    simulated_movement.perform(guide("made up"), small, LARGEST_ERROR_M, stream(seed, "perform"))


def test_a_delay_shows_earlier_poses() -> None:
    frames = np.arange(100.0)
    spinning = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=np.repeat(rotation.yaw(0.02 * frames)[:, None], 24, axis=1),
        root_positions=frames[:, None] * np.ones(3),
        frame_rate_hz=30.0,
    )
    late = simulated_movement.delayed(spinning, np.full(100, 0.25))
    at = np.maximum(frames - 7.5, 0.0)
    np.testing.assert_allclose(late.root_positions[:, 0], at)
    np.testing.assert_allclose(late.rotations[:, 5], rotation.yaw(0.02 * at), atol=1e-12)


def test_a_whole_performance_is_late_and_repeatable() -> None:
    shown = guide("swinging")
    danced = simulated_movement.perform(shown, PERSON, 0.02, stream(4, "perform"))
    again = simulated_movement.perform(shown, PERSON, 0.02, stream(4, "perform"))
    np.testing.assert_array_equal(danced.rotations, again.rotations)
    at, asked = joint_positions(danced), joint_positions(shown)
    misses = [np.linalg.norm(at[lag:] - asked[: FRAMES - lag], axis=-1).mean() for lag in range(15)]
    assert 3 <= int(np.argmin(misses)) <= 9
    assert min(misses) < 1.2 * 0.02
