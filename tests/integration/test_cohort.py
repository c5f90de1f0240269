"""Cohorts by the command: stopped, killed and begun again, on several processes and on a cluster."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from studykit.cli import main
from studykit.library import make_cohort, make_sample

PEOPLE = 6


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("libraries") / "sample"
    make_sample(out, segments=60, seed=3)
    return out


@pytest.fixture(scope="module")
def wishes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("tables") / "wishes.csv"
    rows = [f"P{number:02d},dance,16,light,{'easy' if number % 2 else 2},off" for number in range(PEOPLE)]
    path.write_text("\n".join(["participant,name,duration_s,intensity,variety,transition", *rows]) + "\n")
    return path


@pytest.fixture(scope="module")
def whole(library: Path, wishes: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    out = tmp_path_factory.mktemp("cohort") / "out"
    make_cohort(wishes, library, out, workers=1)
    return contents(out)


def contents(folder: Path) -> dict[str, bytes]:
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def run(*arguments: object) -> int:
    with pytest.raises(SystemExit) as end:
        main([str(argument) for argument in arguments])
    return int(end.value.code or 0)


def begin(wishes: Path, library: Path, out: Path, *, workers: int) -> subprocess.Popen[str]:
    """Start the command in a process group of its own, as a terminal does."""
    command = [sys.executable, "-m", "studykit", "cohort", str(wishes), "--library", str(library)]
    return subprocess.Popen(
        [*command, "--out", str(out), "--workers", str(workers)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def until_one_is_made(out: Path, process: subprocess.Popen[str]) -> None:
    while not list(out.rglob("dance.json")) and process.poll() is None:
        time.sleep(0.02)


def test_the_command_says_how_many_dances_there_are_and_why_others_are_not(
    whole: dict[str, bytes], library: Path, wishes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("cohort", wishes, "--library", library, "--out", tmp_path, "--workers", 1) == 1
    said = capsys.readouterr().out
    assert "6 dances are wished for: 3 out of reach, 3 made." in said
    assert "  linear energy as shown: " in said
    assert "  P00 dance, out of reach: studykit-synthetic, light-2-on" not in said  # joins are off
    assert "  P00 dance, out of reach: studykit-synthetic, light-2-off: 60 segments cannot reach" in said
    assert f"One row a dance: {tmp_path / 'dances.csv'}" in said
    assert contents(tmp_path) == whole
    assert run("cohort", wishes, "--library", library, "--out", tmp_path, "--workers", 1, "--json") == 1
    rows = json.loads(capsys.readouterr().out)
    assert [row["status"] for row in rows] == ["out of reach", "made"] * 3
    assert rows[0]["sha256"] is None
    assert rows[1]["asked_variety"] > 0.0


def test_the_help_teaches_a_table_that_can_be_read(
    library: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from studykit.library import open_library
    from studykit.library.wishes import Wish, read_wishes

    assert run("cohort", "--help") == 0
    lines = [line.strip() for line in capsys.readouterr().out.splitlines()]
    first = lines.index("participant,name,duration_s,intensity,variety,spare,seed")
    (tmp_path / "wishes.csv").write_text("\n".join(lines[first : first + 4]))
    assert len(read_wishes(tmp_path / "wishes.csv", open_library(library))) == 3
    assert {line.split()[0] for line in lines if line} >= set(Wish.model_fields)


def test_a_mistake_in_the_table_ends_with_one_sentence(
    library: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "wishes.csv").write_text("participant,intensity\nP01,fast\n")
    assert run("cohort", tmp_path / "wishes.csv", "--library", library, "--out", tmp_path / "out") == 2
    said = capsys.readouterr().err
    assert said.endswith('wishes.csv, line 2, intensity: there is no "fast"; choose light or intense.\n')
    assert "Traceback" not in said


def test_all_mistakes_of_a_table_are_told_at_once_a_line_each(
    library: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "wishes.csv"
    table.write_text("participant,intensity,spare,seed\nP01,fast,heed,x\nP02,light,,1\n,light,,\n")
    assert run("cohort", table, "--library", library, "--out", tmp_path / "out") == 2
    lines = capsys.readouterr().err.splitlines()
    assert [line.removeprefix(f"studykit: {table}, ").removeprefix(f"{table}, ")[:30] for line in lines] == [
        "line 2, seed: cannot read 'x';",
        "line 2, intensity: there is no",
        "line 2, spare: the body has no",
        "line 4, participant: nobody is",
    ]
    assert not (tmp_path / "out").exists()


def test_where_every_dance_is_there_the_command_ends_with_0_and_where_none_is_it_changes_nothing(
    library: Path, wishes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    heading, *rows = wishes.read_text().splitlines()
    made, refused = tmp_path / "made.csv", tmp_path / "refused.csv"
    made.write_text("\n".join([heading, rows[1]]))
    refused.write_text("\n".join([heading, rows[1].replace("16,light", "12,light")]))
    words = ("--library", library, "--out", tmp_path / "out", "--workers", 1)
    assert run("cohort", made, *words) == 0
    before = contents(tmp_path / "out")
    assert run("cohort", refused, *words) == 1
    assert contents(tmp_path / "out") == before
    said = capsys.readouterr().out
    assert "P01 dance, refused: " in said
    assert f"None is made, so nothing in {tmp_path / 'out'} was changed." in said


def test_ctrl_c_keeps_what_is_finished_and_says_so(
    whole: dict[str, bytes], library: Path, wishes: Path, tmp_path: Path
) -> None:
    process = begin(wishes, library, tmp_path, workers=2)
    until_one_is_made(tmp_path, process)
    os.killpg(process.pid, signal.SIGINT)
    said, complaints = process.communicate()
    if process.returncode == 0:
        pytest.skip("all was made before it could be stopped")
    assert process.returncode == 130
    assert "interrupted" in said
    assert "made" in said
    assert "studykit: stopped; the same command goes on where it was" in complaints
    assert "Traceback" not in complaints
    made = {path: content for path, content in contents(tmp_path).items() if path.endswith(".json")}
    assert made
    assert all(content == whole[path] for path, content in made.items())
    make_cohort(wishes, library, tmp_path, workers=1)
    assert contents(tmp_path) == whole


def test_a_dask_cluster_makes_the_same_bytes(
    whole: dict[str, bytes], library: Path, wishes: Path, tmp_path: Path
) -> None:
    distributed = pytest.importorskip("distributed", reason="Dask is not installed")
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=2, dashboard_address=None)
    with cluster:
        address = cluster.scheduler_address
        assert run("cohort", wishes, "--library", library, "--out", tmp_path, "--dask", address) == 1
        with distributed.Client(cluster) as client:
            worked = client.run(lambda: "studykit.library.cohort" in sys.modules)
    assert any(worked.values())  # elsewhere: the workers are processes of their own
    assert contents(tmp_path) == whole


@pytest.mark.slow
def test_four_processes_make_the_same_bytes(
    whole: dict[str, bytes], library: Path, wishes: Path, tmp_path: Path
) -> None:
    make_cohort(wishes, library, tmp_path, workers=4)
    assert contents(tmp_path) == whole


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("seed", range(4))
def test_killed_at_any_moment_and_begun_again_it_is_the_same_to_the_byte(
    whole: dict[str, bytes], library: Path, wishes: Path, tmp_path: Path, workers: int, seed: int
) -> None:
    rng = np.random.default_rng([seed, workers])
    kills = 0
    for _ in range(3):
        process = begin(wishes, library, tmp_path, workers=workers)
        until_one_is_made(tmp_path, process)
        time.sleep(rng.uniform(0.0, 1.0))
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            kills += 1
        process.communicate()
    make_cohort(wishes, library, tmp_path, workers=workers)
    assert contents(tmp_path) == whole
    assert kills > 0
