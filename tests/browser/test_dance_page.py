"""A page of dances, opened from the disk in a real Chromium: it plays, and asks nobody for anything."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from studykit.choreography.choreograph import dance
from studykit.choreography.request import requested
from studykit.library import make_sample, open_library
from studykit.library.dance_file import write_dances
from studykit.motion.joint_mask import spare
from studykit.reports.dance_page import write_dance_page

pytestmark = pytest.mark.browser
HOSTILE = "</script><img src=x onerror=document.title='broken'>"
# Of the software renderer that stands in for a graphics card.
NOT_OURS = ("GPU stall due to ReadPixels", "GL Driver Message")


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make a dance of a made-up library, the same as if it spared an arm, and the page of both."""
    folder = tmp_path_factory.mktemp("dances")
    make_sample(folder / "library", segments=60, seed=1)
    library = open_library(folder / "library")
    free = dance(requested(library, duration_s=16.0, intensity=50.0), library)
    takes = (replace(free.segments[0], take=HOSTILE), *free.segments[1:])
    spared = replace(free, segments=takes, mask=spare("right_elbow", speed_limits_rad_s=6.0))
    dances = {"free": free, "spared": spared}
    write_dances(dances, folder)
    return write_dance_page(dances, folder / "dances.html", library=replace(library, name=HOSTILE))


@pytest.fixture
def open_page(browser: Any, page_file: Path) -> Iterator[Callable[..., Any]]:
    """Open the page from the disk in a window of some size; afterwards it must not have complained."""
    asked: list[str] = []
    complaints: list[str] = []
    contexts = []

    def begin(*, width: int = 1280, place: str = "") -> Any:
        context = browser.new_context(viewport={"width": width, "height": 900}, offline=True)
        contexts.append(context)
        page = context.new_page()
        page.on("request", lambda request: asked.append(request.url))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on(
            "console",
            lambda said: complaints.append(said.text) if said.type in ("error", "warning") else None,
        )
        page.goto(f"{page_file.as_uri()}{place}")
        page.wait_for_selector(".sk-play")
        page.wait_for_timeout(300)
        return page

    yield begin
    for context in contexts:
        context.close()
    assert [url for url in asked if not url.startswith((page_file.as_uri(), "data:"))] == []
    assert [text for text in complaints if not any(word in text for word in NOT_OURS)] == []


def frame(page: Any) -> int:
    return int(page.locator(".sk-player").get_attribute("data-frame"))


def keep(page: Any, name: str) -> None:
    """Keep a picture of the page where SHOTS says; for looking at, not for comparing."""
    if shots := os.environ.get("SHOTS"):
        page.screenshot(path=str(Path(shots) / f"{name}.png"), full_page=True)


def test_play_makes_the_time_move_and_the_figure_with_it(open_page: Callable[..., Any]) -> None:
    page = open_page()
    canvas = page.locator(".sk-canvas")
    canvas.scroll_into_view_if_needed()
    before = canvas.screenshot()
    assert (frame(page), len(before) > 10_000) == (0, True)  # an empty floor alone is smaller
    page.get_by_role("button", name="Play", exact=True).click()
    page.wait_for_function("() => document.querySelector('.sk-player').dataset.frame > 20")
    page.get_by_role("button", name="Pause").click()
    stopped = frame(page)
    assert stopped > 20
    assert "of 16.00 s" in page.locator(".sk-readout").inner_text()
    page.wait_for_timeout(300)
    assert frame(page) == stopped
    after = canvas.screenshot()
    assert after != before
    page.locator(".sk-mirror").click()
    page.wait_for_timeout(300)
    assert canvas.screenshot() != after
    keep(page, "dances")


def test_a_letter_leads_to_its_segment_and_is_marked_while_it_is_danced(
    open_page: Callable[..., Any],
) -> None:
    page = open_page()
    letters = page.locator(".sk-chip")
    assert letters.count() == 4
    assert letters.first.get_attribute("aria-current") == "true"
    letters.nth(2).click()
    assert frame(page) == 240
    marked = [letter.get_attribute("aria-current") for letter in letters.all()]
    assert marked == ["false", "false", "true", "false"]
    page.keyboard.press("ArrowRight")
    assert frame(page) == 241
    page.keyboard.press("+")
    assert page.locator(".sk-speed select").input_value() == "1.25"


def test_space_plays_before_anything_was_clicked_and_neither_scrolls_nor_takes_keys_of_others(
    open_page: Callable[..., Any],
) -> None:
    page = open_page()

    def is_playing() -> bool:
        return bool(page.get_by_role("button", name="Pause").count())

    page.keyboard.press("Space")
    page.wait_for_function("() => document.querySelector('.sk-player').dataset.frame > 5")
    page.keyboard.press("Space")
    assert (is_playing(), page.evaluate("() => scrollY")) == (False, 0)
    page.locator(".tabs a").first.focus()  # of a link, Space would scroll
    page.keyboard.press("Space")
    assert (is_playing(), page.evaluate("() => scrollY")) == (True, 0)
    page.keyboard.press("Shift+Space")
    page.locator(".sk-mirror").focus()
    page.keyboard.press("Space")
    assert (is_playing(), page.locator(".sk-mirror").get_attribute("aria-pressed")) == (True, "true")
    page.evaluate("() => document.body.append(document.createElement('textarea'))")
    page.locator("textarea").focus()
    page.keyboard.type("a b")
    assert (is_playing(), page.locator("textarea").input_value()) == (True, "a b")
    page.locator("h1").click()
    page.keyboard.press("Home")  # is the page's own where the player has no focus
    assert is_playing()


def test_tabs_change_the_dance_and_names_stay_text(open_page: Callable[..., Any]) -> None:
    page = open_page()
    assert [section.is_visible() for section in page.locator(".dance").all()] == [True, False]
    assert "spared" not in page.locator(".sk-legend").inner_text()
    page.locator(".tabs a", has_text="spared").click()
    page.wait_for_function("() => location.hash === '#dance-2'")
    assert [section.is_visible() for section in page.locator(".dance").all()] == [False, True]
    assert "spared" in page.locator(".sk-legend").inner_text()
    assert page.locator(".sk-player").count() == 1
    assert HOSTILE in page.locator(".sk-here").inner_text()
    assert HOSTILE in page.locator(".dance:visible").inner_text()
    assert page.locator("img[src=x]").count() == 0
    assert page.title() == "2 dances"
    assert page.locator(".dance:visible .files a").first.get_attribute("href") == "./spared.npz"


def test_an_address_with_a_place_opens_that_dance(open_page: Callable[..., Any]) -> None:
    page = open_page(place="#dance-2-segments")
    assert [section.is_visible() for section in page.locator(".dance").all()] == [False, True]
    assert (
        page.evaluate("() => document.getElementById('dance-2-segments').getBoundingClientRect().top") < 200
    )


def test_a_narrow_window_shows_all_without_scrolling_sideways(open_page: Callable[..., Any]) -> None:
    page = open_page(width=390)
    assert page.evaluate("() => document.documentElement.scrollWidth") == 390
    assert page.evaluate("() => document.querySelector('.sk-canvas').clientWidth") > 300
    keep(page, "dances-narrow")
