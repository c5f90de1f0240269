"""The review widget: what it shows, what it saves, and what undoing gives back."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from studykit.core.errors import InputError
from studykit.io.bvh import bvh_text
from studykit.io.datasets.read import find_recipe
from studykit.io.datasets.take import Take, TakeSource
from studykit.library import synthesis
from studykit.library.build import build
from studykit.library.review import decisions_path
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY
from studykit.widgets import review
from studykit.widgets.reviewer.widget import Reviewer

FLAGGED = [
    ("a/1", 1.0, 1.2, "speed", "left_foot"),
    ("a/1", 0.2, 0.3, "jump", ""),
    ("b", 0.5, 0.6, "floor", ""),
]


@dataclass
class Shelf:
    """Findings and decisions in memory, in the shape of `studykit.library.review`."""

    rate_hz: float = 120.0
    is_full: bool = False
    partners: tuple[str, ...] = ()
    written: list[dict[str, Any]] = field(default_factory=list)

    def findings(self, library: Path) -> pd.DataFrame:
        rows = {row[:3]: dict(zip(("rule", "joint"), row[3:], strict=True)) for row in FLAGGED}
        for word in self.written:
            key = (word["take"], word["start_s"], word["stop_s"])
            rows.setdefault(key, {"rule": "by hand", "joint": np.nan})
            rows[key] |= {name: word[name] for name in ("decision", "note", "reviewer")}
            if rows[key]["rule"] == "by hand" and not word["decision"]:
                del rows[key]
        blank = {"decision": "", "note": np.nan, "reviewer": ""}
        return pd.DataFrame(
            [
                {"take": take, "start_s": start, "stop_s": stop} | blank | row
                for (take, start, stop), row in rows.items()
            ]
        )

    def take_again(self, library: Path, name: str) -> Take:
        if name == "b":
            raise InputError("the source of b is gone", where=library, remedy="bring it back")
        rotations = np.zeros((480, 24, 4))
        rotations[..., 0] = 1.0
        root = np.zeros((480, 3))
        root[:, 0] = np.arange(480) / 480.0
        source = TakeSource(
            data_set="set",
            performer="",
            genre="",
            licence="CC0-1.0",
            is_synthetic=True,
            sha256="0" * 64,
            partners=self.partners,
        )
        motion = Motion(
            skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=root, frame_rate_hz=self.rate_hz
        )
        return Take(name=name, motion=motion, source=source)

    def decide(self, library: Path, **word: Any) -> None:
        if self.is_full:
            raise OSError("no space left")
        self.written.append(word)


@pytest.fixture
def shelf() -> Shelf:
    return Shelf()


@pytest.fixture
def desk(shelf: Shelf, tmp_path: Path) -> Reviewer:
    return review(tmp_path, reviewer="MK", source=shelf)


def press(desk: Reviewer, **message: Any) -> None:
    """Do what the browser does when somebody presses something."""
    desk._handle_custom_msg(message, [])


def test_the_first_take_with_something_open_is_shown(desk: Reviewer) -> None:
    assert desk.take == "a/1"
    assert desk.takes == [{"name": "a/1", "total": 2, "open": 2}, {"name": "b", "total": 1, "open": 1}]
    assert [stretch["words"] for stretch in desk.stretches] == ["jump", "speed, left_foot"]
    assert [mark[3] for mark in desk.marks] == ["flag", "flag"]
    assert desk.is_synthetic


def test_a_fast_take_is_thinned_without_moving_in_time(desk: Reviewer) -> None:
    assert (desk.frame_rate_hz, len(desk.positions)) == (60.0, 240)
    # 1 s after the start the pelvis is 120/480 m along, whatever the rate.
    assert desk.positions[60, 0, 0] == pytest.approx(0.25)


def test_a_decision_is_saved_at_once_and_shown(desk: Reviewer, shelf: Shelf) -> None:
    press(desk, deed="decide", start_s=1.0, stop_s=1.2, decision="cut", note="a <b>slip</b>")
    assert shelf.written == [
        {
            "take": "a/1", "start_s": 1.0, "stop_s": 1.2, "decision": "cut", "note": "a <b>slip</b>",
            "reviewer": "MK",
        }
    ]  # fmt: skip
    assert [mark[3] for mark in desk.marks] == ["flag", "cut"]
    assert desk.takes[0] == {"name": "a/1", "total": 2, "open": 1}
    assert desk.decided == 1
    assert desk.decisions == ["a/1, 1.00–1.20 s, speed, left_foot: cut by MK: a <b>slip</b>"]
    assert "studykit library build" in desk.status


def test_a_stretch_of_ones_own_is_cut(desk: Reviewer, shelf: Shelf) -> None:
    desk.decide(2.0, 2.5, "cut", note="leaves the floor")
    assert [stretch["words"] for stretch in desk.stretches] == ["jump", "speed, left_foot", "by hand"]
    assert desk.chosen == 2
    desk.undo()
    assert len(desk.stretches) == 2
    assert [word["decision"] for word in shelf.written] == ["cut", ""]


def test_undoing_gives_back_what_was_there_before(desk: Reviewer, shelf: Shelf) -> None:
    for decision, note in (("cut", "first"), ("keep", "second")):
        desk.decide(1.0, 1.2, decision, note=note)
    desk.undo()
    last = shelf.written[-1]
    assert (last["decision"], last["note"]) == ("cut", "first")
    assert desk.can_undo
    desk.undo()
    assert shelf.written[-1]["decision"] == ""
    assert not desk.can_undo
    with pytest.raises(InputError, match="nothing to undo"):
        desk.undo()


@pytest.mark.parametrize(
    ("start_s", "stop_s", "decision"),
    [
        (1.0, 1.0, "cut"),
        (2.0, 1.0, "cut"),
        (-1.0, 1.0, "cut"),
        (0.0, 1.0, "delete"),
        (0.0, float("nan"), "cut"),
    ],
)
def test_what_is_no_decision_is_refused(
    desk: Reviewer, shelf: Shelf, start_s: float, stop_s: float, decision: str
) -> None:
    with pytest.raises(InputError):
        desk.decide(start_s, stop_s, decision)
    assert shelf.written == []


@pytest.mark.parametrize(
    "message",
    [
        {"deed": "decide", "start_s": "0", "stop_s": 1.0, "decision": "cut", "note": ""},
        {"deed": "decide", "start_s": 0.0, "stop_s": float("inf"), "decision": "cut", "note": ""},
        {"deed": "decide", "start_s": 0.0, "stop_s": 1.0, "decision": "delete", "note": ""},
        {"deed": "decide", "start_s": 0.0, "stop_s": 1.0, "decision": ["cut"], "note": ""},
        {"deed": "undo"},
        {"deed": "take", "take": "../../secret"},
        {"deed": "format"},
        {},
    ],
)
def test_a_message_that_means_nothing_is_answered_in_words(
    desk: Reviewer, shelf: Shelf, message: dict[str, Any]
) -> None:
    press(desk, **message)
    assert desk.status
    assert "Saved" not in desk.status
    assert (shelf.written, desk.take) == ([], "a/1")


def test_a_take_whose_source_is_gone_says_so_and_leaves_the_other(desk: Reviewer) -> None:
    press(desk, deed="take", take="b")
    assert "the source of b is gone" in desk.status
    assert (desk.take, len(desk.positions)) == ("a/1", 240)


def test_who_danced_along_is_shown_beside(tmp_path: Path) -> None:
    assert len(review(tmp_path, reviewer="MK", source=Shelf()).ghost) == 0
    assert len(review(tmp_path, reviewer="MK", source=Shelf(partners=("elsewhere",))).ghost) == 0
    together = review(tmp_path, reviewer="MK", source=Shelf(partners=("a/1",)))
    np.testing.assert_array_equal(together.ghost, together.positions)
    gone = review(tmp_path, reviewer="MK", source=Shelf(partners=("b",)))
    assert (gone.take, len(gone.ghost)) == ("a/1", 0)
    assert "The partner cannot be shown" in gone.status


def test_what_cannot_be_saved_is_not_shown_as_saved(desk: Reviewer, shelf: Shelf) -> None:
    shelf.is_full = True
    press(desk, deed="decide", start_s=1.0, stop_s=1.2, decision="cut", note="")
    assert "no space left" in desk.status
    assert (desk.decided, desk.can_undo) == (0, False)


def test_nobody_decides_without_a_name(shelf: Shelf, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="reviewer"):
        review(tmp_path, reviewer=" ", source=shelf)


@pytest.fixture
def library(tmp_path: Path) -> Path:
    """A library of two takes, in one of which a knee is turned round for one frame."""
    takes = tmp_path / "takes"
    takes.mkdir()
    (takes / "library.toml").write_text(
        'data_set = "two-takes"\nlicence = "CC0-1.0"\nskeleton = "smpl"\nunits_m = 0.01\n'
    )
    for number, name in enumerate(("glitch", "smooth")):
        rng = np.random.default_rng(number)
        dance = synthesis.dance(synthesis.figures(synthesis.STYLES[0], 6, rng), np.full(6, 0.3))
        rows = bvh_text(dance).splitlines()
        if name == "glitch":
            broken = rows.index("MOTION") + 3 + 200
            rows[broken] = " ".join(
                [*rows[broken].split()[:9], "-150", "80", "0", *rows[broken].split()[12:]]
            )
        (takes / f"{name}.bvh").write_text("\n".join(rows))
    build({takes: find_recipe(takes)}, tmp_path / "library")
    return tmp_path / "library"


def test_a_library_on_disk_can_be_reviewed(library: Path) -> None:
    desk = review(library, reviewer="MK")
    assert [take["name"] for take in desk.takes] == ["glitch", "smooth"]
    assert [take["open"] > 0 for take in desk.takes] == [True, False]
    assert desk.take == "glitch"
    assert desk.stretches[0]["start_s"] == pytest.approx(200 / 30, abs=0.1)
    desk.open_take("smooth")  # nothing was flagged, and yet something can be cut
    desk.decide(1.0, 1.5, "cut")
    assert desk.decided == 1
    assert ",1.000000,1.500000,cut,,MK" in decisions_path(library).read_text()
