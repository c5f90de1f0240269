"""The blinded rating: what it tells, what it asks, what it saves, and where it goes on."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.errors import InputError
from studykit.library.rating import RatingSheet, rating_plan, window_motion
from studykit.motion.kinematics import joint_positions
from studykit.widgets import rating
from studykit.widgets.rater.widget import Rater


@pytest.fixture
def library(made_library: Callable[..., DanceLibrary]) -> DanceLibrary:
    return made_library(30, seed=4)


@pytest.fixture
def plan(library: DanceLibrary) -> pd.DataFrame:
    return rating_plan(library, windows=8, raters=("A", "B"), seed=1)


@pytest.fixture
def rater(library: DanceLibrary, plan: pd.DataFrame, tmp_path: Path) -> Rater:
    return rating(library, plan=plan, sheet=tmp_path / "sheet.csv", rater="B")


def press(rater: Rater, **message: Any) -> None:
    """Do what the browser does when somebody presses something."""
    rater._handle_custom_msg(message, [])


def shown(rater: Rater, library: DanceLibrary, plan: pd.DataFrame) -> int:
    """Find the window that plays."""
    own = plan[plan["rater"] == "B"]
    for window, segments in zip(own["window"], own["segments"], strict=True):
        positions = joint_positions(window_motion(library, segments))
        if len(positions) == len(rater.positions) and np.allclose(positions, rater.positions, atol=1e-6):
            return int(window)
    raise AssertionError("no window of the plan plays")


def test_the_windows_come_in_the_rater_s_own_order(
    rater: Rater, library: DanceLibrary, plan: pd.DataFrame
) -> None:
    seen = []
    for _ in range(8):
        seen.append(shown(rater, library, plan))
        rater.answer(intensity="light", variety="hard")
    assert seen == plan[plan["rater"] == "B"].sort_values("order")["window"].tolist()
    assert (rater.done, rater.total, len(rater.positions)) == (8, 8, 0)
    with pytest.raises(InputError, match="all dances are rated"):
        rater.answer(intensity="light", variety="hard")


def test_nothing_that_could_sway_crosses_to_the_browser(
    library: DanceLibrary, plan: pd.DataFrame, tmp_path: Path
) -> None:
    other = RatingSheet(tmp_path / "sheet.csv", plan)
    other.record(rater="A", window=int(plan["window"][0]), intensity="intense", variety="hard")
    rater = rating(library, plan=plan, sheet=tmp_path / "sheet.csv", rater="B")
    state = rater.get_state()
    own = {
        "positions", "ghost", "parents", "sides", "head_joint", "room", "frame_rate_hz", "is_synthetic",
        "questions", "total", "done", "turn", "can_undo", "status", "time_s", "is_playing", "speed",
        "is_looping", "is_mirrored", "ghost_name", "joint_values", "joint_values_label", "marks", "title",
    }  # fmt: skip
    foreign = {name for name in state if not name.startswith("_")} - own
    assert foreign == {"layout", "tabbable", "tooltip"}  # every widget has these
    assert (rater.title, rater.joint_values, rater.marks, rater.status) == ("", [], [], "")
    assert rater.done == 0  # what the other has rated is not counted


def test_answers_are_saved_at_once_and_the_rating_goes_on_where_it_was_left(
    rater: Rater, library: DanceLibrary, plan: pd.DataFrame, tmp_path: Path
) -> None:
    first = shown(rater, library, plan)
    press(rater, deed="answer", turn=rater.turn, answers={"intensity": "intense", "variety": "easy"})
    saved = RatingSheet(tmp_path / "sheet.csv", plan).ratings()
    assert saved.to_dict("records") == [
        {"rater": "B", "window": first, "intensity": "intense", "variety": "easy"}
    ]
    again = rating(library, plan=plan, sheet=tmp_path / "sheet.csv", rater="B")
    assert again.done == rater.done == 1
    assert shown(again, library, plan) == shown(rater, library, plan) != first
    press(again, deed="undo")
    assert (again.done, again.can_undo) == (0, False)
    assert shown(again, library, plan) == first


@pytest.mark.parametrize(
    "answers",
    [
        {},
        {"intensity": "light"},
        {"intensity": "light", "variety": "light"},
        {"intensity": "light", "variety": ""},
        {"intensity": 1, "variety": 2},
    ],
)
def test_both_questions_must_be_answered(rater: Rater, tmp_path: Path, answers: dict[str, Any]) -> None:
    press(rater, deed="answer", turn=rater.turn, answers=answers)
    assert "Not done" in rater.status
    assert rater.done == 0
    assert not (tmp_path / "sheet.csv").exists()


def test_a_second_press_does_not_answer_the_next_dance(rater: Rater) -> None:
    message = {"deed": "answer", "turn": rater.turn, "answers": {"intensity": "light", "variety": "easy"}}
    press(rater, **message)
    press(rater, **message)
    assert rater.done == 1
    assert "no longer" in rater.status


@pytest.mark.parametrize("message", [{}, {"deed": "format"}, {"deed": "answer"}, {"deed": "undo"}])
def test_a_message_that_means_nothing_changes_nothing(rater: Rater, message: dict[str, Any]) -> None:
    press(rater, **message)
    assert rater.done == 0
    assert rater.status


def test_a_dance_is_rated_at_its_own_speed(rater: Rater) -> None:
    with pytest.raises(InputError, match="rate it as danced"):
        rater.speed = 0.5
    assert rater.speed == 1.0


def test_a_rater_or_library_of_another_plan_is_refused(
    made_library: Callable[..., DanceLibrary], plan: pd.DataFrame, library: DanceLibrary, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match='no rater "C"'):
        rating(library, plan=plan, sheet=tmp_path / "sheet.csv", rater="C")
    with pytest.raises(InputError, match="give the library that the plan was made for"):
        rating(made_library(8), plan=plan, sheet=tmp_path / "sheet.csv", rater="A")
