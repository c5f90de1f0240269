from __future__ import annotations

from typing import Any

import pytest

from studykit.recording.journal import Record
from studykit.session.state import SessionState, replay, transition

STARTED = ("session_started", {"participant": "01"})


def records(*events: tuple[str, dict[str, Any]]) -> list[Record]:
    return [
        Record(number=number, time_s=float(number), kind=kind, data=data, sha256="")
        for number, (kind, data) in enumerate(events, start=1)
    ]


def step(kind: str, number: int) -> tuple[str, dict[str, Any]]:
    return kind, {"step": number}


def test_a_session_goes_from_its_start_to_its_end() -> None:
    events = records(
        STARTED,
        step("step_started", 1),
        step("frames_started", 1),
        ("heart_rate", {"heart_rate_bpm": 60}),
        step("frames_stopped", 1),
        step("step_completed", 1),
        step("step_started", 2),
        ("answers", {"step": 2}),
        step("step_completed", 2),
        ("session_completed", {}),
    )
    states = [replay(events[:count]) for count in range(len(events) + 1)]
    assert states[0] == SessionState()
    assert [state.open_step for state in states] == [None, None, 1, 1, 1, 1, None, 2, 2, None, None]
    assert [state.open_frames for state in states] == [None] * 3 + [1, 1] + [None] * 6
    assert [state.steps_completed for state in states] == [0] * 6 + [1, 1, 1, 2, 2]
    assert states[-1].is_completed
    assert states[-1].time_s == 10.0
    assert states[-1].started == {"participant": "01"}


def test_an_interrupted_step_is_not_done_and_its_repetition_has_a_new_number() -> None:
    events = records(
        STARTED,
        step("step_started", 1),
        step("frames_started", 1),
        step("step_interrupted", 1),
        ("session_resumed", {}),
        step("step_started", 2),
    )
    state = replay(events)
    assert (state.steps_completed, state.steps_begun, state.open_step, state.open_frames) == (0, 2, 2, None)


def test_a_state_is_never_changed_in_place() -> None:
    before = SessionState()
    transition(before, records(STARTED)[0])
    assert before == SessionState()


@pytest.mark.parametrize(
    ("before", "event"),
    [
        ([], step("step_started", 1)),
        ([STARTED], STARTED),
        ([STARTED], step("step_started", 2)),
        ([STARTED], step("step_completed", 1)),
        ([STARTED, step("step_started", 1)], step("step_started", 2)),
        ([STARTED, step("step_started", 1)], step("step_completed", 2)),
        ([STARTED, step("step_started", 1)], ("session_completed", {})),
        ([STARTED, step("step_started", 1), step("frames_started", 1)], step("step_completed", 1)),
        ([STARTED, step("step_started", 1)], step("frames_stopped", 1)),
        ([STARTED], ("answers", {"step": 1})),
        ([STARTED, ("session_completed", {})], ("heart_rate", {})),
    ],
)
def test_what_cannot_follow_is_refused(
    before: list[tuple[str, dict[str, Any]]], event: tuple[str, dict[str, Any]]
) -> None:
    *earlier, last = records(*before, event)
    state = replay(earlier)
    with pytest.raises(ValueError, match=f"{event[0]}.*cannot follow"):
        transition(state, last)
