"""What the camera saw of simulated people, whose true movement is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from studykit.analysis.smoothness import log_dimensionless_jerk
from studykit.choreography.dance import Dance
from studykit.core.arrays import Floats
from studykit.motion import energy, rotation
from studykit.motion.filtering import low_pass
from studykit.motion.kinematics import joint_positions
from studykit.motion.motion import JointTracks, Motion
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY
from studykit.participant.person import cohort
from studykit.reports.choices import Choices
from studykit.reports.movement_measures import (
    ENDS,
    SMOOTHNESS_CUTOFF_HZ,
    Trembling,
    movement_measures,
    trembling,
)
from studykit.session.simulated_movement import copy, perform
from studykit.session.simulated_participant import standing

RATE = 30.0
NOISE_M = 0.005
CHOICES = Choices(window="perform", maximum="tanaka", vigorous_fraction=0.7, longest_gap_s=10.0, band_s=1.0)
PERSON = cohort(4, 1)[2]


class Shown:
    """As much of a dance as measuring needs."""

    def __init__(self, seed: int, frames: int = 600) -> None:
        rng = np.random.default_rng(seed)
        time = np.arange(frames)[:, None, None] / RATE
        rates, starts = rng.uniform(1.0, 7.0, size=(24, 3)), rng.uniform(0.0, 6.0, size=(24, 3))
        sizes = np.where(np.isin(np.arange(24), [0, 3, 6, 9]), 0.1, 0.35)[:, None]
        self.motion = Motion(
            skeleton=NEUTRAL_BODY,
            rotations=rotation.exp(sizes * np.sin(rates * time + starts)),
            root_positions=np.tile([0.0, 0.95, 0.0], (frames, 1)),
            frame_rate_hz=RATE,
        )


def shown(seed: int) -> Dance:
    return Shown(seed)  # type: ignore[return-value]


def seen(positions: Floats, seed: int, *, noise_m: float = NOISE_M) -> JointTracks:
    noise = np.random.default_rng(seed).normal(0.0, noise_m, positions.shape)
    return JointTracks(
        positions=positions + noise,
        confidence=np.ones(positions.shape[:2]),
        times_s=np.arange(len(positions)) / RATE,
        joint_names=JOINT_NAMES,
    )


def still(seed: int, frames: int = 150) -> JointTracks:
    swaying = copy(standing(PERSON, frames=frames), 0.004, np.random.default_rng(seed))
    return seen(joint_positions(swaying), seed + 100)


def danced(dance: Dance, seed: int) -> Motion:
    return perform(dance.motion, PERSON, 0.06, np.random.default_rng(seed))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_energy_of_a_known_movement_is_found_through_the_trembling(seed: int) -> None:
    dance = shown(seed)
    positions = joint_positions(danced(dance, seed))
    linear = energy.linear_energy(positions - positions[:, :1], RATE)
    noise = trembling(still(seed), RATE)
    assert noise is not None
    tracks = seen(positions, seed + 50)
    found = movement_measures(tracks, 0.0, dance, CHOICES, noise=noise)
    assert found is not None
    assert found.body is not None
    assert found.body.linear_energy == pytest.approx(linear.sum(), rel=0.06)
    # Nobody sees how a limb turns about itself, so turning is compared with what a perfect camera sees.
    perfect = movement_measures(seen(positions, 0, noise_m=0.0), 0.0, dance, CHOICES)
    assert perfect is not None
    assert perfect.body is not None
    rotational = perfect.body.rotational_energy
    assert found.body.rotational_energy == pytest.approx(rotational, rel=0.12)
    np.testing.assert_allclose(
        found.body.linear_steps.sum(axis=0), linear, atol=0.1 * linear.max()
    )  # joint by joint, too
    # Without what was seen of the person standing still, the trembling counts as dancing.
    uncorrected = movement_measures(tracks, 0.0, dance, CHOICES)
    assert uncorrected is not None
    assert uncorrected.body is not None
    assert uncorrected.body.rotational_energy > 1.3 * rotational
    assert np.isnan(uncorrected.body.noise_share)
    assert 0.0 < found.body.noise_share < 0.5


def test_the_smoothness_of_a_known_movement_is_found_through_the_trembling() -> None:
    dance = shown(4)
    positions = joint_positions(danced(dance, 4))
    ends = [JOINT_NAMES.index(name) for name in ENDS]
    true = log_dimensionless_jerk(
        low_pass(positions[:, ends] - positions[:, :1], SMOOTHNESS_CUTOFF_HZ, RATE), RATE
    ).mean()
    found = movement_measures(seen(positions, 5), 0.0, dance, CHOICES, noise=trembling(still(6), RATE))
    assert found is not None
    assert found.body is not None
    assert found.body.smoothness == pytest.approx(true, abs=0.25)


def test_a_perfect_camera_has_nothing_taken_off() -> None:
    dance = shown(7)
    positions = joint_positions(dance.motion)
    noise = trembling(seen(np.repeat(positions[:1], 90, axis=0), 0, noise_m=0.0), RATE)
    assert noise is not None
    tracks = seen(positions, 0, noise_m=0.0)
    found = movement_measures(tracks, 0.0, dance, CHOICES, noise=noise)
    plain = movement_measures(tracks, 0.0, dance, CHOICES)
    assert found is not None
    assert plain is not None
    assert found.body is not None
    assert plain.body is not None
    assert found.body.noise_share == pytest.approx(0.0, abs=1e-12)
    assert found.body.linear_energy == pytest.approx(plain.body.linear_energy)
    assert found.alignment.distance_m == pytest.approx(0.0, abs=1e-9)
    assert found.alignment.lag_s == 0.0


def test_energy_never_comes_out_below_zero() -> None:
    dance = shown(8)
    quiet = seen(np.repeat(joint_positions(dance.motion)[:1], 600, axis=0), 1)
    loud = Trembling(np.ones(24), np.ones(24), np.full(4, 1e9))
    found = movement_measures(quiet, 0.0, dance, CHOICES, noise=loud)
    assert found is not None
    assert found.body is not None
    assert (found.body.linear_energy, found.body.rotational_energy) == (0.0, 0.0)
    assert np.isnan(found.body.smoothness)


def test_nothing_is_known_of_a_camera_that_saw_too_little_of_somebody_standing_still() -> None:
    assert trembling(still(1, frames=20), RATE) is None
    whole = still(1)
    hidden = whole.positions.copy()
    hidden[:, 5] = np.nan
    assert trembling(replace(whole, positions=hidden), RATE) is None


def test_a_joint_never_seen_leaves_the_distance_and_takes_the_energy() -> None:
    dance = shown(9)
    tracks = seen(joint_positions(danced(dance, 9)), 9)
    hidden = tracks.positions.copy()
    hidden[:, JOINT_NAMES.index("left_wrist")] = np.nan
    found = movement_measures(replace(tracks, positions=hidden), 0.0, dance, CHOICES)
    assert found is not None
    assert found.body is None
    assert found.alignment.distance_m > 0.0
    assert found.coverage == pytest.approx(14.0 / 15.0, abs=0.005)


def test_another_definition_and_no_band_can_be_chosen() -> None:
    dance = shown(10)
    tracks = seen(joint_positions(danced(dance, 10)), 10)
    mean = movement_measures(tracks, 0.0, dance, CHOICES)
    free = movement_measures(tracks, 0.0, dance, replace(CHOICES, band_s=None))
    other = movement_measures(tracks, 0.0, dance, replace(CHOICES, definition="tslearn"))
    assert mean is not None
    assert free is not None
    assert other is not None
    assert free.alignment.total_m <= mean.alignment.total_m * (1.0 + 1e-12)
    assert other.alignment.distance_m > 10.0 * mean.alignment.distance_m
