"""What was recorded in one session, wherever it was read from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_file
from studykit.motion.motion import JointTracks


@dataclass(frozen=True, kw_only=True, slots=True)
class StepRecord:
    """One step of a session, as it went.

    Parameters
    ----------
    step : int
        1, 2, 3 ... in the order of time; a repeated step has a number of its own.
    phase : str
        calibrate, baseline, train, watch, perform, rest, smoothness, paces or demographics.
    condition : str or None
        The condition, where the phase belongs to one.
    period : int or None
        Which condition of the session it was, from 1.
    start_s, stop_s : float
        When it began and ended, s from the start of the recording.
    is_complete : bool
        False if it was interrupted.
    exclusion_reason : str or None
        Why whoever recorded it says that it must not be analysed; None if nobody says so.
    """

    step: int
    phase: str
    condition: str | None
    period: int | None
    start_s: float
    stop_s: float
    is_complete: bool
    exclusion_reason: str | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Answers:
    """A questionnaire that was filled in.

    Parameters
    ----------
    questionnaire : str
        smoothness, paces or demographics.
    condition : str or None
        The condition that it is about, if it is about one.
    answers : mapping
        Item to answer.
    """

    questionnaire: str
    condition: str | None
    answers: Mapping[str, Any]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SessionRecord:
    """Everything that was recorded in one session.

    Parameters
    ----------
    journal : Path
        Where it was read from: the journal, or the folder of its Motion-BIDS files.
    participant, session : str
        Whose visit, and which.
    sequence : int
        The row of the square that gave the order, from 1.
    conditions : tuple of str
        The conditions in the order in which they were due.
    simulated : bool
        Whether a device was simulated.
    protocol_sha256 : str
        Digest of the protocol followed.
    dance_sha256 : mapping
        Condition to the digest of the dance that was shown.
    devices : mapping
        What measured: ``camera`` and ``heart_rate`` to a name.
    joint_names : tuple of str
        The joints of the frames.
    utc_anchor : str
        The moment that is zero on the session's clock.
    steps : tuple of StepRecord
        What happened, repeated and interrupted steps included.
    heart_rate_times_s : ndarray, shape (reading,), s
        When each reading came.
    heart_rate_bpm : ndarray, shape (reading,), beats/min
        The readings; 0 where the belt had none.
    beat_times_s : ndarray, shape (beat,), s
        When each time between beats ended; none if the belt does not send them.
    beat_intervals_s : ndarray, shape (beat,), s
        The times between beats (RR), as they came.
    answers : tuple of Answers
        Questionnaires; where one was filled in twice, the later one.
    completed : bool
        Whether the session reached its end.
    sha256 : str
        Digest of the journal, or of the files that stand for it.
    frame_files : mapping
        Step to the file of what the camera saw in it.
    """

    journal: Path
    participant: str
    session: str
    sequence: int
    conditions: tuple[str, ...]
    simulated: bool
    protocol_sha256: str
    dance_sha256: Mapping[str, str]
    devices: Mapping[str, str]
    joint_names: tuple[str, ...]
    utc_anchor: str
    steps: tuple[StepRecord, ...]
    heart_rate_times_s: Floats
    heart_rate_bpm: Floats
    answers: tuple[Answers, ...]
    completed: bool
    sha256: str
    frame_files: Mapping[int, FrameFile]
    beat_times_s: Floats = field(default_factory=lambda: np.empty(0))
    beat_intervals_s: Floats = field(default_factory=lambda: np.empty(0))

    def frames(self, step: int) -> JointTracks:
        """Read the skeleton that was recorded during a step.

        Raises
        ------
        InputError
            If nothing was recorded, or the file is not what was recorded.
        """
        if step not in self.frame_files:
            raise InputError(
                f"no frames were recorded in step {step}",
                where=self.journal,
                remedy=f"choose one of {', '.join(map(str, self.frame_files)) or 'none'}",
            )
        recorded = self.frame_files[step]
        tracks = recorded.tracks(self.joint_names)
        if recorded.sha256 is not None and sha256_of_file(recorded.path) != recorded.sha256:
            raise InputError(
                "the frames are not those that were recorded",
                where=recorded.path,
                remedy="restore the file from a copy of the study",
            )
        return tracks

    def answers_to(self, questionnaire: str, *, condition: str | None = None) -> Mapping[str, Any] | None:
        """Give the answers to a questionnaire, or None if it was not filled in."""
        return next(
            (
                given.answers
                for given in self.answers
                if given.questionnaire == questionnaire and given.condition == condition
            ),
            None,
        )


class FrameFile(Protocol):
    """A file of frames; its digest is unknown if the recording was cut off."""

    @property
    def path(self) -> Path:
        """Where it lies."""
        ...

    @property
    def sha256(self) -> str | None:
        """Digest of what was recorded."""
        ...

    def tracks(self, joint_names: tuple[str, ...]) -> JointTracks:
        """Read where these joints were, on the session's clock."""
        ...
