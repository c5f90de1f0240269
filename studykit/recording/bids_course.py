"""What happened in a session and when, from the events of a BIDS data set."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

from studykit.core.errors import InputError, nearest
from studykit.recording import bids_lookup
from studykit.recording.joint_channels import JointChannels, joint_channels
from studykit.recording.session_data import StepRecord

PERFORM = "perform"
_NOT_TOLD = 0
_ABOUT_THE_RECORDING = frozenset({"sub", "ses", "tracksys", "recording"})


@dataclass(frozen=True, kw_only=True, slots=True)
class Film:
    """One file of movement: its channels, when it began (s on the session's clock) and its steps."""

    path: Path
    channels: JointChannels
    zero_s: float
    steps: tuple[StepRecord, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class Course:
    """A session in time.

    Parameters
    ----------
    steps : tuple of StepRecord
        Everything that happened, in order, on the session's clock.
    films : tuple of Film
        What was recorded of it.
    zeros_s : mapping
        What tells recordings of a session apart in their names, to when they began, s.
    scans : mapping
        The rows of the table of scans, by the name of their file.
    """

    steps: tuple[StepRecord, ...]
    films: tuple[Film, ...]
    zeros_s: Mapping[frozenset[tuple[str, str]], float]
    scans: Mapping[str, bids_lookup.Row]

    def zero_s(self, path: Path) -> float:
        """Give when the recording that a file accompanies began; files about the whole session begin at 0."""
        return self.zeros_s.get(_key(path), 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class _Recording:
    """Events of one recording, on its own clock."""

    events: Path
    steps: tuple[StepRecord, ...]
    motion: Path | None
    channels: JointChannels | None


def course(folder: Path, root: Path, conditions: Sequence[str]) -> Course:
    """Put the recordings of a session in order.

    If one table of events tells the course of the whole session, its clock is the session's, and other
    recordings are placed by the steps that they share with it. Otherwise ``acq_time`` in the table of scans
    tells when each began.

    Parameters
    ----------
    folder : Path
        Where the session's files of movement lie.
    root : Path
        The data set.
    conditions : sequence of str
        Those of the study.

    Raises
    ------
    InputError
        Naming the file and field that is missing or wrong.
    """
    recordings = _recordings(folder, root, conditions)
    scans = _scans(folder.parent)
    if not any(_danced(recording.steps) for recording in recordings):
        raise InputError(
            f'no trial_type is "{PERFORM}"',
            where=recordings[0].events if recordings else folder,
            remedy=f'write "{PERFORM}" for dancing along with the guide',
        )
    whole = next((r for r in recordings if r.motion is None and len(_danced(r.steps)) > 1), None)
    if whole is not None:
        steps = _numbered(whole.steps)
        others = [r for r in recordings if r is not whole]
        shared = _shared_steps(others, steps)
        zeros = [pair[0][1].start_s - pair[0][0].start_s if pair else None for pair in shared]
        films = _films(others, zeros, [[step for _, step in pair] for pair in shared])
    else:
        others = recordings
        zeros = _by_acquisition(recordings, scans)
        placed = [[_moved(step, zero) for step in r.steps] for r, zero in zip(recordings, zeros, strict=True)]
        steps = _numbered([step for one in placed for step in one])
        films = _films(recordings, zeros, [[_same(step, steps) for step in one] for one in placed])
    known = {_key(r.events): zero for r, zero in zip(others, zeros, strict=True) if zero is not None}
    return Course(
        steps=tuple(_judged(step, films, scans) for step in steps), films=films, zeros_s=known, scans=scans
    )


def _recordings(folder: Path, root: Path, conditions: Sequence[str]) -> list[_Recording]:
    names = {_letters(name): name for name in conditions}
    recordings, claimed = [], set()
    for motion in sorted(folder.glob("*_motion.tsv")):
        channels = joint_channels(motion, root)
        told = bids_lookup.about(motion, root, "events.tsv")
        if channels is None:
            continue
        if not told:
            raise InputError(
                "no table tells what happened in it", where=motion, remedy="add its *_events.tsv"
            )
        claimed.add(told[-1])
        steps = _told(told[-1], names)
        recordings.append(_Recording(events=told[-1], steps=steps, motion=motion, channels=channels))
    recordings += [
        _Recording(events=path, steps=_told(path, names), motion=None, channels=None)
        for path in sorted(folder.glob("*_events.tsv"))
        if path not in claimed
    ]
    return recordings


def _told(path: Path, names: Mapping[str, str]) -> tuple[StepRecord, ...]:
    """Read a table of events."""
    steps = []
    for line, row in enumerate(bids_lookup.rows(path), start=2):
        for column in ("trial_type", "condition"):
            if column not in row:
                raise InputError(
                    f'the column "{column}" is missing',
                    where=path,
                    remedy="add it: the phase and the condition",
                )
        start_s = bids_lookup.number(row, "onset", path, line=line)
        duration_s = bids_lookup.number(row, "duration", path, line=line)
        period, step = row.get("period"), row.get("step")
        steps.append(
            StepRecord(
                step=_NOT_TOLD if step is None else int(bids_lookup.number(row, "step", path, line=line)),
                phase=row["trial_type"] or "",
                condition=_condition(row, names, f"{path}, line {line}"),
                period=None if period is None else int(bids_lookup.number(row, "period", path, line=line)),
                start_s=start_s,
                stop_s=start_s + duration_s,
                is_complete=bids_lookup.truth(row.get("is_complete"), default=True),
            )
        )
    return tuple(steps)


def _condition(row: bids_lookup.Row, names: Mapping[str, str], where: str) -> str | None:
    told = row["condition"]
    if told is not None and _letters(told) in names:
        return names[_letters(told)]
    if told is None and row["trial_type"] != PERFORM:
        return None
    raise InputError(
        f'"condition" is "{told or "n/a"}"', where=where, remedy=nearest(told or "", names.values())
    )


def _letters(name: str) -> str:
    return re.sub(r"[^a-z]", "", name.lower())


def _danced(steps: Sequence[StepRecord]) -> list[StepRecord]:
    return [step for step in steps if step.phase == PERFORM]


def _numbered(steps: Sequence[StepRecord]) -> tuple[StepRecord, ...]:
    """Put steps in order and give numbers and periods to those that have none."""
    ordered = sorted(steps, key=lambda step: (step.start_s, step.step))
    has_numbers = len({step.step for step in ordered} - {_NOT_TOLD}) == len(ordered)
    by_first = {c: n for n, c in enumerate(dict.fromkeys(s.condition for s in _danced(ordered)), start=1)}
    return tuple(
        replace(
            step,
            step=step.step if has_numbers else number,
            period=step.period if step.period is not None else by_first.get(step.condition),
        )
        for number, step in enumerate(ordered, start=1)
    )


def _shared_steps(
    recordings: Sequence[_Recording], steps: Sequence[StepRecord]
) -> list[list[tuple[StepRecord, StepRecord]]]:
    """Pair each recording's own steps with those of the course; a step repeated goes to the next one."""
    taken: set[int] = set()
    paired = []
    for recording in recordings:
        pairs = []
        for own in recording.steps:
            alike = [s for s in steps if (s.phase, s.condition) == (own.phase, own.condition)]
            same = [s for s in alike if s.step == own.step] or [s for s in alike if s.step not in taken]
            if same:
                taken.add(same[0].step)
                pairs.append((own, same[0]))
        paired.append(pairs)
    return paired


def _by_acquisition(
    recordings: Sequence[_Recording], scans: Mapping[str, bids_lookup.Row]
) -> list[float | None]:
    """Give when each recording began, s after the first of them."""
    by_key = {_key(Path(name)): row.get("acq_time") for name, row in scans.items()}
    moments = []
    for recording in recordings:
        named = scans.get(recording.motion.name) if recording.motion else None
        told = (named or {}).get("acq_time") or by_key.get(_key(recording.events))
        try:
            moments.append(datetime.fromisoformat(told or ""))
        except ValueError as error:
            if len(recordings) == 1:
                return [0.0]
            raise InputError(
                "when it was recorded is not told",
                where=recording.motion or recording.events,
                remedy="write its acq_time in the table of scans, or add events of the whole session",
            ) from error
    first = min(moments)
    return [(moment - first).total_seconds() for moment in moments]


def _films(
    recordings: Sequence[_Recording], zeros: Sequence[float | None], steps: Sequence[Sequence[StepRecord]]
) -> tuple[Film, ...]:
    films = [
        Film(path=r.motion, channels=r.channels, zero_s=zero, steps=tuple(own))
        for r, zero, own in zip(recordings, zeros, steps, strict=True)
        if r.motion is not None and r.channels is not None and zero is not None
    ]
    first: dict[int, Path] = {}
    for film in films:
        for step in film.steps:
            if step.step in first:
                raise InputError(
                    f"the joints of step {step.step} are in {first[step.step].name} too",
                    where=film.path,
                    remedy="keep the files of one tracking system",
                )
            first[step.step] = film.path
    return tuple(films)


def _judged(step: StepRecord, films: Sequence[Film], scans: Mapping[str, bids_lookup.Row]) -> StepRecord:
    """Carry along what the scans say about the file of a step."""
    path = next((film.path for film in films if step.step in {s.step for s in film.steps}), None)
    row = scans.get(path.name, {}) if path else {}
    if bids_lookup.truth(row.get("is_valid"), default=True):
        return step
    return replace(step, exclusion_reason=row.get("exclusion_reason") or "marked as not valid")


def _moved(step: StepRecord, zero_s: float | None) -> StepRecord:
    by_s = zero_s or 0.0
    return replace(step, start_s=step.start_s + by_s, stop_s=step.stop_s + by_s)


def _same(step: StepRecord, steps: Sequence[StepRecord]) -> StepRecord:
    """Find a step again after it got its number."""
    return next(
        s for s in steps if (s.phase, s.condition, s.start_s) == (step.phase, step.condition, step.start_s)
    )


def _key(path: Path) -> frozenset[tuple[str, str]]:
    return frozenset(
        (name, value)
        for name, value in bids_lookup.entities(path).items()
        if name not in _ABOUT_THE_RECORDING
    )


def _scans(visit: Path) -> Mapping[str, bids_lookup.Row]:
    found = sorted(visit.glob("*_scans.tsv"))
    return {Path(row.get("filename") or "").name: row for path in found for row in bids_lookup.rows(path)}
