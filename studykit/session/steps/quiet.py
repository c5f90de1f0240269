"""Phases without a dance: calibration, baseline, training and rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from studykit.motion.kinematics import joint_positions
from studykit.participant.demands import DEMANDS
from studykit.session.plan import PlannedStep
from studykit.session.simulated_movement import copy
from studykit.session.simulated_participant import SimulatedParticipant, standing
from studykit.session.step import Reply

_FRAME_RATE_HZ = 30.0
_SWAY_M = 0.004  # mean distance of a standing person's joints from their place


@dataclass(frozen=True)
class Quiet:
    """Stand, sit or try things out for a while; the camera records while the person stands still."""

    planned: PlannedStep
    questionnaire = None

    @property
    def is_filmed(self) -> bool:
        """Whether the camera records the skeleton."""
        return self.planned.phase == "calibrate"

    def simulate(
        self, participant: SimulatedParticipant, *, start_s: float, rng: np.random.Generator
    ) -> Reply | None:
        """Spend little effort; while standing, sway a little."""
        participant.exert(DEMANDS[self.planned.phase], start_s)
        if self.is_filmed:
            frames = max(2, round((self.planned.duration_s or 0.0) * _FRAME_RATE_HZ))
            still = standing(participant.person, frames=frames, frame_rate_hz=_FRAME_RATE_HZ)
            swaying = copy(still, _SWAY_M, rng)
            participant.move(joint_positions(swaying), start_s=start_s, frame_rate_hz=_FRAME_RATE_HZ)
        return None
