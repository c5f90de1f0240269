"""The player in a real JupyterLab: what is seen, what the kernel knows, and the keyboard."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

pytestmark = pytest.mark.browser

HOSTILE = "<img src=x onerror=document.title='broken'>"
PLAYER = f"""
import numpy as np
from studykit.motion.kinematics import joint_positions
from studykit.library import synthesis
from studykit.widgets import MotionPlayer

dance = synthesis.dance(synthesis.figures(synthesis.STYLES[1], 1, np.random.default_rng(1)), np.full(1, 0.5))
positions = joint_positions(dance)
player = MotionPlayer(
    positions=positions, frame_rate_hz=30.0, title={HOSTILE!r}, is_synthetic=True,
    joint_values=np.linspace(0.0, 20.0, 24), joint_values_label="energy, J",
    marks=[(0.5, 0.9, {HOSTILE!r}, "flag"), (2.0, 3.0, "left_foot floats (cut)", "cut")],
    ghost=positions + [0.9, 0.0, 0.0],
)
watch(player, "time_s", "is_playing", "speed", "is_looping")
player
"""


def frame(notebook: Any) -> int:
    return int(notebook.page.locator(".sk-player").first.get_attribute("data-frame"))


def test_keys_step_mark_and_play_and_the_kernel_knows(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(PLAYER)
    page = notebook.page
    page.locator(".sk-slider").focus()
    for _ in range(7):
        page.keyboard.press("ArrowRight")
    assert frame(notebook) == 7
    notebook.wait_for("time_s", lambda time: abs(time - 7 / 30) < 1e-9)
    page.keyboard.press("]")
    assert frame(notebook) == 15
    assert page.locator(".sk-here").inner_text() == HOSTILE
    page.keyboard.press("]")
    notebook.wait_for("time_s", lambda time: abs(time - 2.0) < 1e-9)
    notebook.picture("player-light")
    page.keyboard.press("[")
    assert frame(notebook) == 15
    page.keyboard.press("End")
    assert frame(notebook) == 119
    page.keyboard.press("-")
    notebook.wait_for("speed", lambda speed: speed == 0.75)
    page.keyboard.press("l")
    notebook.wait_for("is_looping", lambda is_looping: not is_looping)
    page.keyboard.press("Space")  # from the end it begins again
    notebook.wait_for("is_playing", bool)
    page.wait_for_function(
        "() => { const f = document.querySelector('.sk-player').dataset.frame; return f > 3 && f < 119 }"
    )
    page.keyboard.press("Space")
    notebook.wait_for("is_playing", lambda is_playing: not is_playing)
    assert 3 < frame(notebook) < 119


def test_playing_keeps_the_time_of_the_browser_s_clock(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(PLAYER)
    page = notebook.page
    page.locator(".sk-slider").focus()
    page.wait_for_timeout(300)
    # From here on a picture is drawn when the test says so, at the time that the test says.
    page.evaluate("() => { window.due = []; window.requestAnimationFrame = act => window.due.push(act) }")
    draw = "time => { const due = window.due; window.due = []; for (const act of due) act(time) }"
    page.keyboard.press("Space")
    for time_ms, shown in [(500, 0), (1500, 30), (1600, 33)]:
        page.evaluate(draw, time_ms)
        assert frame(notebook) == shown
    page.locator(".sk-speed select").select_option("2")
    notebook.wait_for("speed", lambda speed: speed == 2.0)
    page.evaluate(draw, 2100)  # half a second twice as fast
    assert frame(notebook) == 63
    page.evaluate(draw, 3600)  # three seconds more: past the end, and round
    assert frame(notebook) == 33
    page.locator(".sk-speed select").select_option("0.25")
    notebook.wait_for("speed", lambda speed: speed == 0.25)
    page.evaluate(draw, 4600)
    assert frame(notebook) == 40
    page.locator(".sk-slider").focus()
    page.keyboard.press("l")
    notebook.wait_for("is_looping", lambda is_looping: not is_looping)
    page.evaluate(draw, 60_000)
    assert frame(notebook) == 119
    notebook.wait_for("is_playing", lambda is_playing: not is_playing)


def test_what_a_file_wrote_is_shown_as_text(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(PLAYER)
    page = notebook.page
    assert page.locator(".sk-title").inner_text() == HOSTILE
    assert page.locator(".sk-widget img").count() == 0
    assert page.title() != "broken"
    assert page.locator(".sk-badge").inner_text() == "SYNTHETIC: nobody danced this"


def test_the_figure_is_drawn_in_light_and_dark(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(PLAYER)
    shades = {}
    for theme in ("JupyterLab Light", "JupyterLab Dark"):
        notebook.dress(theme)
        notebook.picture(f"player-{theme.split()[1].lower()}")
        picture = notebook.page.locator(".sk-canvas").screenshot()
        assert len(picture) > 10_000  # an empty floor alone is smaller
        shades[theme] = notebook.page.evaluate(
            "() => getComputedStyle(document.querySelector('.sk-stage')).backgroundColor"
        )
    assert len(set(shades.values())) == 2


def test_turning_and_stepping_change_the_picture(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(PLAYER)
    canvas = notebook.page.locator(".sk-canvas")
    canvas.focus()
    pictures = [canvas.screenshot()]
    for key in ("Shift+ArrowLeft", "ArrowRight", "r"):
        for _ in range(5):
            notebook.page.keyboard.press(key)
        notebook.page.wait_for_timeout(200)
        pictures.append(canvas.screenshot())
    assert len(set(pictures)) == 4
    assert frame(notebook) == 5


def test_without_webgl_the_player_says_so_and_still_steps(open_notebook: Callable[..., Any]) -> None:
    without = "HTMLCanvasElement.prototype.getContext = () => null;"
    notebook = open_notebook(PLAYER, before=without)
    assert "WebGL is not available" in notebook.page.locator(".sk-sorry").inner_text()
    notebook.page.locator(".sk-slider").focus()
    notebook.page.keyboard.press("ArrowRight")
    notebook.wait_for("time_s", lambda time: time > 0.0)
    notebook.picture("player-without-webgl")


def test_closing_the_output_ends_the_player(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(PLAYER)
    page = notebook.page
    page.evaluate("() => { window.canvas = document.querySelector('.sk-canvas') }")
    page.evaluate("() => window.jupyterapp.commands.execute('notebook:clear-all-cell-outputs')")
    page.wait_for_selector(".sk-widget", state="detached")
    assert page.evaluate("() => window.canvas.getContext('webgl2').isContextLost()")
