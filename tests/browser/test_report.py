"""The report, opened from the disk in a real Chromium: it asks nobody for anything and fits its window."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

from studykit.reports import typeset
from studykit.reports.document import Document, Figure, Flow, Paragraph, Section, Stage, Table

pytestmark = pytest.mark.browser
HOSTILE = "</style><script>document.title='broken'</script><img src=https://example.org/x onerror=alert(1)>"


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write a report that has every kind of block, with words that would like to be more."""
    svg = b'<svg xmlns="http://www.w3.org/2000/svg" width="90pt" height="40pt"><path d="M0 0h90"/></svg>'
    wide = Table(title="Wide.", head=tuple(f"column {n}" for n in range(14)), rows=(("x" * 12,) * 14,) * 3)
    flow = Flow(
        title="Flow.", stages=(Stage(text="came", count="3", lost=(HOSTILE,)), Stage(text="left", count="2"))
    )
    figure = Figure(name="a", title="Line", caption=HOSTILE, svg=svg, width_mm=60.0)
    sections = tuple(
        Section(title=f"Part {n}", blocks=(Paragraph(words=HOSTILE, kind="warning"), flow, wide, figure))
        for n in range(12)
    )
    document = Document(
        title="A report", subtitle=HOSTILE, banners=("SIMULATED DATA",), summary=(wide,), sections=sections
    ).numbered()
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(typeset.page(document), encoding="utf-8")
    return path


@pytest.mark.parametrize("width", [1440, 390])
def test_no_request_leaves_the_page_and_nothing_sticks_out(browser: Any, page_file: Path, width: int) -> None:
    asked: list[str] = []
    complaints: list[str] = []
    context = browser.new_context(viewport={"width": width, "height": 900})
    page = context.new_page()
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda said: complaints.append(said.text))
    page.goto(page_file.as_uri())
    page.wait_for_timeout(300)
    assert [url for url in asked if not url.startswith((page_file.as_uri(), "data:"))] == []
    assert complaints == []
    assert page.title() == "A report"
    assert page.evaluate("() => document.documentElement.scrollWidth") == width
    assert page.locator("img").count() == 12
    assert page.evaluate("() => [...document.images].every(image => image.naturalWidth > 0)")
    page.locator(".contents a", has_text="Part 11").click()
    assert page.evaluate("() => document.getElementById('section-12').getBoundingClientRect().top") < 200
    if shots := os.environ.get("SHOTS"):
        page.screenshot(path=str(Path(shots) / f"report-{width}.png"))
    context.close()
