"""Watching a dance, and dancing it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from studykit.motion.kinematics import joint_positions
from studykit.participant.demands import DEMANDS
from studykit.participant.movement import LARGEST_ERROR_M, LEAST_ERROR_M
from studykit.session.plan import PlannedStep
from studykit.session.simulated_movement import perform
from studykit.session.simulated_participant import SimulatedParticipant
from studykit.session.step import Reply, ShownDance


@dataclass(frozen=True)
class Watch:
    """See the dance of a condition once."""

    planned: PlannedStep
    is_filmed = False
    questionnaire = None

    def simulate(
        self,
        participant: SimulatedParticipant,
        *,
        start_s: float,
        rng: np.random.Generator,  # noqa: ARG002 - looking leaves nothing to chance
    ) -> Reply | None:
        """Stand and look."""
        participant.exert(DEMANDS["watch"], start_s)
        return None


@dataclass(frozen=True)
class Perform:
    """Dance along with the guide: one trial."""

    planned: PlannedStep
    dance: ShownDance
    is_filmed = True
    questionnaire = None

    def simulate(
        self, participant: SimulatedParticipant, *, start_s: float, rng: np.random.Generator
    ) -> Reply | None:
        """Dance as well, and work as hard, as the planted effects say for this condition and person."""
        person, effects, condition = participant.person, participant.effects, self.dance.condition
        effort = effects.effort.draw(condition, person.exertion, rng)
        drawn_m = effects.movement_error.draw(condition, -person.skill, rng)
        error_m = min(max(drawn_m, LEAST_ERROR_M), LARGEST_ERROR_M)
        participant.exert(effort, start_s)
        danced = perform(self.dance.motion, person, error_m, rng)
        participant.move(joint_positions(danced), start_s=start_s, frame_rate_hz=danced.frame_rate_hz)
        return None
