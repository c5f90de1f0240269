"""A visit from end to end: interrupted anywhere, killed, repeated, and judged by the official validator."""

from __future__ import annotations

import asyncio
import json
import pickle
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from studykit.protocol.study_protocol import StudyProtocol
from studykit.recording.journal import Record, read_journal
from studykit.recording.session_record import read_session
from studykit.session.plan import plan
from studykit.session.runner import Session
from studykit.session.state import replay
from studykit.session.study import Study, _Shown, open_study

VALIDATOR = Path(sys.executable).with_name("bids-validator-deno")


def all_bytes(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def check_whole(session: Session) -> None:
    """A visit that is over: every planned step once, every film readable, nothing open."""
    record = read_session(session.path)
    assert record.completed
    done = [step for step in record.steps if step.is_complete]
    planned = plan(session.protocol, session.sequence)
    assert [(s.phase, s.condition, s.period) for s in done] == [
        (p.phase, p.condition, p.period) for p in planned
    ]
    assert [step.step for step in record.steps] == list(range(1, len(record.steps) + 1))
    for step in done:
        if step.phase == "perform":
            assert 110 <= len(record.frames(step.step)) <= 121
    for number in record.frame_files:
        record.frames(number)
    assert {(a.questionnaire, a.condition) for a in record.answers} == {
        (p.phase, p.condition) for p in planned if p.duration_s is None
    }


# Same seed, same bytes


def test_the_same_seed_writes_the_same_bytes_however_many_work_on_it(
    tmp_path: Path, small_protocol: StudyProtocol, small_dances: dict[str, Any]
) -> None:
    for name, settings in (("a", {}), ("b", {}), ("c", {"workers": 2}), ("d", {"seed": 2})):
        study = open_study(tmp_path / name, protocol=small_protocol)
        study.simulate(small_dances, **settings)  # type: ignore[arg-type]
    first = all_bytes(tmp_path / "a")
    assert len(first) > 40
    assert all_bytes(tmp_path / "b") == first
    assert all_bytes(tmp_path / "c") == first
    other = all_bytes(tmp_path / "d")
    assert other.keys() == first.keys()
    assert all(other[name] != first[name] for name in first if name.endswith((".frames", ".jsonl")))


# Interrupted anywhere


def cut(source: Study, folder: Path, records: tuple[Record, ...], lines: list[bytes]) -> Study:
    """Give the study as a power cut after some records would leave it: half a line, half a frame."""
    study = open_study(folder, protocol=source.protocol)
    session = source.folder.journal("01", "01")
    journal = study.folder.journal("01", "01")
    journal.parent.mkdir(parents=True)
    count = len(records)
    torn = lines[count][: len(lines[count]) // 2] if count < len(lines) else b""
    journal.write_bytes(b"".join(lines[:count]) + torn)
    for record in records:
        if record.kind == "frames_started":
            target = journal.with_suffix("") / record.data["file"]
            target.parent.mkdir(exist_ok=True)
            shutil.copy(session.with_suffix("") / record.data["file"], target)
    is_filming = replay(records).open_frames is not None
    if is_filming:
        target.write_bytes(target.read_bytes()[:-5000])
    return study


def test_a_visit_interrupted_after_any_record_is_resumed_and_whole(
    tmp_path: Path, small_protocol: StudyProtocol, small_dances: dict[str, Any]
) -> None:
    source = open_study(tmp_path / "source", protocol=small_protocol)
    asyncio.run(source.session("01").run(small_dances))
    journal = source.folder.journal("01", "01")
    lines, records = journal.read_bytes().splitlines(keepends=True), read_journal(journal)
    counts = [
        count
        for count in range(len(records))
        if count % 10 == 0 or "heart_rate" not in {records[count].kind, records[count - 1].kind}
    ]
    assert len(counts) > 30
    for count in counts:
        study = cut(source, tmp_path / f"cut-{count}", records[:count], lines)
        before = study.folder.journal("01", "01").read_bytes()
        session = study.session("01")
        asyncio.run(session.run(small_dances))
        check_whole(session)
        kept = before[: before.rfind(b"\n") + 1]
        assert session.path.read_bytes().startswith(kept), count
        if len(kept) < len(before):
            torn = session.path.with_suffix("") / f"torn_line_at_{len(kept)}.bytes"
            assert torn.read_bytes() == before[len(kept) :]
        shutil.rmtree(study.path)


# Killed

CHILD = """
import asyncio, os, pickle, signal, sys
from pathlib import Path
from studykit.recording import frames, journal
from studykit.session.study import open_study

left, write_all = int(sys.argv[3]), journal.write_all

def write_and_die(file, data):
    global left
    left -= 1
    write_all(file, data if left else data[: len(data) // 2])
    if not left:
        os.kill(os.getpid(), signal.SIGKILL)

journal.write_all = frames.write_all = write_and_die
dances = pickle.loads(Path(sys.argv[2]).read_bytes())
asyncio.run(open_study(sys.argv[1]).session("01").run(dances))
"""


def kill_and_resume(
    folder: Path, protocol: StudyProtocol, dances: dict[str, Any], *, at_writes: list[int]
) -> None:
    """Kill a visit in the middle of writing, more than once, then let it end and judge it."""
    study = open_study(folder / "pilot", protocol=protocol)
    dances_file = folder / "dances.pickle"
    dances_file.write_bytes(pickle.dumps({name: _Shown.of(dance) for name, dance in dances.items()}))
    before = b""
    for write in at_writes:
        child = [sys.executable, "-c", CHILD, str(study.path), str(dances_file), str(write)]
        assert subprocess.run(child, check=False).returncode == -signal.SIGKILL
        journal = study.folder.journal("01", "01").read_bytes()
        assert journal.startswith(before)
        before = journal[: journal.rfind(b"\n") + 1]
        assert len(read_journal(study.folder.journal("01", "01"))) == before.count(b"\n")
    session = study.session("01")
    asyncio.run(session.run(dances))
    assert session.path.read_bytes().startswith(before)
    check_whole(session)
    study.write_bids()
    assert_valid(study.path)


def test_a_visit_killed_while_it_writes_is_resumed_and_valid(
    tmp_path: Path, small_protocol: StudyProtocol, small_dances: dict[str, Any]
) -> None:
    # the middle of a line, and the middle of a frame
    kill_and_resume(tmp_path, small_protocol, small_dances, at_writes=[2, 100])


@pytest.mark.slow
def test_a_visit_killed_again_and_again_is_resumed_and_valid(
    tmp_path: Path, small_protocol: StudyProtocol, small_dances: dict[str, Any]
) -> None:
    for number, at_writes in enumerate(([1, 1, 3, 5, 40, 130], [20, 33, 34, 35, 36], [160, 90, 250])):
        folder = tmp_path / str(number)
        folder.mkdir()
        kill_and_resume(folder, small_protocol, small_dances, at_writes=at_writes)


# The official validator


def validate(folder: Path) -> tuple[int, list[dict[str, Any]]]:
    if not VALIDATOR.exists():
        pytest.skip("bids-validator-deno is not installed")
    done = subprocess.run([VALIDATOR, folder, "--json"], capture_output=True, check=False, text=True)
    return done.returncode, json.loads(done.stdout)["issues"]["issues"]


def assert_valid(folder: Path) -> None:
    code, issues = validate(folder)
    assert [issue for issue in issues if issue["severity"] == "error"] == []
    assert code == 0


@pytest.fixture(scope="module")
def simulated(
    tmp_path_factory: pytest.TempPathFactory, small_protocol: StudyProtocol, small_dances: dict[str, Any]
) -> Path:
    study = open_study(tmp_path_factory.mktemp("valid") / "pilot", protocol=small_protocol)
    study.simulate(small_dances)
    return study.path


def test_a_simulated_study_passes_the_official_validator(simulated: Path) -> None:
    assert_valid(simulated)


def test_the_validator_sees_a_missing_sampling_frequency_and_a_wrong_channel(
    simulated: Path, tmp_path: Path
) -> None:
    broken = tmp_path / "broken"
    shutil.copytree(simulated, broken)
    about = sorted((broken / "sub-01" / "ses-01" / "motion").glob("*_task-dance_*_motion.json"))[0]
    content = json.loads(about.read_text())
    del content["SamplingFrequency"]
    about.write_text(json.dumps(content))
    channels = sorted((broken / "sub-02" / "ses-01" / "motion").glob("*_channels.tsv"))[0]
    channels.write_text(channels.read_text().replace("\tPOS\t", "\tWHERE\t", 1))
    code, issues = validate(broken)
    errors = {issue["code"] for issue in issues if issue["severity"] == "error"}
    assert code != 0
    assert errors == {"SIDECAR_KEY_REQUIRED", "TSV_VALUE_INCORRECT_TYPE"}


def test_a_journal_cut_off_at_birth_stops_nobody_and_is_taken_up(
    tmp_path: Path, small_protocol: StudyProtocol, small_dances: dict[str, Any]
) -> None:
    study = open_study(tmp_path / "study", protocol=small_protocol)
    cut = study.folder.journal("01", "01")
    for beginning in (b"", b'{"number": 1, "ti'):
        cut.parent.mkdir(parents=True, exist_ok=True)
        cut.write_bytes(beginning)
        assert study.sessions() == ()
    study.simulate(small_dances, seed=2)
    assert [record.completed for record in study.sessions()] == [True, True]
