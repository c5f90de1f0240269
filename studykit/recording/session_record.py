"""Reading a recorded session: who came, what happened and what was measured."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from studykit.core.arrays import Floats, frozen
from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_file
from studykit.motion.motion import JointTracks
from studykit.recording.frames import read_frames
from studykit.recording.journal import Record, read_journal
from studykit.recording.motion_bids_reader import read_motion_bids
from studykit.recording.session_data import Answers, FrameFile, SessionRecord, StepRecord

__all__ = ["Answers", "FrameFile", "SessionRecord", "StepRecord", "read_session"]


def read_session(path: Path) -> SessionRecord:
    """Read one session: from its journal, or from its Motion-BIDS files where there is none.

    Parameters
    ----------
    path : Path
        A journal, or a folder ``sub-07/ses-01/motion``; `StudyFolder.sessions` gives them.

    Raises
    ------
    InputError
        If the journal is damaged or holds no session, or the files lack what a study needs.
    """
    return read_motion_bids(path) if path.is_dir() else _read_journal(path)


@dataclass(frozen=True, kw_only=True, slots=True)
class _CameraFile:
    """Frames as the camera gave them, beside the journal."""

    path: Path
    sha256: str | None

    def tracks(self, joint_names: tuple[str, ...]) -> JointTracks:
        """Read where these joints were, on the session's clock."""
        return read_frames(self.path, joint_names)


def _read_journal(journal_path: Path) -> SessionRecord:
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
        **_beats(readings),
    )


def _beats(readings: list[Record]) -> dict[str, Floats]:
    """Give the times between beats, and when each ended: the last of a message when it came."""
    times: list[float] = []
    intervals: list[float] = []
    for reading in readings:
        sent = reading.data.get("rr_intervals_s") or ()
        first = len(times)
        ended_s = reading.time_s
        for interval_s in reversed(sent):
            times.insert(first, ended_s)
            ended_s -= interval_s
        intervals += sent
    return {
        "beat_times_s": frozen(times, shape=(None,), name="beat_times_s"),
        "beat_intervals_s": frozen(intervals, shape=(None,), name="beat_intervals_s"),
    }


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


def _frame_files(records: tuple[Record, ...], folder: Path) -> dict[int, _CameraFile]:
    sha256 = {r.data["step"]: r.data["sha256"] for r in records if r.kind == "frames_stopped"}
    return {
        r.data["step"]: _CameraFile(path=folder / r.data["file"], sha256=sha256.get(r.data["step"]))
        for r in records
        if r.kind == "frames_started"
    }
