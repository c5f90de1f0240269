"""Studies with something wrong: it is named, and the analyses that remain valid are made."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from shutil import copytree, rmtree
from typing import Any

import pandas as pd
import pytest

from studykit.analysis import run
from studykit.core.errors import InputError
from studykit.io.protocol_file import read_protocol
from studykit.recording.journal import Journal, Record, read_journal
from studykit.recording.study_folder import StudyFolder
from studykit.reports.checks import Problem, problems
from studykit.reports.trials import paces, trials

Study = Callable[[], Path]
Change = Callable[[Record], dict[str, Any] | None]


def rewritten(path: Path, change: Change, target: Path | None = None) -> None:
    """Record a visit again as if it had gone otherwise; None leaves a record out."""
    records = read_journal(path)
    if target is None:
        path.unlink()
    with Journal.create(target or path) as journal:
        for record in records:
            data = change(record)
            if data is not None:
                journal.append(record.kind, data, time_s=record.time_s, durable=False)


def without_bids(study: Path) -> StudyFolder:
    """Take away the derived files, which would otherwise be told to have changed."""
    for subject in study.glob("sub-*"):
        rmtree(subject)
    rmtree(study / "phenotype")
    (study / "participants.tsv").unlink()
    return StudyFolder(study)


def found(folder: StudyFolder) -> tuple[list[Problem], Any, Any]:
    """Give what is wrong, the table and the results that are there all the same."""
    table = trials(folder)
    plan = read_protocol(folder.protocol).analysis
    return problems(folder, table=table), table, run(plan, table)


def kinds(named: list[Problem]) -> set[str]:
    assert all(p.where and p.words[0].isupper() and p.words.endswith(".") for p in named), named
    return {problem.kind for problem in named}


@pytest.fixture(scope="module")
def measured(_recorded: Path) -> pd.DataFrame:
    """The trials of the study before anything is wrong with it."""
    return trials(_recorded)


def test_a_study_with_nothing_wrong_says_nothing(recorded_study: Study) -> None:
    named, table, results = found(StudyFolder(recorded_study()))
    assert named == []
    assert table["is_valid"].all()
    assert all(test.friedman is not None for test in results.tests)


def test_one_participant(recorded_study: Study) -> None:
    folder = without_bids(recorded_study())
    for path in folder.sessions()[1:]:
        path.unlink()
    named, table, results = found(folder)
    assert kinds(named) == {"one participant"}
    assert len(table) == 8
    assert all("only one participant" in (test.not_computed_because or "") for test in results.tests)


def test_a_condition_that_is_missing_everywhere(recorded_study: Study) -> None:
    folder = without_bids(recorded_study())
    for path in folder.sessions():
        records = read_journal(path)
        steps = {
            record.data["step"]
            for record in records
            if record.kind == "step_started"
            and (record.data["phase"], record.data["condition"]) == ("perform", "light-easy-off")
        }
        rewritten(path, lambda r, steps=steps: None if r.data.get("step") in steps else dict(r.data))
    named, table, results = found(folder)
    assert kinds(named) == {"missing condition"}
    assert "light-easy-off" in named[0].words
    assert len(table) == 21
    assert "light-easy-off" in (results.test("smoothness").not_computed_because or "")
    assert results.test("heart_rate").friedman is not None  # compares others


def test_a_rating_that_never_differs(recorded_study: Study) -> None:
    folder = without_bids(recorded_study())

    def all_four(record: Record) -> dict[str, Any]:
        data = dict(record.data)
        is_rating = record.kind == "answers" and data["questionnaire"] == "smoothness"
        return data | {"answers": {"rating": 4}} if is_rating else data

    for path in folder.sessions():
        rewritten(path, all_four)
    named, _, results = found(folder)
    assert [(p.kind, p.where) for p in named] == [("all ties", "smoothness_rating")]
    assert results.test("smoothness").friedman is None
    assert results.test("movement").friedman is not None


def test_a_heart_that_never_changes(recorded_study: Study) -> None:
    folder = without_bids(recorded_study())
    path = folder.sessions()[1]

    def stuck(record: Record) -> dict[str, Any]:
        data = dict(record.data)
        return data | {"heart_rate_bpm": 72} if record.kind == "heart_rate" else data

    rewritten(path, stuck)
    named, table, results = found(folder)
    assert kinds(named) == {"constant heart rate"}
    assert named[0].where == path.relative_to(folder.path).as_posix()
    assert "72 beats/min" in named[0].words
    assert set(table.loc[table["participant"] == "02", "heart_rate_mean_bpm"]) == {72.0}
    assert all(test.friedman is not None for test in results.tests)


def test_a_trial_without_a_skeleton(recorded_study: Study) -> None:
    folder = without_bids(recorded_study())
    path = folder.sessions()[0]
    filmed = [
        r.data["step"]
        for r in read_journal(path)
        if r.kind == "frames_started" and "perform" in r.data["file"]
    ]
    rewritten(
        path,
        lambda r: None if r.kind.startswith("frames_") and r.data["step"] == filmed[2] else dict(r.data),
    )
    named, table, results = found(folder)
    assert kinds(named) == {"no skeleton"}
    assert "participant 01" in named[0].words
    own = table[(table["participant"] == "01") & table["dtw_m"].isna()]
    assert len(own) == 1
    assert own["heart_rate_mean_bpm"].notna().all()
    assert own["is_valid"].all()
    assert results.test("heart_rate").participants == 3


def test_protocols_that_are_mixed(recorded_study: Study) -> None:
    folder = without_bids(recorded_study())

    def other(record: Record) -> dict[str, Any]:
        return dict(record.data) | ({"protocol_sha256": "ab"} if record.kind == "session_started" else {})

    rewritten(folder.sessions()[2], other)
    named, table, results = found(folder)
    assert kinds(named) == {"other protocol"}
    assert "03" in named[0].words
    assert not table.loc[table["participant"] == "03", "is_valid"].any()
    assert results.test("heart_rate").exclusions.not_valid == {"recorded with another protocol": 4}
    assert results.test("heart_rate").participants == 2
    for path in folder.sessions()[:2]:
        rewritten(path, other)
    named, table, _ = found(folder)
    assert kinds(named) == {"other protocol"}
    assert "changed after" in named[0].words
    assert table["is_valid"].all()


@pytest.mark.parametrize(
    "name",
    [
        "sub-01/ses-01/motion/sub-01_ses-01_task-dance_tracksys-camera_acq-intensehardon_run-1_motion.tsv",
        "sub-02/ses-01/motion/sub-02_ses-01_task-session_events.tsv",
        "phenotype/paces.tsv",
        "participants.tsv",
    ],
)
def test_a_bids_file_that_was_changed(recorded_study: Study, measured: pd.DataFrame, name: str) -> None:
    folder = StudyFolder(recorded_study())
    path = folder.path / name
    path.write_text(path.read_text().replace("1", "2", 1))
    named = problems(folder, table=measured)
    assert [(p.kind, p.where) for p in named] == [("changed file", name)]
    if "motion" in name:
        assert trials(folder).equals(measured)  # the journal is the truth


def test_a_journal_that_was_changed(recorded_study: Study) -> None:
    folder = StudyFolder(recorded_study())
    path = folder.sessions()[0]
    path.write_bytes(path.read_bytes().replace(b'"heart_rate_bpm":7', b'"heart_rate_bpm":8', 1))
    named, table, results = found(folder)
    assert kinds(named) == {"changed file"}
    assert named[0].where.startswith(path.relative_to(folder.path).as_posix())
    assert "left out" in named[0].words
    assert set(table["participant"]) == {"02", "03"}
    assert results.test("movement").friedman is not None
    for other in folder.sessions()[1:]:
        other.write_bytes(other.read_bytes().replace(b'"heart_rate_bpm":7', b'"heart_rate_bpm":8', 1))
    with pytest.raises(InputError, match="does not agree with its checksum"):
        trials(folder)


def test_frames_that_were_changed(recorded_study: Study) -> None:
    folder = without_bids(recorded_study())
    path = min((folder.journals / "sub-02_ses-01").glob("*_perform.frames"))
    content = bytearray(path.read_bytes())
    content[5000] ^= 1
    path.write_bytes(content)
    named, table, _ = found(folder)
    assert kinds(named) == {"changed file"}
    assert path.relative_to(folder.path).as_posix() in named[0].words
    assert str(folder.path) not in named[0].words
    assert table["dtw_m"].isna().sum() == 1
    assert table["is_valid"].all()


def test_a_dance_that_was_changed(recorded_study: Study) -> None:
    folder = without_bids(recorded_study())
    archive, record = (folder.dances / f"light-easy-on.{ending}" for ending in ("npz", "json"))
    archive.write_bytes((folder.dances / "intense-easy-on.npz").read_bytes())
    named, table, results = found(folder)
    assert kinds(named) == {"changed file"}
    assert "light-easy-on" in named[0].where
    assert set(table.loc[table["dtw_m"].isna(), "condition"]) == {"light-easy-on"}
    assert "light-easy-on" in (results.test("movement").not_computed_because or "")
    assert results.test("heart_rate").friedman is not None
    other = json.loads((folder.dances / "intense-easy-on.json").read_text())
    record.write_text(json.dumps(other | {"condition": "light-easy-on"}))
    named, *_ = found(folder)
    assert kinds(named) == {"changed file"}
    assert "not the one that was shown" in named[0].words


def recorded_again(folder: StudyFolder, participant: str, session: str) -> None:
    """Put the first visit of participant 01 there once more, under another name."""
    first, second = folder.journal("01", "01"), folder.journal(participant, session)
    told = {"participant": participant, "session": session}

    def renamed(record: Record) -> dict[str, Any]:
        return dict(record.data) | (told if record.kind == "session_started" else {})

    rewritten(first, renamed, second)
    copytree(first.with_suffix(""), second.with_suffix(""))


def test_a_participant_who_is_there_twice(recorded_study: Study) -> None:
    folder = without_bids(recorded_study())
    recorded_again(folder, "01", "02")
    named, table, results = found(folder)
    assert kinds(named) == {"duplicated participant"}
    assert named[0].where == "sub-01_ses-02"
    assert (table["exclusion_reason"] == "danced in an earlier visit").sum() == 8
    assert results.test("heart_rate").participants == 3
    assert len(paces(folder)) == 3


def test_a_recording_under_two_names(recorded_study: Study) -> None:
    folder = without_bids(recorded_study())
    recorded_again(folder, "04", "01")
    named, table, _ = found(folder)
    assert kinds(named) == {"duplicated participant"}
    assert not table.loc[table["participant"] == "04", "is_valid"].any()
    assert table["is_valid"].sum() == 24


def test_a_visit_without_an_end(recorded_study: Study) -> None:
    folder = without_bids(recorded_study())
    path = folder.sessions()[0]
    lines = path.read_bytes().splitlines(keepends=True)
    done = [n for n, line in enumerate(lines) if b'"kind":"step_completed"' in line]
    path.write_bytes(b"".join(lines[: done[len(done) // 2]]))
    named, table, results = found(folder)
    assert kinds(named) == {"visit without end"}
    assert "participant 01" in named[0].words
    assert 0 < (table["participant"] == "01").sum() < 8
    assert results.test("heart_rate").participants == 2
