"""How far a session has come, worked out from what its journal says."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import reduce
from typing import Any

from studykit.recording.journal import Record


@dataclass(frozen=True, kw_only=True, slots=True)
class SessionState:
    """How far a session has come.

    Parameters
    ----------
    started : mapping
        What the record ``session_started`` says; empty before it.
    steps_begun : int
        How many steps have begun, repetitions included: the number of the latest.
    steps_completed : int
        How many steps of the plan are done: the place of the next one, from 0.
    open_step : int or None
        The step that has begun and not ended.
    open_frames : int or None
        The step whose frames are being written.
    time_s : float
        When the latest record was written, s.
    is_completed : bool
        Whether the session reached its end.
    """

    started: Mapping[str, Any] = field(default_factory=dict)
    steps_begun: int = 0
    steps_completed: int = 0
    open_step: int | None = None
    open_frames: int | None = None
    time_s: float = 0.0
    is_completed: bool = False


def transition(state: SessionState, event: Record) -> SessionState:
    """Give the state after an event.

    Parameters
    ----------
    state : SessionState
        The state before it.
    event : Record
        A record of the journal.

    Raises
    ------
    ValueError
        If the event cannot follow.
    """
    _check(state, event)
    step = event.data.get("step")
    changes: dict[str, Any] = {}
    match event.kind:
        case "session_started":
            changes = {"started": event.data}
        case "step_started":
            changes = {"steps_begun": step, "open_step": step}
        case "step_completed":
            changes = {"steps_completed": state.steps_completed + 1, "open_step": None}
        case "step_interrupted":
            changes = {"open_step": None, "open_frames": None}
        case "frames_started" | "frames_stopped":
            changes = {"open_frames": step if event.kind == "frames_started" else None}
        case "session_completed":
            changes = {"is_completed": True}
    # heart_rate, answers and session_resumed are samples and remarks
    return replace(state, time_s=max(state.time_s, event.time_s), **changes)


def replay(records: Iterable[Record]) -> SessionState:
    """Give the state of a session from its journal's records."""
    return reduce(transition, records, SessionState())


def _check(state: SessionState, event: Record) -> None:
    """Refuse what cannot follow."""
    step = event.data.get("step")
    is_allowed = {
        "session_started": not state.started,
        "step_started": state.open_step is None and step == state.steps_begun + 1,
        "step_completed": state.open_step is not None and step == state.open_step and not state.open_frames,
        "step_interrupted": state.open_step is not None and step == state.open_step,
        "frames_started": state.open_step is not None and step == state.open_step and not state.open_frames,
        "frames_stopped": state.open_frames is not None and step == state.open_frames,
        "answers": state.open_step is not None,
        "session_completed": state.open_step is None,
    }.get(event.kind, True)
    if state.is_completed or not is_allowed or (not state.started and event.kind != "session_started"):
        raise ValueError(f"{event.kind} {step or ''} cannot follow in record {event.number}")
