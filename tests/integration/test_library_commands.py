"""The library's commands, from a folder of takes to its page, as a user types them."""

from __future__ import annotations

import json
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from studykit.cli import main
from studykit.library import make_takes, open_library, rating_plan
from studykit.library.rating import RatingSheet
from studykit.motion.skeleton import JOINT_NAMES


@pytest.fixture(scope="module")
def takes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_takes(tmp_path_factory.mktemp("data") / "takes", segments=60, seed=2)


@pytest.fixture(scope="module")
def built(takes: Path) -> Path:
    out = takes.parent / "library"
    assert run("library", "build", takes, "--out", out, "--workers", 1) == 0
    return out


@pytest.fixture
def library(built: Path, tmp_path: Path) -> Path:
    shutil.copytree(built, tmp_path / "library")
    return tmp_path / "library"


def run(*arguments: object) -> int:
    with pytest.raises(SystemExit) as end:
        main([str(argument) for argument in arguments])
    return int(end.value.code or 0)


def test_one_command_gives_a_calibrated_library_and_its_page(
    takes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "library"
    assert run("library", "build", takes, "--out", out, "--workers", 1) == 0
    said = capsys.readouterr().out
    assert f"{takes}: 6 files, read as studykit-synthetic (bvh)" in said
    assert "60 segments (4.0 min) of 6 takes" in said  # none is lost at the end of a take
    assert "SYNTHETIC: nobody danced these" in said
    assert f"On one page: {out / 'library.html'}" in said
    assert (out / "library.html").exists()
    assert run("library", "build", takes, "--out", out, "--workers", 1) == 0
    assert "0 files are new or changed, 6 as before, 0 gone" in capsys.readouterr().out


def test_what_is_not_read_is_said(takes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "takes"
    shutil.copytree(takes, folder)
    (folder / "old.bvh").write_text("nobody means this")
    (folder / "other.npz").write_bytes(b"")
    assert run("library", "build", folder, "--out", tmp_path / "library", "--workers", 1) == 0
    said = capsys.readouterr().out
    assert "not read, since no rule means it or its format is another: old.bvh and 1 more" in said
    assert run("library", "build", folder, "--out", tmp_path / "library", "--fps", "walz/*=60") == 2
    said = capsys.readouterr().err
    assert "no take of" in said
    assert "matches 'walz/*'; write a pattern of paths such as synthetic-" in said


def test_a_folder_of_several_data_sets_is_not_taken_for_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "data" / "motions_smpl").mkdir(parents=True)
    (tmp_path / "data" / "motions_smpl" / "a_0_300.pkl").write_bytes(b"")
    (tmp_path / "data" / "CMU" / "01").mkdir(parents=True)
    (tmp_path / "data" / "CMU" / "01" / "01_01_poses.npz").write_bytes(b"")
    assert run("library", "build", tmp_path / "data", "--out", tmp_path / "library") == 2
    said = capsys.readouterr().err
    assert "holds several data sets" in said
    assert "give the folder of each" in said
    (tmp_path / "empty").mkdir()
    assert run("library", "build", tmp_path / "empty", "--out", tmp_path / "library") == 2
    assert "there is no file in it; check the path." in capsys.readouterr().err


def test_the_facts_for_a_machine(library: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("library", "info", library, "--json", "--verify") == 0
    facts = json.loads(capsys.readouterr().out)
    assert (facts["segments"], facts["takes"], facts["takes_refused"]) == (60, 6, 0)
    assert facts["targets"]["from"] == "percentiles"
    assert facts["licences"] == {"CC0-1.0": 60}
    assert facts["is_synthetic"]


def test_a_changed_file_is_found(library: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("library", "info", library, "--verify") == 0
    assert "Every file is what was written." in capsys.readouterr().out
    path = min((library / "takes").glob("*.small.npy"))
    data = bytearray(path.read_bytes())
    data[-3] ^= 4
    path.write_bytes(data)
    assert run("library", "info", library, "--verify") == 2
    assert f"{path}: is not what was written; build it again." in capsys.readouterr().err


def test_raters_set_the_targets_and_can_be_taken_back(
    library: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    opened = open_library(library)
    plan = rating_plan(opened, windows=24)
    sheet = RatingSheet(tmp_path / "ratings.csv", plan)
    energy = {row.window: opened.linear_energies[list(row.segments)].sum() for row in plan.itertuples()}
    middle = sorted(energy.values())[12]
    for row in plan.itertuples():
        sheet.record(
            rater=row.rater,
            window=row.window,
            intensity="intense" if energy[row.window] >= middle else "light",
            variety="hard" if len(set(row.segments)) > 5 else "easy",
        )
    before = opened.sha256
    assert run("library", "calibrate", library, "--ratings", sheet.path) == 0
    said = capsys.readouterr().out
    assert "as raters say" in said
    assert "raters agree on intensity: alpha 1.00 [1.00, 1.00]" in said
    assert "what raters say" in (library / "library.html").read_text()
    rated = open_library(library)
    assert rated.sha256 != before
    light, intense = (rated.calibration.energies_of(level, 50.0)[0] for level in ("light", "intense"))
    assert light < intense
    # What raters said of these very segments holds when the library is built again with another seed.
    assert run("library", "calibrate", library, "--percentiles") == 0
    assert "percentiles 25 and 75" in capsys.readouterr().out
    assert open_library(library).sha256 == before
    assert run("library", "calibrate", library, "--ratings", tmp_path / "none.csv") == 2
    assert "none.csv: there is no such file" in capsys.readouterr().err


def test_raters_targets_stay_while_the_segments_stay(
    takes: Path, library: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    opened = open_library(library)
    plan = rating_plan(opened, windows=24)
    sheet = RatingSheet(tmp_path / "ratings.csv", plan)
    rank = {w: n for n, w in enumerate(sorted(set(plan["window"]), key=lambda w: _energy(opened, plan, w)))}
    for row in plan.itertuples():
        word = "intense" if rank[row.window] >= 12 else "light"
        variety = "hard" if len(set(row.segments)) > 5 else "easy"
        sheet.record(rater=row.rater, window=row.window, intensity=word, variety=variety)
    assert run("library", "calibrate", library, "--ratings", sheet.path) == 0
    said = open_library(library).calibration.rated
    assert run("library", "build", takes, "--out", library, "--seed", 5, "--workers", 1) == 0
    assert open_library(library).calibration.rated == said
    capsys.readouterr()
    assert run("library", "build", takes, "--out", library, "--mirrored", "--workers", 1) == 0
    assert (
        "the raters' targets belonged to other segments, or were lost, and hold no more"
        in capsys.readouterr().out
    )
    assert open_library(library).calibration.rated is None


def _energy(library, plan, window: int) -> float:
    segments = plan.loc[plan["window"] == window, "segments"].iloc[0]
    return float(library.linear_energies[list(segments)].sum())


def test_browsing_writes_the_page_again(library: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("library", "browse", library) == 0
    assert capsys.readouterr().out.strip() == str(library / "library.html")


@pytest.mark.skipif(sys.platform == "win32", reason="signals are sent otherwise there")
def test_a_build_that_is_stopped_says_that_it_can_go_on(tmp_path: Path) -> None:
    out = tmp_path / "library"
    command = [sys.executable, "-m", "studykit", "library", "sample", "--workers", "1"]
    # A process that was begun in the background hears no Ctrl-C, and its children would not either.
    process = subprocess.Popen(
        [*command, "--segments", "4000", "--out", str(out)],
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509 - no threads here
    )
    while not list(out.glob("takes/*.json")):
        assert process.poll() is None
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert said.splitlines()[-1].startswith("studykit: stopped; the same command goes on where it was")
    assert run("library", "info", out) == 2


def test_a_skeleton_of_one_s_own_is_mapped_from_the_command_line(
    takes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "takes"
    shutil.copytree(takes, folder)
    (folder / "library.toml").unlink()
    joints = "".join(f'{name} = "{name}"\n' for name in JOINT_NAMES)
    (tmp_path / "mine.toml").write_text(f"[joints]\n{joints}")
    monkeypatch.chdir(tmp_path)
    build = ("library", "build", "takes", "--out", "library", "--workers", 1, "--skeleton")
    assert run(*build, "mine.toml") == 0
    assert "60 segments" in capsys.readouterr().out
    assert open_library(tmp_path / "library").segments["licence"].unique().tolist() == ["not stated"]
    assert run(*build[:4], "other", *build[5:], "none.toml") == 2
    assert "none.toml" in capsys.readouterr().err
