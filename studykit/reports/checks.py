"""What is wrong with a study, or worth knowing before its numbers are believed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from studykit.core.errors import InputError
from studykit.io.protocol_file import read_protocol
from studykit.protocol.latin_square import williams
from studykit.protocol.study_protocol import StudyProtocol
from studykit.recording import motion_bids
from studykit.recording.session_record import SessionRecord, StepRecord
from studykit.recording.study_folder import StudyFolder
from studykit.reports import readable, verdicts
from studykit.reports.place import AnyStudy, folder_of
from studykit.reports.trials import trials

if TYPE_CHECKING:
    import pandas as pd

Kind = Literal[
    "one participant",
    "missing condition",
    "all ties",
    "constant heart rate",
    "no heart rate",
    "no skeleton",
    "missing joints",
    "other protocol",
    "changed file",
    "duplicated participant",
    "visit without end",
    "other order",
]

_FEWEST_READINGS = 30


@dataclass(frozen=True, kw_only=True, slots=True)
class Problem:
    """Something about a study that its reader must know.

    Parameters
    ----------
    kind : str
        One of `Kind`.
    where : str
        The file within the study, field or participant.
    words : str
        What it is and what follows from it, in a sentence.
    """

    kind: Kind
    where: str
    words: str


def problems(study: AnyStudy, *, table: pd.DataFrame | None = None) -> list[Problem]:
    """Name everything about a study that narrows what its numbers say.

    Analyses that remain valid are made all the same: `trials` leaves out what is named here.

    Parameters
    ----------
    study : Study, StudyFolder, Path or str
        Where it was recorded.
    table : DataFrame, optional
        Its trials, if they were measured already.

    Returns
    -------
    list of Problem
        Empty if nothing is wrong.

    Raises
    ------
    InputError
        If nothing was recorded, or nothing of it can be read.
    """
    folder = folder_of(study)
    protocol = read_protocol(folder.protocol)
    measured = trials(folder) if table is None else table
    found, shown = readable.visits(folder), readable.dances(folder)
    everything = [
        *(_unreadable(error, "the visit") for error in found.errors),
        *(_unreadable(error, "what hangs on the dance") for error in shown.errors),
        *_of_files(folder, protocol, found),
        *(problem for record in found.records for problem in _of_visit(record, shown, measured)),
        *_of_protocol(folder, protocol, found.records),
        *_of_orders(protocol, found.records),
        *_of_trials(folder, protocol, measured),
    ]
    return [_placed(problem, folder) for problem in everything]


def _placed(problem: Problem, folder: StudyFolder) -> Problem:
    """Name files by their place within the study, so that a study that moved has the same problems."""
    where = "the study" if problem.where == str(folder.path) else problem.where
    prefix = f"{folder.path}/"
    return replace(problem, where=where.replace(prefix, ""), words=problem.words.replace(prefix, ""))


def _unreadable(error: InputError, left_out: str) -> Problem:
    problem = f"{error.problem[:1].upper()}{error.problem[1:]}"
    words = f"{problem}, so {left_out} is left out; {error.remedy}."
    return Problem(kind="changed file", where=error.where, words=words)


def _of_files(folder: StudyFolder, protocol: StudyProtocol, found: readable.Visits) -> Iterator[Problem]:
    """Name derived files that are no longer what was recorded."""
    journals = [record for record in found.records if record.journal.is_file()]
    changed = [p for record in found.records for p in motion_bids.changed_files(folder, protocol, record)]
    if not found.errors and len(journals) == len(found.records):
        changed += motion_bids.changed_tables(folder, protocol, journals)
    for path in changed:
        yield Problem(
            kind="changed file",
            where=str(path),
            words="The file is no longer what was written from the recording; where there is a journal, the "
            "numbers come from that, and 'studykit session export' writes the file again.",
        )


def _of_visit(record: SessionRecord, shown: readable.Dances, measured: pd.DataFrame) -> Iterator[Problem]:
    """Name what is wrong with one visit."""
    who = f"participant {record.participant}"
    if not record.completed:
        yield Problem(
            kind="visit without end",
            where=str(record.journal),
            words=f"The visit of {who} did not reach its end; what was completed counts.",
        )
    readings = record.heart_rate_bpm[record.heart_rate_bpm > 0.0]
    if len(readings) >= _FEWEST_READINGS and np.ptp(readings) == 0.0:
        yield Problem(
            kind="constant heart rate",
            where=str(record.journal),
            words=f"The heart rate of {who} is {readings[0]:g} beats/min in all {len(readings)} readings, so "
            "the sensor rather than the heart was recorded; the values are kept.",
        )
    own = measured[(measured["participant"] == record.participant) & (measured["session"] == record.session)]
    silent = own[own["is_valid"] & own["heart_rate_mean_bpm"].isna()]
    if len(silent):
        yield Problem(
            kind="no heart rate",
            where=str(record.journal),
            words=f"No heart rate stands for {who} in {', '.join(silent['condition'])}.",
        )
    partial = own[own["is_valid"] & own["dtw_m"].notna() & own["linear_energy_danced"].isna()]
    if len(partial):
        yield Problem(
            kind="missing joints",
            where=str(record.journal),
            words=f"Not every joint of {who} was seen in {', '.join(partial['condition'])}, so the energy of "
            "what was danced has no value there.",
        )
    unmeasured = set(own.loc[own["is_valid"] & own["dtw_m"].isna(), "condition"])
    for step in record.steps:
        if step.phase == "perform" and step.is_complete and step.condition in unmeasured:
            yield _unmeasured(record, step, shown)


def _unmeasured(record: SessionRecord, step: StepRecord, shown: readable.Dances) -> Problem:
    """Say why the movement of a trial could not be measured."""
    trial = f"participant {record.participant} in {step.condition}"
    if shown.shown_to(record, step.condition) is None:
        is_there = step.condition in shown.by_condition
        return Problem(
            kind="changed file",
            where=f"{record.journal}, {step.condition}",
            words=f"The dance in the folder is {'not the one that was shown' if is_there else 'missing'}, so "
            f"the movement of {trial} is compared with nothing; put back the dances that were shown.",
        )
    if step.step not in record.frame_files:
        why, kind = "no movement was recorded", "no skeleton"
    else:
        try:
            record.frames(step.step)
            why, kind = "pelvis, hips and shoulders were never seen together", "no skeleton"
        except InputError as error:
            why, kind = f"{error.where}: {error.problem}; {error.remedy}", "changed file"
    return Problem(
        kind="no skeleton" if kind == "no skeleton" else "changed file",
        where=f"{record.journal}, step {step.step}",
        words=f"The movement of {trial} has no values: {why}.",
    )


def _of_protocol(
    folder: StudyFolder, protocol: StudyProtocol, records: tuple[SessionRecord, ...]
) -> Iterator[Problem]:
    others = [record for record in records if record.protocol_sha256 != protocol.sha256]
    if not others:
        return
    people = ", ".join(record.participant for record in others)
    if len(others) == len(records):
        words = (
            "All visits were recorded with another protocol than the one in the folder: it was changed after."
        )
    else:
        words = f"Participants recorded with another protocol than the study's do not count: {people}."
    yield Problem(kind="other protocol", where=str(folder.protocol), words=words)


def _of_orders(protocol: StudyProtocol, records: tuple[SessionRecord, ...]) -> Iterator[Problem]:
    """Name who danced in another order than the row of the square that is told."""
    labels = protocol.order.labels
    rows = [tuple(labels[place] for place in row) for row in williams(len(labels)).tolist()]
    for record in records:
        if record.sequence <= len(rows) and rows[record.sequence - 1] != record.conditions:
            yield Problem(
                kind="other order",
                where=str(record.journal),
                words=f"Participant {record.participant} did not dance in the order of sequence "
                f"{record.sequence}, so the orders are not as balanced as planned.",
            )


def _of_trials(folder: StudyFolder, protocol: StudyProtocol, measured: pd.DataFrame) -> Iterator[Problem]:
    """Name what the table of trials lacks."""
    where = str(folder.path)
    valid = measured[measured["is_valid"]]
    if valid["participant"].nunique() == 1:
        yield Problem(
            kind="one participant",
            where=where,
            words=f"Only participant {valid['participant'].iloc[0]} has valid trials, so no conditions can "
            "be compared over people.",
        )
    for condition in protocol.order.labels:
        if condition not in set(valid["condition"]):
            yield Problem(
                kind="missing condition", where=where, words=f"Nobody has a valid trial of {condition}."
            )
    reasons = measured["exclusion_reason"]
    for reason in (verdicts.EARLIER_VISIT, verdicts.SAME_RECORDING):
        people = measured.loc[reasons == reason, ["participant", "session"]].drop_duplicates()
        for participant, session in people.itertuples(index=False):
            yield Problem(
                kind="duplicated participant",
                where=f"sub-{participant}_ses-{session}",
                words=f"Trials of participant {participant} do not count ({reason}).",
            )
    for outcome in dict.fromkeys(test.outcome for test in protocol.analysis.tests):
        different = valid.groupby("participant")[outcome].nunique()
        if different.max() == 1:
            yield Problem(
                kind="all ties",
                where=outcome,
                words=f"Nobody has different values of {outcome} in different conditions, so they cannot be "
                "compared by it.",
            )
