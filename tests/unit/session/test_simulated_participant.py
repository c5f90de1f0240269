from __future__ import annotations

import numpy as np
import pytest

from studykit.motion.kinematics import joint_positions
from studykit.motion.skeleton import JOINT_NAMES
from studykit.participant.effects import PAPER
from studykit.participant.person import cohort
from studykit.session.simulated_participant import SimulatedParticipant, standing


@pytest.fixture
def participant() -> SimulatedParticipant:
    return SimulatedParticipant(cohort(2, 1)[0], PAPER, seed=1, session="01")


def test_a_movement_is_shown_between_its_frames_and_its_ends_are_held(
    participant: SimulatedParticipant,
) -> None:
    frames = np.arange(4.0)[:, None, None] * np.ones((4, 24, 3))
    participant.move(frames, start_s=10.0, frame_rate_hz=2.0)
    for time_s, expected in ((9.0, 0.0), (10.0, 0.0), (10.25, 0.5), (11.0, 2.0), (11.5, 3.0), (99.0, 3.0)):
        np.testing.assert_allclose(participant.positions_at(time_s), expected)


def test_one_stands_with_the_feet_on_the_floor_at_ones_own_height() -> None:
    small, tall = sorted(cohort(2, 1), key=lambda person: person.height_m)
    for person in (small, tall):
        positions = joint_positions(standing(person))[0]
        height = np.ptp(positions[:, 1])
        # The head joint lies below the crown.
        assert height == pytest.approx(person.height_m * 0.88, rel=0.05)
        assert positions[:, 1].min() == pytest.approx(0.0, abs=1e-12)
    assert joint_positions(standing(small))[0, JOINT_NAMES.index("left_hand"), 0] > 0.5


def test_a_heart_is_heard_after_arrival_and_follows_an_effort(participant: SimulatedParticipant) -> None:
    assert participant.beats_until(5.0) == []
    participant.arrive(100.0, part=0)
    rest = participant.beats_until(160.0)
    participant.exert(0.8, 160.0)
    effort = participant.beats_until(220.0)
    assert sum(rest) == pytest.approx(60.0, abs=2.0)
    assert np.mean(effort[-20:]) < 0.7 * np.mean(rest)


def test_chance_has_names(participant: SimulatedParticipant) -> None:
    draws = [participant.random(*name).random() for name in (("a", 1), ("a", 1), ("a", 2))]
    assert draws[0] == draws[1] != draws[2]
