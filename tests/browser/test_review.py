"""The review of takes in a real JupyterLab, on a library with a planted jump."""

from __future__ import annotations

import csv
from collections.abc import Callable
from typing import Any

import pytest

pytestmark = pytest.mark.browser

HOSTILE = "<img src=x onerror=document.title='broken'>"
REVIEW = """
from pathlib import Path
import numpy as np
from studykit.io.bvh import bvh_text
from studykit.io.datasets.read import find_recipe
from studykit.library import synthesis
from studykit.library.build import build
from studykit.widgets import review

takes = Path("takes")
takes.mkdir()
(takes / "library.toml").write_text(
    'data_set = "two-takes"\\nlicence = "CC0-1.0"\\nskeleton = "smpl"\\nunits_m = 0.01\\n'
    '[[takes]]\\nmatch = "*.bvh"\\ngenre = "waltz"\\nperformer = "Ada"\\n'
)
for number, name in enumerate(["<b>one</b>".replace("/", "-"), "two"]):
    dance = synthesis.dance(
        synthesis.figures(synthesis.STYLES[number], 9, np.random.default_rng(number)), np.full(9, 0.3)
    )
    rows = bvh_text(dance).splitlines()
    first = rows.index("MOTION") + 3
    for glitch in (200, 420):  # a knee is turned round for one frame
        broken = rows[first + glitch].split()
        broken[9:12] = ["-150", "80", "0"]
        rows[first + glitch] = " ".join(broken)
    (takes / f"{name}.bvh").write_text("\\n".join(rows))
build({takes: find_recipe(takes)}, Path("library"))
desk = review("library", reviewer="MK")
watch(desk, "take", "takes", "stretches", "chosen", "decided", "decisions", "status", "can_undo", "time_s")
desk
"""


def saved(notebook: Any) -> list[dict[str, str]]:
    """Read the decisions from their file beside the library."""
    with (notebook.folder / "library.decisions.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_stretches_are_decided_by_keyboard_and_saved_at_once(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(REVIEW)
    page = notebook.page
    notebook.wait_for("stretches", lambda stretches: len(stretches) >= 2)
    page.locator(".sk-canvas").focus()
    page.keyboard.press("n")
    notebook.wait_for("chosen", lambda chosen: chosen == 0)
    first = notebook.python("stretches")[0]
    notebook.wait_for("time_s", lambda time: abs(time - first["start_s"]) < 0.02)
    page.keyboard.press("c")
    notebook.wait_for("decided", lambda decided: decided >= 1)
    assert [row["decision"] for row in saved(notebook)] == ["cut"]
    assert saved(notebook)[0]["reviewer"] == "MK"
    assert float(saved(notebook)[0]["start_s"]) == pytest.approx(first["start_s"])
    assert "studykit library build" in notebook.wait_for("status", lambda status: "Saved" in status)
    page.keyboard.press("n")
    notebook.wait_for("chosen", lambda chosen: chosen == 1)
    page.get_by_label("Note to the decision").fill(HOSTILE)
    page.locator("[data-place='keep 1']").click()
    notebook.wait_for("decisions", lambda decisions: any(HOSTILE in words for words in decisions))
    page.locator(".sk-decided summary").click()
    for theme in ("JupyterLab Light", "JupyterLab Dark"):
        notebook.dress(theme)
        notebook.picture(f"review-{theme.split()[1].lower()}")
    assert HOSTILE in page.locator(".sk-decided").inner_text()
    assert page.locator(".sk-widget img, .sk-widget b").count() == 0
    assert page.title() != "broken"
    page.get_by_role("button", name="Undo").click()
    notebook.wait_for("decisions", lambda decisions: not any(HOSTILE in words for words in decisions))
    assert [row["decision"] for row in saved(notebook)] == ["cut", "keep", ""]


def test_a_stretch_of_ones_own_is_cut_in_another_take(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(REVIEW)
    page = notebook.page
    page.locator("select[aria-label=Take]").select_option("two")
    notebook.wait_for("take", lambda take: take == "two")
    before = len(notebook.python("stretches"))
    page.wait_for_function("() => document.querySelector('.sk-title').innerText.startsWith('two')")
    page.locator(".sk-slider").focus()
    for _ in range(6):
        page.keyboard.press("ArrowRight")
    page.get_by_role("button", name="from here").click()
    assert page.get_by_role("button", name="Cut it").is_disabled()
    page.locator(".sk-slider").focus()
    for _ in range(9):
        page.keyboard.press("ArrowRight")
    page.get_by_role("button", name="to here").click()
    page.get_by_role("button", name="Cut it").click()
    notebook.wait_for("stretches", lambda stretches: len(stretches) == before + 1)
    (row,) = saved(notebook)
    assert (row["take"], row["decision"]) == ("two", "cut")
    assert float(row["start_s"]) == pytest.approx(0.2)
    assert float(row["stop_s"]) == pytest.approx(0.5)
