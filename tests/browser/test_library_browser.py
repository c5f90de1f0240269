"""The library browser in a real JupyterLab."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

pytestmark = pytest.mark.browser

HOSTILE = "<img src=x onerror=document.title='broken'>"
BROWSER = f"""
from dataclasses import replace
from studykit.library import make_sample, open_library
from studykit.widgets import library_browser

make_sample("library", segments=24, seed=1)
library = open_library("library")
segments = library.segments.copy()
segments.loc[23, ["genre", "licence"]] = {HOSTILE!r}
library = replace(library, segments=segments)
browser = library_browser(library)
watch(browser, "filters", "sort", "page", "pages", "total", "selected", "is_playing", "facts", "title")
browser
"""


def energies(notebook: Any) -> list[float]:
    """Read the linear energies of the page that is shown."""
    cells = notebook.page.locator(".sk-table tbody tr td:nth-child(7)").all_inner_texts()
    return [float(text) for text in cells]


def test_filters_pages_and_sorting_come_from_the_kernel(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(BROWSER)
    page = notebook.page
    assert page.locator(".sk-table tbody tr").count() == 10
    page.get_by_label("Page after").click()
    notebook.wait_for("page", lambda number: number == 1)
    page.get_by_role("button", name="linear, J").click()
    notebook.wait_for("sort", lambda sort: sort == ["linear_j", "ascending"])
    page.get_by_role("button", name="linear, J").click()
    notebook.wait_for("sort", lambda sort: sort == ["linear_j", "descending"])
    assert notebook.python("page") == 0
    shown = energies(notebook)
    for _ in range(50):
        if shown == sorted(shown, reverse=True):
            break
        page.wait_for_timeout(50)
        shown = energies(notebook)
    assert shown == sorted(shown, reverse=True)
    page.get_by_label("least linear energy, J").fill(str(shown[4]))
    page.get_by_label("least linear energy, J").press("Enter")
    notebook.wait_for("total", lambda total: total in (4, 5))
    page.get_by_role("button", name="Show all").click()
    notebook.wait_for("total", lambda total: total == 24)


def test_a_row_chosen_by_keyboard_plays(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(BROWSER)
    page = notebook.page
    page.get_by_label("Play segment 0", exact=True).focus()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    notebook.wait_for("selected", lambda segment: segment == 2)
    notebook.wait_for("is_playing", bool)
    page.wait_for_function("() => document.querySelector('.sk-player').dataset.frame > 5")
    page.wait_for_selector(".sk-table tr[aria-selected=true]")
    # The focus stays on the row, so that the next one is one key away.
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    notebook.wait_for("selected", lambda segment: segment == 3)
    page.get_by_role("button", name="Pause").click()
    for theme in ("JupyterLab Light", "JupyterLab Dark"):
        notebook.dress(theme)
        notebook.picture(f"browser-{theme.split()[1].lower()}")


def test_a_hostile_genre_is_shown_as_text(open_notebook: Callable[..., Any]) -> None:
    notebook = open_notebook(BROWSER)
    page = notebook.page
    page.get_by_label("genre").select_option(HOSTILE)
    notebook.wait_for("total", lambda total: total == 1)
    page.get_by_label("Play segment 23").click()
    notebook.wait_for("selected", lambda segment: segment == 23)
    page.wait_for_function("() => document.querySelector('.sk-facts').innerText.includes('<img')")
    assert page.locator(".sk-widget img").count() == 0
    assert page.title() != "broken"
    notebook.picture("browser-hostile")
