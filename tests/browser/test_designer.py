"""The dance designer in a real JupyterLab: sliders search, joints are spared, limits are told."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from studykit.library import make_sample
from studykit.widgets import dance_designer

pytestmark = pytest.mark.browser

HOSTILE = "<img src=x onerror=document.title='broken'>"
DESIGNER = f"""
from dataclasses import replace
from studykit.library import make_sample, open_library
from studykit.widgets import dance_designer

make_sample("library", segments=200, seed=1)
library = open_library("library")
segments = library.segments.copy()
segments["take"] = {HOSTILE!r}
library = replace(library, segments=segments, name={HOSTILE!r})
designer = dance_designer(library, intensity=50.0)
watch(
    designer, "intensity", "variety", "seed", "found", "obstacle", "blocks", "status", "can_undo",
    "weights", "is_playing", "is_mirrored",
    spared=lambda: designer.goal.mask.spared if designer.goal and designer.goal.mask else [],
    ids=lambda: [segment.id for segment in designer.dance.segments] if designer.dance else [],
)
designer
"""


@pytest.fixture(scope="module", autouse=True)
def _compiled(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Search once here, so that no browser waits while the search is compiled for the first time."""
    library = make_sample(tmp_path_factory.mktemp("compiled") / "library", segments=40, seed=1)
    dance_designer(library)
    dance_designer(library, weights={"right_elbow": 0.5})


def picture(notebook: Any, name: str) -> None:
    """Keep a picture of all of the designer, which is higher than most screens."""
    notebook.page.set_viewport_size({"width": 1280, "height": 1500})
    notebook.page.wait_for_timeout(300)
    notebook.picture(name)


def slide(notebook: Any, label: str, value: float) -> None:
    """Move a slider as a hand does: a value, and the event of a move."""
    notebook.page.get_by_label(label, exact=True).first.fill(str(value))


def test_a_slider_searches_a_preview_and_the_button_the_dance(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(DESIGNER)
    page = notebook.page
    assert notebook.python("found") == "preview"
    before = notebook.python("ids")
    slide(notebook, "Intensity", 30)
    notebook.wait_for("intensity", lambda intensity: intensity == 30.0)
    notebook.wait_for("ids", lambda ids: ids not in ([], before))
    page.wait_for_function("() => document.querySelector('.sk-measures').innerText.includes('quick look')")
    asked = notebook.python("blocks")[0]["measures"][1]["asked"]
    page.wait_for_function(
        "asked => document.querySelector('.sk-measures').innerText.includes(asked)",
        arg=f"{asked:.1f} J asked",
    )
    page.get_by_role("button", name="Find this dance").click()
    notebook.wait_for("found", lambda found: found == "dance", patience_s=120.0)
    page.wait_for_function("() => document.querySelectorAll('.sk-measures .sk-hit').length === 4")
    assert page.locator(".sk-chip").count() == 8
    page.get_by_label("Folder for the files").fill("mine")
    page.get_by_role("button", name="Save", exact=True).click()
    notebook.wait_for("status", lambda status: status == "Saved as 30-0.55-on-seed0 in mine.")
    written = {path.suffix for path in (notebook.folder / "mine").iterdir()}
    assert written == {".npz", ".bvh", ".glb", ".json"}
    for theme in ("JupyterLab Light", "JupyterLab Dark"):
        notebook.dress(theme)
        picture(notebook, f"designer-{theme.split()[1].lower()}")


def test_sparing_a_joint_asks_for_another_dance_and_reports_on_it(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(DESIGNER)
    page = notebook.page
    elbow = page.locator("[data-joint=right_elbow]")
    elbow.click()
    notebook.wait_for("weights", lambda weights: weights == {"right_elbow": 0.5})
    elbow.click()
    notebook.wait_for("spared", lambda spared: spared == ["right_elbow", "right_wrist", "right_hand"])
    page.wait_for_function(
        "() => document.querySelector('[data-joint=right_elbow]').ariaLabel.includes('up to')"
    )
    page.get_by_role("button", name="Find this dance").click()
    notebook.wait_for("found", lambda found: found == "dance", patience_s=120.0)
    picture(notebook, "designer-spared")
    page.get_by_role("button", name="Undo").first.click()
    notebook.wait_for("weights", lambda weights: weights == {"right_elbow": 0.5})


def test_out_of_reach_offers_what_can_be_reached(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(DESIGNER)
    page = notebook.page
    slide(notebook, "Variety", 1.5)
    obstacle = notebook.wait_for("obstacle", bool)
    page.wait_for_function("() => !document.querySelector('.sk-obstacle').hidden")
    assert obstacle["sentence"] in page.locator(".sk-obstacle").inner_text()
    assert notebook.python("found") == ""
    picture(notebook, "designer-out-of-reach")
    page.get_by_role("button", name="Use these").click()
    notebook.wait_for("found", lambda found: found == "preview")
    assert notebook.python("obstacle") == {}
    assert notebook.python("variety") < 1.5
    page.locator(".sk-canvas").focus()
    page.keyboard.press("Control+z")
    notebook.wait_for("variety", lambda variety: variety == 1.5)


def test_another_one_is_another_dance_and_the_mirror_turns_it(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(DESIGNER)
    page = notebook.page
    first = notebook.python("ids")
    page.get_by_role("button", name="Another one").click()
    notebook.wait_for("seed", lambda seed: seed == 1)
    notebook.wait_for("ids", lambda ids: ids not in ([], first))
    page.locator(".sk-chip").nth(3).click()
    page.wait_for_function("() => document.querySelector('.sk-player').dataset.frame === '360'")
    before = page.locator(".sk-canvas").screenshot()
    page.get_by_role("button", name="Mirror").click()
    notebook.wait_for("is_mirrored", bool)
    page.wait_for_timeout(200)
    assert page.locator(".sk-canvas").screenshot() != before


def test_what_a_library_is_called_is_shown_as_text(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(DESIGNER)
    page = notebook.page
    assert page.locator(".sk-library").inner_text() == HOSTILE
    assert page.locator(".sk-widget img").count() == 0
    assert page.title() != "broken"
    assert HOSTILE in page.locator(".sk-chip").first.get_attribute("title")
    assert page.locator(".sk-badge").inner_text() == "SYNTHETIC: nobody danced this"
