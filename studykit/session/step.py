"""What every step of a visit can do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from studykit.motion.motion import Motion
from studykit.session.plan import PlannedStep
from studykit.session.simulated_participant import SimulatedParticipant


class ShownDance(Protocol):
    """What a session needs to know of a dance."""

    @property
    def condition(self) -> str:
        """Name of the condition."""
        ...

    @property
    def motion(self) -> Motion:
        """What is shown."""
        ...

    @property
    def sha256(self) -> str:
        """Digest of the dance."""
        ...


Answer = int | float | str
"""What a person can answer to one item."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Reply:
    """What a simulated person answers, and how long it takes.

    Parameters
    ----------
    answers : mapping
        Item to answer.
    seconds : float
        Time spent on it, s.
    """

    answers: Mapping[str, Answer]
    seconds: float


class Step(Protocol):
    """One step of a visit, the same for real and simulated people.

    A step says what it needs; the runner alone waits, records and asks.
    """

    @property
    def planned(self) -> PlannedStep:
        """The place in the plan that this step fills."""
        ...

    @property
    def is_filmed(self) -> bool:
        """Whether the camera records the skeleton."""
        ...

    @property
    def questionnaire(self) -> str | None:
        """The questionnaire to fill in, if it is one."""
        ...

    def simulate(
        self, participant: SimulatedParticipant, *, start_s: float, rng: np.random.Generator
    ) -> Reply | None:
        """Let a simulated person do this step from a moment on; a questionnaire gets a reply."""
        ...
