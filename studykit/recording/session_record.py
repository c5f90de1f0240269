"""A recorded session, read from its journal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studykit.core.arrays import Floats, frozen
from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_file
from studykit.motion.motion import JointTracks
from studykit.recording.frames import read_frames
from studykit.recording.journal import Record, read_journal


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
    """

    step: int
    phase: str
    condition: str | None
    period: int | None
    start_s: float
    stop_s: float
    is_complete: bool


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
        Where it was read from.
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
    answers : tuple of Answers
        Questionnaires; where one was filled in twice, the later one.
    completed : bool
        Whether the session reached its end.
    sha256 : str
        Digest of the journal file.
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
        tracks = read_frames(recorded.path, self.joint_names)
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


@dataclass(frozen=True, kw_only=True, slots=True)
class FrameFile:
    """A file of frames; its digest is unknown if the recording was cut off."""

    path: Path
    sha256: str | None


def read_session(journal_path: Path) -> SessionRecord:
    """Read one session from its journal.

    Raises
    ------
    InputError
        If the journal is damaged or holds no session.
    """
    records = read_journal(journal_path)
    if not records or records[0].kind != "session_started":
        raise InputError(
            "the journal holds no session yet", where=journal_path, remedy="run the session again"
        )
    started = records[0].data
    readings = [record for record in records if record.kind == "heart_rate"]
    return SessionRecord(
        journal=journal_path,
        participant=started["participant"],
        session=started["session"],
        sequence=started["sequence"],
        conditions=tuple(started["conditions"]),
        simulated=started["simulated"],
        protocol_sha256=started["protocol_sha256"],
        dance_sha256=started["dance_sha256"],
        devices=started["devices"],
        joint_names=tuple(started["joint_names"]),
        utc_anchor=started["utc_anchor"],
        steps=_steps(records),
        heart_rate_times_s=frozen([r.time_s for r in readings], shape=(None,), name="heart_rate_times_s"),
        heart_rate_bpm=frozen(
            [r.data["heart_rate_bpm"] or 0.0 for r in readings], shape=(None,), name="heart_rate_bpm"
        ),
        answers=_answers(records),
        completed=records[-1].kind == "session_completed",
        sha256=sha256_of_file(journal_path),
        frame_files=_frame_files(records, journal_path.with_suffix("")),
    )


def _steps(records: tuple[Record, ...]) -> tuple[StepRecord, ...]:
    starts = {r.data["step"]: r for r in records if r.kind == "step_started"}
    ends = {r.data["step"]: r for r in records if r.kind in ("step_completed", "step_interrupted")}
    last_s = max(record.time_s for record in records)
    return tuple(
        StepRecord(
            step=step,
            phase=start.data["phase"],
            condition=start.data["condition"],
            period=start.data["period"],
            start_s=start.time_s,
            stop_s=ends[step].time_s if step in ends else last_s,
            is_complete=step in ends and ends[step].kind == "step_completed",
        )
        for step, start in starts.items()
    )


def _answers(records: tuple[Record, ...]) -> tuple[Answers, ...]:
    latest = {
        (r.data["questionnaire"], r.data["condition"]): r.data["answers"]
        for r in records
        if r.kind == "answers"
    }
    return tuple(
        Answers(questionnaire=questionnaire, condition=condition, answers=answers)
        for (questionnaire, condition), answers in latest.items()
    )


def _frame_files(records: tuple[Record, ...], folder: Path) -> dict[int, FrameFile]:
    sha256 = {r.data["step"]: r.data["sha256"] for r in records if r.kind == "frames_stopped"}
    return {
        r.data["step"]: FrameFile(path=folder / r.data["file"], sha256=sha256.get(r.data["step"]))
        for r in records
        if r.kind == "frames_started"
    }
