"""What a visit runs with: a clock, devices, and whoever asks and answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from studykit.core.clock import Clock
from studykit.core.errors import InputError
from studykit.devices.clock import RealClock, SimulatedClock
from studykit.devices.depth_camera import CameraFrame
from studykit.devices.device import Device
from studykit.devices.heart_rate import HeartRateSample
from studykit.devices.simulated import SimulatedDepthCamera, SimulatedHeartRateBelt
from studykit.session.simulated_participant import SimulatedParticipant
from studykit.session.state import SessionState
from studykit.session.step import Answer

_PAUSE_S = 60.0  # a simulated visit is resumed so long after it was interrupted


class Questions(Protocol):
    """Whoever hands out questionnaires and brings back the answers."""

    async def ask(self, questionnaire: str, condition: str | None) -> Mapping[str, Answer]:
        """Wait until the participant has answered every item."""
        ...


@dataclass(frozen=True, kw_only=True)
class Equipment:
    """What the user gives.

    Parameters
    ----------
    camera, heart_rate : Device or "simulated"
        What measures.
    clock : Clock or None
        The clock of the devices.
    questions : Questions or None
        Who asks.
    """

    camera: Device[CameraFrame] | str
    heart_rate: Device[HeartRateSample] | str
    clock: Clock | None
    questions: Questions | None

    def __post_init__(self) -> None:
        for device in (self.camera, self.heart_rate):
            if isinstance(device, str) and device != "simulated":
                raise InputError(
                    f'there is no device "{device}"', remedy='give "simulated" or a device of your own'
                )
        if not self.is_all_simulated and self.questions is None:
            raise InputError(
                "nobody asks the questionnaires", where="questions", remedy="say who hands them out"
            )

    @property
    def is_all_simulated(self) -> bool:
        """Whether nothing real takes part."""
        return isinstance(self.camera, str) and isinstance(self.heart_rate, str)


@dataclass(frozen=True, kw_only=True)
class Setting:
    """What a visit runs with, ready for use.

    Parameters
    ----------
    clock : Clock
        Time.
    camera : Device of CameraFrame
        Sees the skeleton.
    heart_rate : Device of HeartRateSample
        Hears the heart.
    participant : SimulatedParticipant or None
        Who stands before simulated devices.
    questions : Questions or None
        Who asks; without, the simulated participant answers.
    """

    clock: Clock
    camera: Device[CameraFrame]
    heart_rate: Device[HeartRateSample]
    participant: SimulatedParticipant | None
    questions: Questions | None

    @property
    def is_simulated(self) -> bool:
        """Whether any part of it is simulated."""
        return self.camera.simulated or self.heart_rate.simulated


def set_up(equipment: Equipment, participant: SimulatedParticipant, state: SessionState) -> Setting:
    """Put together what a visit runs with, from the start or from where it was left.

    Parameters
    ----------
    equipment : Equipment
        What the user gives.
    participant : SimulatedParticipant
        Who stands before the devices that are simulated.
    state : SessionState
        How far the visit has come.
    """
    clock = equipment.clock
    if clock is None and equipment.is_all_simulated:
        clock = SimulatedClock(start_s=state.time_s + (_PAUSE_S if state.started else 0.0))
    elif clock is None:
        clock = RealClock(utc_anchor=state.started.get("utc_anchor"), not_before_s=state.time_s)
    part = state.steps_begun  # chance goes on anew when a visit is resumed
    camera, belt = equipment.camera, equipment.heart_rate
    if isinstance(belt, str):
        participant.arrive(clock.now_s(), part=part)
        belt = SimulatedHeartRateBelt(clock, participant, participant.random("belt", part))
    if isinstance(camera, str):
        camera = SimulatedDepthCamera(clock, participant, participant.random("camera", part))
    has_simulation = isinstance(equipment.camera, str) or isinstance(equipment.heart_rate, str)
    return Setting(
        clock=clock,
        camera=camera,
        heart_rate=belt,
        participant=participant if has_simulation else None,
        questions=equipment.questions,
    )
