"""Laws of energy: what is known on paper, and that where the world lies is nobody's effort."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from studykit.choreography.dance_library import DanceLibrary
from studykit.library import make_sample
from studykit.library.rating.plan import window_measures
from studykit.motion import body, energy, kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY

metres = st.floats(-50.0, 50.0)
angles = st.floats(-10.0, 10.0)


def wandering(seed: int) -> Motion:
    rng = np.random.default_rng(seed)
    turns = rng.normal(scale=0.4, size=(1, 24, 3)) + np.cumsum(
        rng.normal(scale=0.05, size=(30, 24, 3)), axis=0
    )
    return Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.exp(turns),
        root_positions=np.cumsum(rng.normal(scale=0.02, size=(30, 3)), axis=0),
        frame_rate_hz=30.0,
    )


def energies(motion: Motion, *, centred: bool = True) -> np.ndarray:
    positions = kinematics.joint_positions(motion)
    if centred:
        positions = positions - positions[:, :1]
    return np.stack(
        (
            energy.linear_energy(positions, motion.frame_rate_hz),
            energy.rotational_energy(motion.rotations, motion.frame_rate_hz),
        )
    )


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 1000), x=metres, y=metres, z=metres, angle=angles)
def test_turning_and_moving_the_world_changes_no_energy(seed, x, y, z, angle) -> None:
    motion = wandering(seed)
    moved = kinematics.turned(motion, angle, about=np.array([x, 0.0, z]))
    moved = Motion(
        skeleton=moved.skeleton,
        rotations=moved.rotations,
        root_positions=moved.root_positions + np.array([x, y, z]),
        frame_rate_hz=moved.frame_rate_hz,
    )
    assert energies(moved) == pytest.approx(energies(motion), rel=1e-9)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000), speed=st.floats(0.5, 5.0))
def test_a_dancer_carried_along_spends_nothing_more(seed, speed) -> None:
    motion = wandering(seed)
    way = speed * np.arange(len(motion))[:, None] / 30.0 * np.array([1.0, 0.0, 0.0])
    carried = Motion(
        skeleton=motion.skeleton,
        rotations=motion.rotations,
        root_positions=motion.root_positions + way,
        frame_rate_hz=30.0,
    )
    assert energies(carried) == pytest.approx(energies(motion), rel=1e-9)
    # Wrong: positions in the world instead of from the pelvis.
    assert energies(carried, centred=False)[0].sum() > 1.1 * energies(motion)[0].sum()


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000), factor=st.sampled_from([0.5, 2.0, 3.0]))
def test_the_same_steps_in_less_time_ask_for_its_square(seed, factor) -> None:
    motion = wandering(seed)
    faster = Motion(
        skeleton=motion.skeleton,
        rotations=motion.rotations,
        root_positions=motion.root_positions,
        frame_rate_hz=30.0 * factor,
    )
    assert energies(faster) == pytest.approx(factor**2 * energies(motion), rel=1e-9)


# What follows is known on paper: 120 poses have 119 steps between them, and no step leads into the first.
FRAMES, RATE = 120, 30.0
SEGMENTS = body.segments()
LIMB = ("left_shoulder", "left_elbow", "left_wrist", "left_hand")


def turning(joint: str, angles: np.ndarray, axis: tuple[float, float, float]) -> np.ndarray:
    """Give rotations of a body that turns one joint about one axis, by these angles in rad."""
    rotations = rotation.identity(len(angles), 24)
    rotations[:, NEUTRAL_BODY.index(joint)] = rotation.exp(angles[:, None] * np.array(axis))
    return rotations


def only(joint: str, value: float) -> np.ndarray:
    values = np.zeros(24)
    values[NEUTRAL_BODY.index(joint)] = value
    return values


@pytest.mark.parametrize("joint", ["left_knee", "spine3", "right_wrist"])
@settings(max_examples=10, deadline=None)
@given(spin=st.floats(0.1, 40.0))
def test_a_rod_that_spins_evenly(joint, spin) -> None:
    rotations = turning(joint, spin * np.arange(FRAMES) / RATE, (0.48, 0.6, 0.64))
    inertia = float(SEGMENTS.inertias[NEUTRAL_BODY.index(joint)])
    expected = 119 * inertia * spin**2 / (2.0 * 24.0)
    assert energy.rotational_energy(rotations, RATE) == pytest.approx(
        only(joint, expected), rel=1e-6, abs=1e-15
    )
    # Wrong: as many steps as poses, or the time between the first and the last pose taken for 4 s.
    assert energy.rotational_energy(rotations, RATE).sum() != pytest.approx(expected * 120 / 119, rel=1e-6)


@settings(max_examples=20, deadline=None)
@given(swing=st.floats(0.05, 1.4), pace_hz=st.floats(0.2, 4.0), start=st.floats(0.0, 6.0))
def test_a_pendulum(swing, pace_hz, start) -> None:
    step = 2.0 * np.pi * pace_hz / RATE
    angles = swing * np.cos(start + step * np.arange(FRAMES))
    rotations = turning("left_hip", angles, (1.0, 0.0, 0.0))
    # Differences are -2 A sin(step / 2) sin(start + (k + 1/2) step), and
    # sum over k < N of sin^2(a + k b) = N / 2 - sin(N b) cos(2 a + (N - 1) b) / (2 sin b).
    sines = 119 / 2.0 - np.sin(119 * step) * np.cos(2.0 * start + 119 * step) / (2.0 * np.sin(step))
    squares = 4.0 * (swing * np.sin(step / 2.0) * RATE) ** 2 * sines
    inertia = float(SEGMENTS.inertias[NEUTRAL_BODY.index("left_hip")])
    assert energy.rotational_energy(rotations, RATE) == pytest.approx(
        only("left_hip", inertia * squares / 48.0), rel=1e-6, abs=1e-15
    )

    positions = kinematics.centred_positions(NEUTRAL_BODY, rotations)
    hip = NEUTRAL_BODY.index("left_hip")
    expected = np.zeros(24)
    for name in ("left_knee", "left_ankle", "left_foot"):
        joint = NEUTRAL_BODY.index(name)
        radius = float(np.linalg.norm((positions[0, joint] - positions[0, hip])[1:]))  # from an axis along X
        chords = 2.0 * radius * np.sin(np.diff(angles) / 2.0) * RATE
        expected[joint] = SEGMENTS.masses[joint] * np.sum(chords**2) / 48.0
    assert energy.linear_energy(positions, RATE) == pytest.approx(expected, rel=1e-6, abs=1e-13)


def test_a_slow_pendulum_comes_near_to_its_integral() -> None:
    """The sum over steps is the integral of the energy over time, times the frame rate."""
    swing, pace = 0.5, 2.0 * np.pi * 0.25
    angles = swing * np.sin(pace * np.arange(FRAMES) / RATE)
    measured = energy.rotational_energy(turning("left_hip", angles, (1.0, 0.0, 0.0)), RATE).sum()
    inertia = float(SEGMENTS.inertias[NEUTRAL_BODY.index("left_hip")])

    def power(time_s: float) -> float:
        # The mean velocity of a step misses how the velocity varies within it: acceleration^2 step^2 / 12.
        velocity, acceleration = pace * np.cos(pace * time_s), pace**2 * np.sin(pace * time_s)
        return inertia * swing**2 * (velocity**2 - (acceleration / RATE) ** 2 / 12.0) / 48.0

    integral, _ = quad(power, 0.0, 119 / RATE)
    assert measured == pytest.approx(integral * RATE, rel=1e-6)
    # Wrong: the first pose counted as if it went on as the next one does.
    assert measured != pytest.approx(integral * RATE * 120 / 119, rel=1e-3)


@settings(max_examples=10, deadline=None)
@given(speed=st.floats(0.2, 6.0), yaw=st.floats(-3.0, 3.0))
def test_a_limb_at_walking_speed(speed, yaw) -> None:
    way = speed * np.arange(FRAMES)[:, None] / RATE * np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    positions = np.tile(kinematics.centred_positions(NEUTRAL_BODY, rotation.identity(24)), (FRAMES, 1, 1))
    limb = [NEUTRAL_BODY.index(name) for name in LIMB]
    positions[:, limb] += way[:, None]
    expected = np.zeros(24)
    expected[limb] = 119 * SEGMENTS.masses[limb] * speed**2 / 48.0
    assert energy.linear_energy(positions, RATE) == pytest.approx(expected, rel=1e-6, abs=1e-15)
    assert expected.sum() == pytest.approx(119 * (0.028 + 0.016 + 0.003 + 0.003) * speed**2 / 48.0)

    # Everything but the pelvis, as seen from it: the whole body mass less that of the pelvis.
    positions[:, 1:] = positions[0, 1:] + way[:, None]
    whole = energy.linear_energy(positions, RATE).sum()
    assert whole == pytest.approx(119 * (1.0 - 0.142) * speed**2 / 48.0, rel=1e-6)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000), joins=st.integers(1, 4))
def test_a_take_asks_for_what_its_pieces_ask_and_for_the_steps_between_them(seed, joins) -> None:
    rng = np.random.default_rng(seed)
    pieces = [wandering(int(number)).rotations for number in rng.integers(1000, size=joins + 1)]
    together = np.concatenate(pieces)
    positions = kinematics.centred_positions(NEUTRAL_BODY, together)
    apart = [
        (
            energy.linear_energy(kinematics.centred_positions(NEUTRAL_BODY, piece), RATE),
            energy.rotational_energy(piece, RATE),
        )
        for piece in pieces
    ]
    between = np.zeros((2, 24))
    for join in 30 * np.arange(1, joins + 1):
        jump = np.sum((positions[join] - positions[join - 1]) ** 2, axis=-1) * RATE**2
        turn = np.sum(rotation.between(together[join - 1], together[join]) ** 2, axis=-1) * RATE**2
        between += np.stack((SEGMENTS.masses * jump, SEGMENTS.inertias * turn)) / 48.0
    measured = np.stack((energy.linear_energy(positions, RATE), energy.rotational_energy(together, RATE)))
    assert measured == pytest.approx(np.sum(apart, axis=0) + between, rel=1e-9, abs=1e-15)
    # Wrong: joins counted as dancing. A jump between unrelated poses counts like much of a second of dancing.
    assert measured.sum() > 1.1 * np.sum(apart)


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> DanceLibrary:
    return make_sample(tmp_path_factory.mktemp("libraries") / "sample", segments=20, seed=3)


def test_a_library_holds_the_energy_of_119_steps_of_each_segment(library) -> None:
    for segment in range(0, len(library), 3):
        own = energies(library.motion(segment))
        held = np.stack((library.linear_energies[segment], library.rotational_energies[segment]))
        # Rotations are kept in single precision.
        assert held == pytest.approx(own, rel=2e-4, abs=1e-9)
        # Wrong: the pose before the first taken for the last, as if the segment were a loop.
        motion = library.motion(segment)
        loop = Motion(
            skeleton=motion.skeleton,
            rotations=np.concatenate((motion.rotations[-1:], motion.rotations)),
            root_positions=np.concatenate((motion.root_positions[-1:], motion.root_positions)),
            frame_rate_hz=motion.frame_rate_hz,
        )
        assert energies(loop).sum() > 1.001 * held.sum()


def test_what_precedes_a_segment_does_not_count(library) -> None:
    """Neighbours of a take follow each other without a gap, yet each asks for its own 119 steps alone."""
    table = library.segments
    take = table.index[table["take"] == table["take"].iloc[0]].to_numpy()[:3]
    rotations = np.concatenate([np.asarray(library.rotations[int(segment)]) for segment in take])
    apart = library.rotational_energies[take].sum()
    whole = energy.rotational_energy(rotations, RATE).sum()
    steps = np.sum(rotation.between(rotations[119:-1:120], rotations[120::120]) ** 2, axis=-1) * RATE**2
    assert whole - float((SEGMENTS.inertias * steps).sum() / 48.0) == pytest.approx(apart, rel=1e-4)


def test_a_chain_asks_for_the_sum_of_its_segments_in_any_order(library) -> None:
    chain = np.array([5, 2, 11, 7, 2, 16, 0, 9])
    measured = window_measures(library, np.stack((chain, chain[::-1])))
    for name, held in (
        ("linear_energy", library.linear_energies),
        ("rotational_energy", library.rotational_energies),
    ):
        assert measured[name] == pytest.approx(np.full(2, held[chain].sum()), rel=1e-12)
