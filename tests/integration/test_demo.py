"""The whole chain in one command, twice: from the library to the report, the same bytes for the same seed."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pandas as pd
import pytest

from studykit.analysis.tables import TRIALS, check
from studykit.cli import main
from studykit.io.protocol_file import default_protocol
from studykit.library import make_sample, read_dances, store
from studykit.reports.draw import DRAWINGS

PEOPLE = 4


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("demo")


@pytest.fixture(scope="module")
def protocol(folder: Path) -> Path:
    """The study with short phases and few people."""
    text = default_protocol().read_text(encoding="utf-8")
    changes = (
        ("participants = 20", f"participants = {PEOPLE}"),
        ("= 120.0", "= 10.0"),
        ("= 300.0", "= 60.0"),
    )
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "short.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def library(folder: Path) -> Path:
    make_sample(folder / "library")
    return folder / "library"


@pytest.fixture(
    scope="module",
    params=[("6", "7", "8"), pytest.param(None, marks=pytest.mark.slow)],
    ids=["three figures", "every figure"],
)
def studies(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory, library: Path, protocol: Path
) -> tuple[Path, Path]:
    """The same demo, run twice."""
    folder = tmp_path_factory.mktemp("studies")
    some = tuple(one for one in DRAWINGS if request.param is None or one.name in request.param)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(import_module("studykit.reports.report"), "DRAWINGS", some)
        for out in (folder / "one", folder / "two"):
            run("demo", "--library", library, "--protocol", protocol, "--seed", 3, "--out", out)
    return folder / "one", folder / "two"


def run(*words: object) -> None:
    with pytest.raises(SystemExit) as end:
        main([str(word) for word in words])
    assert end.value.code == 0


def files(folder: Path) -> Iterator[tuple[str, Path]]:
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            yield path.relative_to(folder).as_posix(), path


def test_the_same_seed_writes_the_same_bytes(studies: tuple[Path, Path]) -> None:
    one, two = (dict(files(study)) for study in studies)
    assert list(one) == list(two)
    assert [name for name in one if one[name].read_bytes() != two[name].read_bytes()] == []


def test_everything_simulated_says_so(studies: tuple[Path, Path]) -> None:
    study = studies[0]
    report = (study / "derivatives" / "studykit" / "report.html").read_text(encoding="utf-8")
    assert "simulated" in report[: report.index("<h2")].lower()
    assert "simulated" in (study / "dataset_description.json").read_text(encoding="utf-8").lower()
    assert "simulated" in (study / "README").read_text(encoding="utf-8").lower()
    trials = pd.read_csv(study / "derivatives" / "studykit" / "trials.csv", dtype=TRIALS.dtypes)
    assert trials["simulated"].all()
    assert all(dance.is_synthetic for dance in read_dances(study / "sourcedata" / "dances").values())


def test_every_trial_is_measured(studies: tuple[Path, Path]) -> None:
    trials = pd.read_csv(studies[0] / "derivatives" / "studykit" / "trials.csv", dtype=TRIALS.dtypes)
    check(trials, TRIALS)
    assert len(trials) == 8 * PEOPLE
    assert trials["is_valid"].all()
    measured = trials.drop(columns=["previous_condition", "exclusion_reason"])
    assert not measured.isna().to_numpy().any()
    assert trials["heart_rate_mean_bpm"].between(45.0, 200.0).all()
    assert trials["dtw_m"].between(0.01, 0.5).all()


def test_the_declared_results_figures_and_report_are_there(studies: tuple[Path, Path]) -> None:
    derivatives = studies[0] / "derivatives" / "studykit"
    results = json.loads((derivatives / "results.json").read_text(encoding="utf-8"))
    assert [test["name"] for test in results["tests"]] == ["heart_rate", "movement", "smoothness"]
    assert results["valid_trials"] == 8 * PEOPLE
    names = {path.stem for path in (derivatives / "figures").iterdir()}
    assert {"figure-6", "figure-7", "figure-8"} <= names


def test_the_yield_of_every_take_and_the_segments_of_every_dance_are_printed(
    library: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run("library", "info", library, "--takes")
    said = capsys.readouterr().out
    takes = pd.read_csv(store.index_folder(library) / store.TAKES)
    assert len(takes) == 24
    assert all(said.count(f"{take} ") == 1 for take in takes["take"])
    for head in ("segments possible", "by the paper's rule", "frames too fast", "too jerky"):
        assert head in said
    distinct = []
    for variety in ("easy", "hard"):
        run("choreograph", "--library", library, "--variety", variety, "--out", tmp_path / variety)
        dance = read_dances(tmp_path / variety)[f"light-{variety}-on"]
        said = capsys.readouterr().out
        assert f"{dance.distinct_segments} of 8" in said
        assert " ".join(str(segment.id) for segment in dance.segments) in said
        distinct.append(dance.distinct_segments)
    assert distinct[0] < distinct[1] == 8


def test_twenty_people_would_stay_below_200_megabytes(studies: tuple[Path, Path]) -> None:
    a_person = sum(path.stat().st_size for name, path in files(studies[0]) if "sub-" in name) / PEOPLE
    rest = sum(path.stat().st_size for name, path in files(studies[0]) if "sub-" not in name)
    assert 20 * a_person + rest < 200e6


@pytest.mark.slow
def test_a_second_run_adds_nothing_to_what_was_recorded_and_says_what_is_there(
    studies: tuple[Path, Path], library: Path, protocol: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = studies[1]
    before = {name: path.stat().st_mtime_ns for name, path in files(study / "sourcedata")}
    for step in ("analyse", "figures", "report"):
        run(step, study)
    run("demo", "--library", library, "--protocol", protocol, "--seed", 3, "--out", study)
    said = capsys.readouterr()
    for words in ("SIMULATED", "SYNTHETIC", str(study / "derivatives"), "studykit library build", "8 of 8"):
        assert words in said.out
    assert "Choreographing" in said.err
    after = {name: path.stat().st_mtime_ns for name, path in files(study / "sourcedata" / "journal")}
    assert after == {name: before[f"journal/{name}"] for name in after}


def test_a_visit_from_the_command_line_cannot_be_run_twice(
    studies: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = tmp_path / "study"
    for part in ("code", "sourcedata/dances"):
        shutil.copytree(studies[0] / part, study / part)
    run("session", "run", "--study", study, "--participant", "02")
    run("session", "validate", "--study", study)
    assert "Whole: 1 of 1 journals, 8 dances" in capsys.readouterr().out
    run("session", "list", "--study", study, "--json")
    visits = {row["participant"]: row["visit"] for row in json.loads(capsys.readouterr().out)}
    assert visits == {"01": "not yet", "02": "complete", "03": "not yet", "04": "not yet"}

    before = {name: path.read_bytes() for name, path in files(study)}
    for verb in ("run", "resume"):
        with pytest.raises(SystemExit) as end:
            main(["session", verb, "--study", str(study), "--participant", "02"])
        assert end.value.code == 2
        assert "02" in capsys.readouterr().err
    assert {name: path.read_bytes() for name, path in files(study)} == before
