"""The browser of a library: what the filters find, what a page holds, what is said of a segment."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.errors import InputError
from studykit.motion.kinematics import joint_positions
from studykit.widgets import library_browser
from studykit.widgets.browser.segment_table import Filters, SegmentTable


@pytest.fixture
def library(made_library: Callable[..., DanceLibrary]) -> DanceLibrary:
    made = made_library(40, seed=3)
    segments = made.segments.assign(
        genre=["waltz", "tango", "salsa", "waltz"] * 10,
        performer=["Ada", "Ben"] * 20,
        data_set=["one"] * 30 + ["two"] * 10,
    )
    return replace(made, segments=segments)


def test_filters_find_what_a_plain_query_finds(library: DanceLibrary) -> None:
    table = SegmentTable(library)
    linear = library.linear_energies.sum(axis=1) * 73.5
    middle = float(np.median(linear))
    wanted = [
        row
        for row, (genre, performer) in enumerate(
            zip(library.segments["genre"], library.segments["performer"], strict=True)
        )
        if genre == "waltz" and performer == "Ada" and linear[row] >= middle
    ]
    found = table.found(Filters(genre="waltz", performer="Ada", least_j=middle), ("take", "ascending"))
    assert sorted(found.tolist()) == wanted
    assert 0 < len(wanted) < 10
    both = [
        len(table.found(Filters(**bound), ("take", "ascending")))
        for bound in ({"least_j": middle}, {"most_j": middle})
    ]
    assert sum(both) == 40


@pytest.mark.parametrize("column", ["linear_j", "start_s", "genre", "performer"])
def test_sorting_orders_and_keeps_equals_in_the_order_of_the_library(
    library: DanceLibrary, column: str
) -> None:
    table = SegmentTable(library)
    values = list(table.columns[column])
    up = table.found(Filters(), (column, "ascending")).tolist()
    down = table.found(Filters(), (column, "descending")).tolist()
    assert up == sorted(range(40), key=lambda row: (values[row], row))
    assert down == sorted(range(40), key=lambda row: values[row], reverse=True)


def test_only_one_page_crosses_to_the_browser(library: DanceLibrary) -> None:
    browser = library_browser(library)
    assert (browser.total, browser.pages, len(browser.rows)) == (40, 4, 10)
    browser.page = 3
    assert len(browser.rows) == 10
    seen = []
    for page in range(4):
        browser.page = page
        seen += [row["id"] for row in browser.rows]
    assert sorted(seen) == list(range(40))
    browser.page = 99
    assert browser.page == 3


def test_a_new_filter_begins_at_the_first_page(library: DanceLibrary) -> None:
    browser = library_browser(library)
    browser.page = 2
    browser.filters = {"genre": "tango"}
    assert (browser.page, browser.total) == (0, 10)
    assert set(browser.found["genre"]) == {"tango"}
    browser.filters = {"genre": "tango", "least_j": 1e9}
    assert (browser.total, browser.pages, browser.rows) == (0, 0, [])
    browser.filters = {}
    assert browser.total == 40


def test_a_chosen_segment_plays_with_its_energies_in_the_paper_s_unit(library: DanceLibrary) -> None:
    browser = library_browser(library)
    browser.selected = 7
    np.testing.assert_allclose(browser.positions, joint_positions(library.motion(7)), atol=1e-6)
    assert browser.is_playing
    facts = dict(browser.facts)
    assert facts["linear energy"] == f"{library.linear_energies[7].sum() * 73.5:.1f} J"
    assert facts["rotational energy"] == f"{library.rotational_energies[7].sum() * 73.5:.1f} J"
    assert "73.5 kg" in facts["unit"]
    assert (facts["licence"], facts["take"], facts["start"]) == ("CC0-1.0", "take-3", "4.0 s")
    per_joint = (library.linear_energies[7] + library.rotational_energies[7]) * 73.5
    np.testing.assert_allclose(browser.joint_values, per_joint)
    browser.selected = -1
    assert len(browser.positions) == 0
    assert not browser.is_playing


def test_mirrored_segments_and_partners_are_told(library: DanceLibrary) -> None:
    segments = library.segments.assign(mirrored=[False, True] * 20, partners=["", "take-9"] * 20)
    browser = library_browser(replace(library, segments=segments))
    assert [row["cells"][0] for row in browser.rows[:2]] == ["take-0", "take-0, mirrored"]
    browser.selected = 0
    assert "danced with" not in dict(browser.facts)
    browser.selected = 1
    assert dict(browser.facts)["danced with"] == "take-9"
    assert browser.title == "take-0, mirrored, from 4.0 s"


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("filters", {"colour": "red"}),
        ("filters", {"genre": 3}),
        ("filters", {"least_j": "many"}),
        ("filters", {"least_j": float("nan")}),
        ("filters", {"most_j": -1.0}),
        ("sort", ["colour", "ascending"]),
        ("sort", ["take", "sideways"]),
        ("sort", ["take"]),
        ("selected", 40),
        ("selected", -2),
    ],
)
def test_what_a_browser_cannot_do_is_refused(library: DanceLibrary, name: str, wrong: object) -> None:
    browser = library_browser(library)
    before = getattr(browser, name)
    with pytest.raises(InputError):
        setattr(browser, name, wrong)
    assert getattr(browser, name) == before
    assert browser.total == 40
