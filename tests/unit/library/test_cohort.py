"""Dances for a cohort: the same bytes however they are made, nothing made twice, nothing stopped by one."""

from __future__ import annotations

import os
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from studykit.choreography.choreograph import dance
from studykit.choreography.dance import Dance
from studykit.core.errors import InputError
from studykit.core.parallel import one_core
from studykit.library import cohort, make_cohort, make_sample, open_library, read_dances
from studykit.library.dance_file import write_dances
from studykit.library.wishes import read_wishes

WISHES = """participant,name,duration_s,intensity,variety,transition,spare,seed
P01,one,16,light,easy,off,,
P01,impossible,12,100,2,off,,
P02,one,16,light,easy,off,,
P02,still head,12,light,hard,off,head,4
"""
MADE = ["made", "out of reach", "made", "made"]


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("libraries") / "sample"
    make_sample(out, segments=60, seed=3)
    return out


@pytest.fixture(scope="module")
def wishes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("tables") / "wishes.csv"
    path.write_text(WISHES)
    return path


@pytest.fixture(scope="module")
def whole(library: Path, wishes: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make all dances in one process."""
    out = tmp_path_factory.mktemp("cohort") / "out"
    assert make_cohort(wishes, library, out, seed=7, workers=1)["status"].tolist() == MADE
    return out


@pytest.fixture
def kept(whole: Path, tmp_path: Path) -> Path:
    """Copy what was made, so that it can be spoilt."""
    return Path(shutil.copytree(whole, tmp_path / "out"))


def contents(folder: Path) -> dict[str, bytes]:
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def written(folder: Path) -> dict[str, int]:
    return {path.name: path.stat().st_mtime_ns for path in folder.rglob("*.*") if path.name[:1] != "."}


def test_every_dance_lies_in_the_folder_of_its_participant(whole: Path) -> None:
    names = {path for path in contents(whole) if not path.startswith(".")}
    stems = ("P01/one", "P02/one", "P02/still head")
    assert names == {"dances.csv"} | {
        f"{stem}.{kind}" for stem in stems for kind in ("npz", "bvh", "glb", "json")
    }


def test_a_dance_of_a_cohort_is_the_dance_that_one_would_make_alone(
    whole: Path, wishes: Path, library: Path, tmp_path: Path
) -> None:
    opened = open_library(library)
    for wish in read_wishes(wishes, opened, seed=7):
        if wish.name != "impossible":
            with one_core():
                alone = dance(wish.goal(opened), opened, seed=wish.seed or 0, workers=3)
            write_dances({wish.name: alone}, tmp_path / wish.participant)
    assert contents(tmp_path) == {
        path: content for path, content in contents(whole).items() if path.startswith("P")
    }


def test_people_with_equal_wishes_have_searches_of_their_own(whole: Path) -> None:
    one, other = (read_dances(whole / person)["one"] for person in ("P01", "P02"))
    assert one.asked == other.asked
    assert one.seed != other.seed
    assert one.trace != other.trace  # so small a library may have one best dance for both


def test_the_table_tells_what_the_files_hold(whole: Path, library: Path) -> None:
    table = pd.read_csv(whole / "dances.csv", keep_default_na=False)
    assert table["status"].tolist() == MADE
    assert "cannot reach this" in table["reason"][1]
    assert table["sha256"][1] == ""
    row = table.iloc[3]
    made = read_dances(whole / "P02")["still head"]
    assert (row["seed"], row["sha256"], row["misses"]) == (4, made.sha256, "")
    assert (int(row["segments"]), int(row["distinct_segments"])) == (3, made.distinct_segments)
    for stage, measures in (
        ("asked", made.asked),
        ("achieved", made.achieved),
        ("blended", made.achieved_blended),
    ):
        for name in ("linear_energy", "rotational_energy", "variety"):
            assert float(row[f"{stage}_{name}"]) == getattr(measures, name)
    assert float(row["displacement_max_m"]) == max(made.displacements_m)
    # The turn from one frame to the next, from the quaternions themselves: the head is joint 15.
    turned = made.motion.rotations[:, 15]
    peak = 2.0 * 30.0 * np.arccos(np.abs((turned[1:] * turned[:-1]).sum(axis=1)).clip(0.0, 1.0)).max()
    limit = float(np.percentile(open_library(library).peak_speeds[:, 15], 50.0))
    assert float(row["spared_peak_of_limit"]) == pytest.approx(peak / limit, rel=1e-3)
    assert row["spared"] == f"head {peak:.2f} of {limit:.2f} rad/s"
    assert float(row["spared_peak_of_limit"]) <= 1.0


def test_a_measure_that_is_off_is_told_by_its_name_and_share(
    whole: Path, wishes: Path, library: Path
) -> None:
    opened = open_library(library)
    goal = read_wishes(wishes, opened, seed=7)[0].goal(opened)
    made = read_dances(whole / "P01")["one"]
    (block,) = goal.blocks
    asked = replace(goal, blocks=(replace(block, linear_energy=made.achieved.linear_energy / 1.2),))
    assert cohort._misses(made, asked, "achieved") == "linear energy off by 20.0%"
    assert cohort._misses(made, goal, "achieved") == ""


def test_two_processes_make_the_same_bytes(whole: Path, wishes: Path, library: Path, tmp_path: Path) -> None:
    make_cohort(wishes, library, tmp_path, seed=7, workers=2)
    assert contents(tmp_path) == contents(whole)


def test_a_dance_that_is_there_stays_and_one_that_is_missing_is_made_again(
    kept: Path, whole: Path, wishes: Path, library: Path
) -> None:
    before = written(kept / "P02")
    (kept / "P01" / "one.json").unlink()  # as a power cut leaves it
    (kept / "P01" / ".one.json.77.partial").write_text("{")
    (kept / "P02" / "one.glb").unlink()
    make_cohort(wishes, library, kept, seed=7, workers=1)
    now, then = contents(kept), contents(whole)
    assert len(now.pop("P02/one.glb")) == len(then.pop("P02/one.glb"))  # drawn anew from rounded numbers
    assert now == then
    after = written(kept / "P02")
    assert {name for name in after if after[name] != before[name]} == {"one.glb"}


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (
            WISHES.replace("hard,off,head,4", "hard,off,head,5"),
            "P02/still head: the dance that is there has another seed (4); give this one",
        ),
        (WISHES.replace("light,hard,off", "intense,hard,off"), "has another goal"),
        (WISHES.replace("light,hard,off", "light,hard,on"), "has another goal"),
        (WISHES.replace("12,light,hard,off", "16,light,hard,off"), "has another goal"),
        (WISHES.replace(",head,", ",neck,"), "has another choice of joints"),
    ],
)
def test_a_wish_that_was_changed_does_not_replace_the_dance_that_is_there(
    kept: Path, library: Path, tmp_path: Path, changed: str, said: str
) -> None:
    (tmp_path / "changed.csv").write_text(changed)
    before = contents(kept / "P02")
    table = make_cohort(tmp_path / "changed.csv", library, kept, seed=7, workers=1)
    assert table["status"].tolist() == [*MADE[:3], "refused"]
    assert said in table["reason"][3]
    assert contents(kept / "P02") == before


def test_dances_of_another_library_or_broken_ones_are_refused(
    kept: Path, wishes: Path, tmp_path: Path
) -> None:
    make_sample(tmp_path / "other", segments=60, seed=4)
    (kept / "P02" / "one.npz").write_bytes(b"broken")
    table = make_cohort(wishes, tmp_path / "other", kept, seed=7, workers=1)
    assert table["status"].tolist() == ["refused", "out of reach", "refused", "refused"]
    assert "has another library" in table["reason"][0]
    assert "its movement is not the one that was written" in table["reason"][2]


def test_a_dance_of_an_interrupted_search_or_of_another_stage_is_refused(
    kept: Path, wishes: Path, library: Path, tmp_path: Path
) -> None:
    one = read_dances(kept / "P01")["one"]
    for path in [*(kept / "P01").glob("one.*"), *(kept / "P02").glob("one.*")]:
        path.unlink()
    write_dances({"one": replace(one, is_interrupted=True)}, kept / "P01")
    other = read_dances(kept / "P02")["still head"]
    for path in (kept / "P02").glob("still head.*"):
        path.unlink()
    staged = replace(other, animation=replace(other.animation, stage_m=(3.0, 2.0)))
    write_dances({"still head": staged}, kept / "P02")
    table = make_cohort(wishes, library, kept, seed=7, workers=1)
    assert table["status"].tolist() == ["refused", "out of reach", "made", "refused"]
    assert "has a search that was interrupted;" in table["reason"][0]
    assert "has another stage;" in table["reason"][3]
    (tmp_path / "staged.csv").write_text(
        "participant,name,duration_s,variety,transition,spare,stage,seed\n"
        "P02,still head,12,hard,off,head,3x2,4\n"
    )
    assert make_cohort(tmp_path / "staged.csv", library, kept, seed=7)["status"].tolist() == ["made"]


def test_a_wish_that_is_refused_is_not_called_out_of_reach(library: Path, tmp_path: Path) -> None:
    (tmp_path / "wishes.csv").write_text("name,duration_s,variety,transition\nlong,400,hard,off\n")
    (row,) = make_cohort(tmp_path / "wishes.csv", library, tmp_path / "out", workers=1).to_dict("records")
    assert row["status"] == "refused"
    assert "a dance that never repeats needs 100" in row["reason"]


def test_a_stage_of_a_wish_reaches_the_dance(library: Path, tmp_path: Path) -> None:
    (tmp_path / "wishes.csv").write_text("name,duration_s,transition,stage\nsmall,12,off,0.5x0.4\n")
    make_cohort(tmp_path / "wishes.csv", library, tmp_path / "out", workers=1)
    made = read_dances(tmp_path / "out")["small"]
    assert made.animation.stage_m == (0.5, 0.4)
    away = np.abs(made.motion.root_positions - made.motion.root_positions[0]).max(axis=0)
    assert away[0] < 0.26
    assert away[2] < 0.21


def test_what_is_interrupted_keeps_what_is_finished_and_goes_on(
    whole: Path, wishes: Path, library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[str] = []

    def stopped(goal: Any, *rest: Any, **words: Any) -> Dance:
        begun.append(goal.condition)
        if len(begun) == 3:
            raise KeyboardInterrupt
        return dance(goal, *rest, **words)

    monkeypatch.setattr(cohort, "dance", stopped)
    table = make_cohort(wishes, library, tmp_path, seed=7, workers=1)
    assert table["status"].tolist() == ["made", "out of reach", "interrupted", "interrupted"]
    assert pd.read_csv(tmp_path / "dances.csv")["status"].tolist() == table["status"].tolist()
    monkeypatch.undo()
    make_cohort(wishes, library, tmp_path, seed=7, workers=1)
    assert contents(tmp_path) == contents(whole)


def test_the_best_so_far_of_an_interrupted_search_is_not_kept(
    wishes: Path, library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def half(*rest: Any, **words: Any) -> Dance:
        return replace(dance(*rest, **words), is_interrupted=True)

    monkeypatch.setattr(cohort, "dance", half)
    table = make_cohort(wishes, library, tmp_path, workers=1)
    assert table["status"].tolist() == ["interrupted"] * 4
    assert not (tmp_path / "P01").exists()


def test_nothing_is_made_of_a_table_with_a_mistake_in_its_last_row(library: Path, tmp_path: Path) -> None:
    (tmp_path / "wishes.csv").write_text(WISHES.replace(",head,", ",heed,"))
    with pytest.raises(InputError, match="line 5, spare"):
        make_cohort(tmp_path / "wishes.csv", library, tmp_path / "out", workers=1)
    assert not (tmp_path / "out").exists()


def test_where_none_is_made_nothing_that_was_there_is_overwritten(kept: Path, tmp_path: Path) -> None:
    make_sample(tmp_path / "other", segments=60, seed=4)
    before = contents(kept)
    (tmp_path / "wishes.csv").write_text("\n".join(WISHES.splitlines()[:3]))
    table = make_cohort(tmp_path / "wishes.csv", tmp_path / "other", kept, seed=7, workers=1)
    assert table["status"].tolist() == ["refused", "out of reach"]
    assert contents(kept) == before


def test_two_cohorts_do_not_work_on_one_folder(library: Path, wishes: Path, tmp_path: Path) -> None:
    from filelock import FileLock

    with FileLock(tmp_path / ".dances.lock"), pytest.raises(InputError, match="another cohort is being made"):
        make_cohort(wishes, library, tmp_path, workers=1)


def test_a_library_that_changed_meanwhile_stops_all(library: Path, wishes: Path, tmp_path: Path) -> None:
    (wish, *_) = read_wishes(wishes, open_library(library))
    with pytest.raises(InputError, match="it is another library here"):
        cohort.make_dance(wish, library, "0" * 64, tmp_path)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="the rights of a folder bind nobody here")
def test_a_folder_that_cannot_be_written_is_said(library: Path, wishes: Path, tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(InputError, match="cannot be written"):
        make_cohort(wishes, library, tmp_path, workers=1)


def test_a_file_in_place_of_the_folder_is_said(library: Path, wishes: Path) -> None:
    with pytest.raises(InputError, match=r"cannot be written \(File exists\)"):
        make_cohort(wishes, library, wishes, workers=1)


def test_a_name_alone_puts_dances_side_by_side(library: Path, tmp_path: Path) -> None:
    (tmp_path / "wishes.csv").write_text("name,duration_s,transition\nwarm,12,off\n")
    make_cohort(tmp_path / "wishes.csv", library, tmp_path / "out", workers=1)
    assert list(read_dances(tmp_path / "out")) == ["warm"]
