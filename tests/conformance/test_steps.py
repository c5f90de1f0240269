"""Every step of a visit does what the runner counts on."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from studykit.participant.effects import NONE, PAPER
from studykit.participant.person import cohort
from studykit.session.plan import PHASES, PlannedStep
from studykit.session.simulated_participant import SimulatedParticipant
from studykit.session.step import Step
from studykit.session.steps import build
from studykit.session.steps.question import ITEMS, check

CONDITION = "intense-easy-on"


@pytest.fixture(params=PHASES)
def step(request: pytest.FixtureRequest, small_dances: dict[str, Any]) -> Step:
    phase = request.param
    is_question = phase in ITEMS
    return build(
        PlannedStep(
            phase=phase,
            condition=CONDITION if phase in ("watch", "perform", "smoothness", "rest") else None,
            period=1,
            duration_s=None if is_question else 4.0,
        ),
        small_dances,
    )


def participant() -> SimulatedParticipant:
    somebody = SimulatedParticipant(cohort(3, 1)[1], PAPER, seed=3, session="01")
    somebody.arrive(0.0, part=0)
    return somebody


def test_it_fills_its_place_in_the_plan(step: Step) -> None:
    assert step.planned.phase in PHASES
    assert step.is_filmed == (step.planned.phase in ("calibrate", "perform"))
    assert (step.questionnaire is not None) == (step.planned.duration_s is None)


def test_it_can_simulate_itself(step: Step) -> None:
    somebody = participant()
    reply = step.simulate(somebody, start_s=50.0, rng=np.random.default_rng(1))
    if step.questionnaire is None:
        assert reply is None
    else:
        assert reply is not None
        assert reply.seconds > 0.0
        check(step.questionnaire, reply.answers)
    beats = somebody.beats_until(80.0)
    assert 20 < len(beats) < 240
    assert somebody.positions_at(52.0).shape == (24, 3)
    assert np.all(np.isfinite(somebody.positions_at(52.0)))


def test_the_same_chance_gives_the_same_again(step: Step) -> None:
    first, again = participant(), participant()
    replies = [
        step.simulate(somebody, start_s=0.0, rng=np.random.default_rng(1)) for somebody in (first, again)
    ]
    assert replies[0] == replies[1]
    assert first.beats_until(30.0) == again.beats_until(30.0)
    np.testing.assert_array_equal(first.positions_at(1.5), again.positions_at(1.5))


def test_dancing_moves_the_body_and_the_heart_and_standing_does_not(small_dances: dict[str, Any]) -> None:
    moved, beats = {}, {}
    for phase in ("calibrate", "perform"):
        planned = PlannedStep(phase=phase, condition=CONDITION, period=1, duration_s=4.0)
        somebody = participant()
        build(planned, small_dances).simulate(somebody, start_s=0.0, rng=np.random.default_rng(1))
        track = np.array([somebody.positions_at(time_s) for time_s in np.arange(0.5, 4.0, 0.1)])
        moved[phase] = np.ptp(track, axis=0).max()
        beats[phase] = len(somebody.beats_until(60.0))
    assert moved["calibrate"] < 0.06
    assert moved["perform"] > 0.2
    assert beats["perform"] > 1.3 * beats["calibrate"]


def test_without_planted_effects_a_dance_is_no_harder_than_another(small_dances: dict[str, Any]) -> None:
    beats = []
    for condition in small_dances:
        planned = PlannedStep(phase="perform", condition=condition, period=1, duration_s=4.0)
        somebody = SimulatedParticipant(cohort(3, 1)[1], NONE, seed=3, session="01")
        somebody.arrive(0.0, part=0)
        build(planned, small_dances).simulate(somebody, start_s=0.0, rng=np.random.default_rng(1))
        beats.append(somebody.beats_until(30.0))
    assert beats[0] == beats[1]
