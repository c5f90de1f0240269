"""A reviewer's words are kept beside the library and obeyed by its next build."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io.datasets.read import find_recipe
from studykit.library import make_sample, open_library, review, shard, store
from studykit.library.build import build
from studykit.library.measure import Decision, measured


@pytest.fixture
def library(takes_folder: Path, tmp_path: Path) -> Path:
    out = tmp_path / "reviewed"
    build({takes_folder: find_recipe(takes_folder)}, out)
    return out


def rebuilt(takes_folder: Path, library: Path):
    return build({takes_folder: find_recipe(takes_folder)}, library)


def starts(library, take: str) -> list[float]:
    return library.segments.query("take == @take")["start_s"].round(3).tolist()


def test_the_glitch_is_found_with_its_rule_and_joint(library: Path) -> None:
    found = review.findings(library)
    assert set(found["take"]) == {"waltz/01"}
    assert set(found["rule"]) == {"speed", "acceleration"}
    assert found["joint"].str.contains("ankle|foot|knee").all()
    # A knee was turned round 4.5 s after the beginning.
    assert found["start_s"].min() == pytest.approx(4.5, abs=0.05)
    assert found["stop_s"].max() == pytest.approx(4.57, abs=0.05)
    assert (found["decision"] == "").all()


def test_what_is_kept_by_hand_makes_segments_again(library: Path, takes_folder: Path) -> None:
    for row in review.findings(library).itertuples():
        review.decide(
            library,
            take=row.take,
            start_s=row.start_s,
            stop_s=row.stop_s,
            decision="keep",
            note="a kick",
            reviewer="Eva",
        )
    assert starts(open_library(library), "waltz/01") == [0.0, 4.567, 8.567]
    assert starts(rebuilt(takes_folder, library), "waltz/01") == [0.0, 4.0, 8.0, 12.0]
    found = review.findings(library)
    assert set(found["decision"]) == {"keep"}
    assert set(found["note"]) == {"a kick"}
    assert set(found["reviewer"]) == {"Eva"}


def test_what_is_cut_by_hand_makes_none(library: Path, takes_folder: Path) -> None:
    review.decide(library, take="tango", start_s=1.0, stop_s=1.5, decision="cut")
    assert starts(rebuilt(takes_folder, library), "tango") == [1.502, 5.506]
    row = review.findings(library).query("take == 'tango'").iloc[0]
    assert (row["rule"], row["decision"], row["start_s"], row["stop_s"]) == ("by hand", "cut", 1.0, 1.5)


def test_a_decision_can_be_taken_back_and_the_last_word_counts(library: Path, takes_folder: Path) -> None:
    for decision in ("cut", "", "cut", "keep"):
        review.decide(library, take="tango", start_s=1.0, stop_s=1.5, decision=decision)
    assert review.read_decisions(library) == {
        ("three-takes", "tango"): {
            shard.basis(review.take_again(library, "tango")): [Decision(1.0, 1.5, "keep")]
        }
    }
    review.decide(library, take="tango", start_s=1.0, stop_s=1.5, decision="")
    assert review.read_decisions(library) == {}
    assert starts(rebuilt(takes_folder, library), "tango") == [0.0, 4.004, 8.008]
    assert len(review.decisions_path(library).read_text().splitlines()) == 6  # nothing is erased


def test_decisions_outlive_the_library(library: Path, takes_folder: Path) -> None:
    review.decide(library, take="tango", start_s=1.0, stop_s=1.5, decision="cut")
    first = rebuilt(takes_folder, library)
    shutil.rmtree(library)
    again = rebuilt(takes_folder, library)
    assert again.sha256 == first.sha256
    assert starts(again, "tango") == [1.502, 5.506]


def test_a_take_is_read_again_as_it_was_cleaned(library: Path, takes_folder: Path) -> None:
    take = review.take_again(library, "waltz/02")
    assert take.name == "waltz/02"
    assert take.motion.frame_rate_hz == 60.0
    assert len(take.motion) == 750
    with pytest.raises(InputError, match="there is no take 'waltz/09'"):
        review.take_again(library, "waltz/09")
    (takes_folder / "tango.bvh").rename(takes_folder / "elsewhere.txt")
    try:
        with pytest.raises(InputError, match="the source of tango is gone; bring it back"):
            review.take_again(library, "tango")
    finally:
        (takes_folder / "elsewhere.txt").rename(takes_folder / "tango.bvh")


def test_made_up_takes_are_made_up_again(tmp_path: Path) -> None:
    make_sample(tmp_path / "sample", segments=20, seed=1)
    take = review.take_again(tmp_path / "sample", "synthetic-00001")
    assert take.source.is_synthetic
    assert len(take.motion) == 1200


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("three-takes,tango,0,1.0,0.5,cut,,", "line 3: no decision; write data_set"),
        ("three-takes,tango,0,1.0,1.5,remove,,", "line 3: no decision"),
        ("three-takes,tango,0,1.0,inf,cut,,", "line 3: no decision"),
        ("three-takes,tango", "line 3: no decision"),
    ],
)
def test_a_line_that_is_no_decision_is_named(library: Path, takes_folder: Path, line: str, said: str) -> None:
    review.decide(library, take="tango", start_s=1.0, stop_s=1.5, decision="cut")
    path = review.decisions_path(library)
    path.write_text(path.read_text() + line + "\n")
    with pytest.raises(InputError, match=f"{path.name}, {said}"):
        rebuilt(takes_folder, library)


@pytest.mark.parametrize(("start_s", "stop_s", "decision"), [(2.0, 1.0, "cut"), (1.0, 2.0, "delete")])
def test_what_is_no_decision_is_refused(library: Path, start_s, stop_s, decision) -> None:
    with pytest.raises(InputError, match="is no decision; say keep or cut"):
        review.decide(library, take="tango", start_s=start_s, stop_s=stop_s, decision=decision)
    assert not review.decisions_path(library).exists()


def test_a_later_word_goes_before_an_earlier_one_where_both_speak(library: Path) -> None:
    from studykit.library.measure import Settings

    motion = review.take_again(library, "tango").motion
    words = [Decision(0.0, 8.0, "cut"), Decision(0.0, 4.0, "keep")]
    assert measured(motion, Settings(), words).starts_s == pytest.approx([0.0, 480 / 59.94])
    assert measured(motion, Settings(), words[::-1]).starts_s == pytest.approx([480 / 59.94])
    assert np.array_equal(measured(motion, Settings(), words).is_mirrored, [False, False])


def test_a_decision_on_another_version_of_a_take_is_not_obeyed_but_told(
    takes_folder: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "takes"
    shutil.copytree(takes_folder, folder)
    library = tmp_path / "library"
    rebuilt(folder, library)
    review.decide(library, take="tango", start_s=1.0, stop_s=1.5, decision="cut")
    recipe = folder / "library.toml"
    recipe.write_text(recipe.read_text().replace("skip_frames = 4", "skip_frames = 5"))
    assert starts(rebuilt(folder, library), "tango") == [0.0, 4.004, 8.008]
    assert store.read_manifest(library)["decisions_ignored"] == 1
    recipe.write_text(recipe.read_text().replace("skip_frames = 5", "skip_frames = 4"))
    assert starts(rebuilt(folder, library), "tango") == [1.502, 5.506]
    assert store.read_manifest(library)["decisions_ignored"] == 0


def test_half_a_line_left_by_a_power_cut_is_dropped_and_excel_s_mark_is_no_matter(library: Path) -> None:
    review.decide(library, take="tango", start_s=1.0, stop_s=1.5, decision="cut")
    path = review.decisions_path(library)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes() + b"three-takes,tango,0,2.0")
    assert len(review.read_decisions(library)) == 1
    review.decide(library, take="tango", start_s=3.0, stop_s=3.5, decision="cut")
    assert review.findings(library).query("take == 'tango'")["start_s"].tolist() == [1.0, 3.0]


@pytest.mark.parametrize(("start_s", "stop_s"), [(0.0, float("inf")), (float("nan"), 1.0)])
def test_times_without_an_end_are_refused(library: Path, start_s: float, stop_s: float) -> None:
    with pytest.raises(InputError, match="is no decision"):
        review.decide(library, take="tango", start_s=start_s, stop_s=stop_s, decision="cut")
