"""Who came, and what they answered, from the tables of a BIDS data set."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studykit.core.errors import InputError
from studykit.protocol.questionnaire import PACES
from studykit.recording import bids_lookup
from studykit.recording.bids_metadata import DEMOGRAPHICS, smoothness_column
from studykit.recording.session_data import Answers
from studykit.recording.study_folder import StudyFolder


@dataclass(frozen=True, kw_only=True, slots=True)
class Visitor:
    """Somebody who came: their answers, whether they are simulated, and their row of the square if told."""

    answers: tuple[Answers, ...]
    simulated: bool
    sequence: int | None


def visitor(study: StudyFolder, participant: str, session: str, conditions: Sequence[str]) -> Visitor:
    """Read what the tables tell about a participant and a visit.

    Parameters
    ----------
    study : StudyFolder
        The data set; of ``participants.tsv`` and ``phenotype/{demographics,smoothness,paces}.tsv``, what is
        there is read.
    participant, session : str
        Whose visit, and which.
    conditions : sequence of str
        Those that may have been rated.

    Raises
    ------
    InputError
        If a table is broken or an answer is no number; it names file, line and column.
    """
    path = study.path / "participants.tsv"
    person = _row(path, participant, session)[1]
    told = person | {
        name: value
        for name, value in _row(study.phenotype / "demographics.tsv", participant, session)[1].items()
        if value is not None
    }
    demographics = {name: _plain(told[name]) for name in DEMOGRAPHICS if told.get(name) is not None}
    answers = [Answers(questionnaire="demographics", condition=None, answers=demographics)]
    age = demographics.get("age")
    if isinstance(age, str):
        raise InputError(f'"age" is "{age}"', where=f"{path}, sub-{participant}", remedy="write whole years")
    smoothness = study.phenotype / "smoothness.tsv"
    for condition in conditions:
        rating = _numbers(smoothness, participant, session, [smoothness_column(condition)])
        answers += [
            Answers(questionnaire="smoothness", condition=condition, answers={"rating": value})
            for value in rating.values()
        ]
    paces = _numbers(study.phenotype / "paces.tsv", participant, session, [item.name for item in PACES])
    if paces:
        answers.append(Answers(questionnaire="paces", condition=None, answers=paces))
    sequence = person.get("sequence")
    return Visitor(
        answers=tuple(given for given in answers if given.answers),
        simulated=bids_lookup.truth(person.get("simulated"), default=_is_simulated(study.path)),
        sequence=None if sequence is None else int(bids_lookup.number(person, "sequence", path)),
    )


def _row(path: Path, participant: str, session: str) -> tuple[int, bids_lookup.Row]:
    """Give the line and the row about a visit, or about the person; empty if there is none."""
    if not path.exists():
        return 0, {}
    for line, row in enumerate(bids_lookup.rows(path), start=2):
        is_of_visit = row.get("session_id") in (None, session, f"ses-{session}")
        if row.get("participant_id") in (participant, f"sub-{participant}") and is_of_visit:
            return line, row
    return 0, {}


def _numbers(path: Path, participant: str, session: str, columns: Sequence[str]) -> dict[str, float]:
    line, row = _row(path, participant, session)
    return {
        name: _whole(bids_lookup.number(row, name, path, line=line))
        for name in columns
        if row.get(name) is not None
    }


def _whole(value: float) -> float:
    return int(value) if value.is_integer() else value


def _plain(text: str | None) -> Any:
    try:
        return _whole(float(text or ""))
    except ValueError:
        return text


def _is_simulated(root: Path) -> bool:
    path = root / "dataset_description.json"
    try:
        told: Mapping[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    except ValueError as error:
        raise InputError(f"this is no JSON ({error})", where=path, remedy="put it right") from error
    return bool(told.get("Simulated", False))
