from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.recording.frames import FrameWriter
from studykit.recording.journal import Journal
from studykit.recording.session_record import SessionRecord, read_session

STARTED: dict[str, Any] = {
    "participant": "07",
    "session": "01",
    "sequence": 3,
    "conditions": ["light-easy-on", "intense-easy-on"],
    "protocol_sha256": "ab",
    "simulated": False,
    "devices": {"camera": "c", "heart_rate": "h"},
    "utc_anchor": "2024-05-01T09:00:00.000000Z",
    "joint_names": ["pelvis", "head"],
    "dance_sha256": {"light-easy-on": "cd"},
    "versions": {},
}


def frames(path: Path, count: int) -> str:
    writer = FrameWriter(path, ("pelvis", "head"))
    for frame in range(count):
        writer.append(10.0 + frame / 30, np.full((2, 3), float(frame)), np.ones(2))
    writer.close()
    return writer.sha256


def step(number: int, phase: str, condition: str | None = None, period: int | None = None) -> dict[str, Any]:
    return {"step": number, "phase": phase, "condition": condition, "period": period}


def answers(number: int, rating: int) -> dict[str, Any]:
    about = {"questionnaire": "smoothness", "condition": "light-easy-on"}
    return {"step": number, **about, "answers": {"rating": rating}}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A visit in which a trial was interrupted, repeated, rated twice and cut off while resting."""
    path = tmp_path / "sub-07_ses-01.jsonl"
    folder = path.with_suffix("")
    with Journal.create(path) as journal:
        rows: list[tuple[float, str, dict[str, Any]]] = [
            (0.0, "session_started", STARTED),
            (0.0, "step_started", step(1, "perform", "light-easy-on", 1)),
            (0.0, "frames_started", {"step": 1, "file": "01_perform.frames"}),
            (1.0, "heart_rate", {"heart_rate_bpm": 80, "rr_intervals_s": [0.75], "contact": None}),
            (2.0, "heart_rate", {"heart_rate_bpm": None, "rr_intervals_s": [], "contact": False}),
            (3.0, "step_interrupted", {"step": 1, "reason": "the end"}),
            (9.0, "session_resumed", {"versions": {}}),
            (10.0, "step_started", step(2, "perform", "light-easy-on", 1)),
            (10.0, "frames_started", {"step": 2, "file": "02_perform.frames"}),
            (11.0, "frames_stopped", {"step": 2, "file": "02_perform.frames", "frames": 30, "sha256": ""}),
            (11.0, "step_completed", {"step": 2}),
            (11.0, "step_started", step(3, "smoothness", "light-easy-on", 1)),
            (12.0, "answers", answers(3, 2)),
            (12.0, "step_interrupted", {"step": 3, "reason": "x"}),
            (13.0, "step_started", step(4, "smoothness", "light-easy-on", 1)),
            (14.0, "answers", answers(4, 5)),
            (14.0, "step_completed", {"step": 4}),
            (14.0, "step_started", step(5, "rest", "light-easy-on", 1)),
            (16.5, "heart_rate", {"heart_rate_bpm": 70, "rr_intervals_s": [], "contact": True}),
        ]
        frames(folder / "01_perform.frames", 5)
        sha256 = frames(folder / "02_perform.frames", 30)
        for time_s, kind, data in rows:
            journal.append(
                kind, data | {"sha256": sha256} if kind == "frames_stopped" else data, time_s=time_s
            )
    return path


@pytest.fixture
def record(path: Path) -> SessionRecord:
    return read_session(path)


def test_it_says_who_came_and_what_was_planned(record: SessionRecord, path: Path) -> None:
    assert (record.participant, record.session, record.sequence, record.simulated) == ("07", "01", 3, False)
    assert record.conditions == ("light-easy-on", "intense-easy-on")
    assert record.journal == path
    assert not record.completed
    assert len(record.sha256) == 64


def test_steps_have_their_times_and_whether_they_ended(record: SessionRecord) -> None:
    assert [(s.step, s.phase, s.start_s, s.stop_s, s.is_complete) for s in record.steps] == [
        (1, "perform", 0.0, 3.0, False),
        (2, "perform", 10.0, 11.0, True),
        (3, "smoothness", 11.0, 12.0, False),
        (4, "smoothness", 13.0, 14.0, True),
        (5, "rest", 14.0, 16.5, False),
    ]


def test_a_missing_reading_is_zero(record: SessionRecord) -> None:
    assert record.heart_rate_times_s.tolist() == [1.0, 2.0, 16.5]
    assert record.heart_rate_bpm.tolist() == [80.0, 0.0, 70.0]


def test_the_later_answers_count(record: SessionRecord) -> None:
    assert record.answers_to("smoothness", condition="light-easy-on") == {"rating": 5}
    assert record.answers_to("smoothness", condition="intense-easy-on") is None
    assert record.answers_to("paces") is None
    assert len(record.answers) == 1


def test_frames_are_read_also_from_a_step_that_was_cut_off(record: SessionRecord) -> None:
    assert len(record.frames(1)) == 5
    assert len(record.frames(2)) == 30
    assert record.frames(2).joint_names == ("pelvis", "head")
    with pytest.raises(InputError, match="no frames were recorded in step 4; choose one of 1, 2"):
        record.frames(4)


def test_other_frames_than_those_recorded_are_refused(record: SessionRecord, path: Path) -> None:
    file = path.with_suffix("") / "02_perform.frames"
    file.unlink()
    with pytest.raises(InputError, match="cannot be read"):
        record.frames(2)
    frames(file, 29)
    with pytest.raises(InputError, match=r"02_perform\.frames: the frames are not those that were recorded"):
        record.frames(2)
