"""A simulated person before the devices: a body that the camera sees and a heart that the belt hears."""

from __future__ import annotations

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.seeding import stream
from studykit.motion import rotation
from studykit.motion.kinematics import centred_positions, joint_positions
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY
from studykit.participant.effects import Effects
from studykit.participant.heart_rate_kinetics import Heart
from studykit.participant.person import Person
from studykit.session.simulated_movement import own_size


class SimulatedParticipant:
    """Somebody who stands before the simulated devices and does what each step asks.

    Parameters
    ----------
    person : Person
        Who it is.
    effects : Effects
        What is planted.
    seed : int
        Grows all chance in this person's visit.
    session : str
        Which visit it is.
    """

    def __init__(self, person: Person, effects: Effects, *, seed: int, session: str) -> None:
        self.person, self.effects = person, effects
        self._seed, self._session = seed, session
        self._frames = joint_positions(standing(person))
        self._start_s, self._frame_rate_hz = 0.0, 1.0
        self._heart: Heart | None = None

    def random(self, *purpose: str | int) -> np.random.Generator:
        """Give the chance of one purpose in this visit."""
        return stream(self._seed, "session", self.person.id, self._session, *purpose)

    def arrive(self, time_s: float, *, part: int) -> None:
        """Begin to be watched, rested; `part` counts how often the visit was begun or resumed."""
        self._heart = Heart(self.person, self.random("heart", part), start_s=time_s)

    def exert(self, demand: float, time_s: float) -> None:
        """Spend a share of the heart-rate reserve, 0 (rest) to 1 (all out), from a moment on."""
        if self._heart is not None:
            self._heart.exert(demand, time_s)

    def beats_until(self, time_s: float) -> list[float]:
        """Give the RR intervals, s, of the beats since the last call, oldest first."""
        return self._heart.beats_until(time_s) if self._heart is not None else []

    def move(self, frames: Floats, *, start_s: float, frame_rate_hz: float) -> None:
        """Move as told from a moment on, and then hold the last pose.

        Parameters
        ----------
        frames : ndarray, shape (frame, joint, 3), m
            Where the joints are.
        start_s : float
            When it begins, s.
        frame_rate_hz : float
            Frames a second.
        """
        self._frames, self._start_s, self._frame_rate_hz = frames, start_s, frame_rate_hz

    def positions_at(self, time_s: float) -> Floats:
        """Give where the joints truly are, shape (joint, 3), m."""
        last = len(self._frames) - 1
        at = min(max((time_s - self._start_s) * self._frame_rate_hz, 0.0), last)
        before = int(at)
        share = at - before
        after = min(before + 1, last)
        return np.asarray((1.0 - share) * self._frames[before] + share * self._frames[after])


def standing(person: Person, *, frames: int = 1, frame_rate_hz: float = 30.0) -> Motion:
    """Let a person stand still with the arms held out, feet on the floor.

    Parameters
    ----------
    person : Person
        Who stands.
    frames : int, optional
        For how many frames.
    frame_rate_hz : float, optional
        Frames a second.

    Returns
    -------
    Motion
        In the person's own size.
    """
    still = rotation.identity(frames, len(NEUTRAL_BODY.joint_names))
    root = np.zeros((frames, 3))
    root[:, 1] = -centred_positions(NEUTRAL_BODY, still[0])[:, 1].min()
    motion = Motion(skeleton=NEUTRAL_BODY, rotations=still, root_positions=root, frame_rate_hz=frame_rate_hz)
    return own_size(motion, person)
