"""The body map in a real JupyterLab: joints by mouse and by keyboard, and what the kernel makes of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

pytestmark = pytest.mark.browser

PICKER = """
from studykit.widgets import joint_picker

picker = joint_picker()
watch(picker, "weights", "speed_limits_rad_s", spared=lambda: picker.mask.spared)
picker
"""


def joint(notebook: Any, name: str) -> Any:
    return notebook.page.locator(f"[data-joint={name}]")


def test_clicks_go_from_free_to_reduced_to_spared_and_back(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(PICKER)
    elbow = joint(notebook, "right_elbow")
    elbow.click()
    notebook.wait_for("weights", lambda weights: weights == {"right_elbow": 0.5})
    elbow.click()
    notebook.wait_for("weights", lambda weights: weights == {"right_elbow": 0.0})
    assert notebook.python("spared") == ["right_elbow", "right_wrist", "right_hand"]
    assert elbow.get_attribute("aria-label") == "right elbow: spared"
    assert joint(notebook, "right_hand").get_attribute("aria-label").startswith(
        "right hand: spared along with the right elbow"
    )  # fmt: skip
    notebook.picture("body-map-light")
    notebook.dress("JupyterLab Dark")
    notebook.picture("body-map-dark")
    elbow.click()
    notebook.wait_for("weights", lambda weights: weights == {})


def test_the_person_s_right_is_on_the_viewer_s_left(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(PICKER)
    right, left = (joint(notebook, f"{side}_elbow").bounding_box()["x"] for side in ("right", "left"))
    assert right < left
    labels = {
        side: notebook.page.locator(f".sk-side-{side}").bounding_box()["x"] for side in ("right", "left")
    }
    assert labels["right"] < labels["left"]
    assert notebook.page.locator(".sk-side-right").text_content() == "RIGHT"


def test_the_keyboard_goes_from_joint_to_joint_and_spares(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(PICKER)
    page = notebook.page
    joint(notebook, "right_elbow").focus()
    page.keyboard.press("ArrowUp")
    assert page.evaluate("() => document.activeElement.dataset.joint") == "right_shoulder"
    for key in ("ArrowDown", "ArrowDown", "Enter"):
        page.keyboard.press(key)
    notebook.wait_for("weights", lambda weights: weights == {"right_wrist": 0.5})
    page.keyboard.press("Space")
    notebook.wait_for("weights", lambda weights: weights == {"right_wrist": 0.0})
    assert notebook.python("spared") == ["right_wrist", "right_hand"]
    # One joint alone is reached by Tab; the arrows reach the others.
    assert page.locator(".sk-joint[tabindex='0']").count() == 1
    page.keyboard.press("Control+z")
    notebook.wait_for("weights", lambda weights: weights == {"right_wrist": 0.5})
    page.keyboard.press("Control+Shift+z")
    notebook.wait_for("weights", lambda weights: weights == {"right_wrist": 0.0})


def test_a_slider_weighs_and_a_field_limits(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(PICKER)
    page = notebook.page
    joint(notebook, "left_knee").click()
    page.get_by_label("How much the joint may work").fill("0.25")
    notebook.wait_for("weights", lambda weights: weights == {"left_knee": 0.25})
    page.get_by_label("Speed limit, rad/s").fill("2")
    page.get_by_label("Speed limit, rad/s").press("Enter")
    notebook.wait_for("speed_limits_rad_s", lambda limits: limits == {"left_knee": 2.0})
    assert "115°/s" in page.locator(".sk-details").inner_text()
    assert "at most 2.0 rad/s" in joint(notebook, "left_ankle").get_attribute("aria-label")
    page.get_by_role("button", name="Undo").click()
    notebook.wait_for("speed_limits_rad_s", lambda limits: limits == {})
    page.get_by_role("button", name="Free all").click()
    notebook.wait_for("weights", lambda weights: weights == {})
    assert "Every joint is free" in page.locator(".sk-chosen").first.inner_text()
