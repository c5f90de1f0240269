"""The blinded rating in a real JupyterLab."""

from __future__ import annotations

import csv
from collections.abc import Callable
from typing import Any

import pytest

pytestmark = pytest.mark.browser

RATING = """
from studykit.library import make_sample, open_library
from studykit.library.rating import RatingSheet, rating_plan
from studykit.widgets import rating

make_sample("library", segments=24, seed=1)
library = open_library("library")
plan = rating_plan(library, windows=8, raters=("A", "B"), seed=2)
RatingSheet("sheet.csv", plan).record(
    rater="B", window=int(plan.window[0]), intensity="intense", variety="hard"
)
rater = rating(library, plan=plan, sheet="sheet.csv", rater="A")
watch(rater, "done", "total", "turn", "can_undo", "status", "is_playing")
rater
"""


def saved(notebook: Any) -> list[dict[str, str]]:
    """Read rater A's lines of the sheet."""
    with (notebook.folder / "sheet.csv").open(newline="") as file:
        return [row for row in csv.DictReader(file) if row["rater"] == "A"]


def test_dances_are_rated_by_keyboard_and_saved_at_once(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(RATING)
    page = notebook.page
    assert page.locator(".sk-progress").inner_text() == "1 of 8"
    page.locator(".sk-canvas").focus()
    page.keyboard.press("2")
    assert page.get_by_role("button", name="Save and go on").is_disabled()
    page.keyboard.press("Enter")  # one question is still open
    page.keyboard.press("3")
    for theme in ("JupyterLab Light", "JupyterLab Dark"):
        notebook.dress(theme)
        notebook.picture(f"rating-{theme.split()[1].lower()}")
    page.locator(".sk-canvas").focus()  # a new theme takes it away
    page.keyboard.press("Enter")
    notebook.wait_for("done", lambda done: done == 1)
    (row,) = saved(notebook)
    assert (row["event"], row["intensity"], row["variety"]) == ("rated", "intense", "easy")
    page.wait_for_function("() => document.querySelector('.sk-progress').innerText === '2 of 8'")
    assert page.locator(".sk-answer[aria-pressed=true]").count() == 0
    page.get_by_role("button", name="Undo the last answer").click()
    notebook.wait_for("done", lambda done: done == 0)
    assert [row["event"] for row in saved(notebook)] == ["rated", "withdrawn"]


def test_nothing_is_told_about_a_dance(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(RATING)
    shown = notebook.page.locator(".sk-widget").first.inner_text()
    for told in ("synthetic-0", "sway", " J", "energy", "nobody (", "studykit-synthetic", "CC0"):
        assert told not in shown


def test_all_can_be_rated_to_the_end(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(RATING)
    page = notebook.page
    page.locator(".sk-slider").focus()
    for done in range(8):
        page.wait_for_function(
            f"() => document.querySelector('.sk-progress').innerText === '{done + 1} of 8'"
        )
        for key in ("1", "4", "Enter"):
            page.keyboard.press(key)
        notebook.wait_for("done", lambda value, wanted=done + 1: value == wanted)
    page.wait_for_function("() => document.querySelector('.sk-progress').innerText.includes('Thank you')")
    assert len(saved(notebook)) == 8
    notebook.picture("rating-over")
