from __future__ import annotations

import base64
import json
import re
from collections.abc import Callable
from functools import partial
from html.parser import HTMLParser
from pathlib import Path
from shutil import copytree, rmtree

import pytest

from studykit.analysis import run
from studykit.recording.study_folder import StudyFolder
from studykit.reports import numbers
from studykit.reports.analyse import analyse, enjoyment_of
from studykit.reports.draw import DRAWINGS, Material
from studykit.reports.report import drawn, html, read_trials, report
from studykit.reports.trials import paces


class Page(HTMLParser):
    """The tags of a page, and its text."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.words.append(data)


@pytest.fixture(scope="module")
def folder(_recorded: Path, tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    """Give a study that has been analysed; only to be read."""
    copy = StudyFolder(Path(copytree(_recorded, tmp_path_factory.mktemp("analysed") / "small")))
    analyse(copy)
    return copy


def page_of(folder: StudyFolder, **changes: object) -> str:
    """Give the page, without figures, after something was changed in the table of trials."""
    material = Material(folder=folder, trials=read_trials(folder.derivatives / "trials.csv"))
    for column, value in changes.items():
        material.trials.loc[0, column] = value
    if changes.get("simulated") is False:
        material.trials["simulated"] = False
    results = json.loads((folder.derivatives / "results.json").read_text(encoding="utf-8"))
    results |= run(material.protocol.analysis, material.trials).to_dict()
    return html(material, results, [])


@pytest.fixture
def analysed(folder: StudyFolder) -> Callable[..., str]:
    """Give `page_of` for that study."""
    return partial(page_of, folder)


def test_the_page_needs_nothing_else_and_is_the_same_each_time(recorded_study: Callable[[], Path]) -> None:
    first, second = recorded_study(), recorded_study()
    rmtree(second / "sourcedata" / "simulation")  # what was planted is nothing to read
    text = report(first).read_text(encoding="utf-8")
    report(second)
    files = sorted(path for path in StudyFolder(first).derivatives.rglob("*") if path.is_file())
    for path in files:
        assert path.read_bytes() == (second / path.relative_to(first)).read_bytes(), path.name
    assert "http" not in text
    page = Page(text)
    assert not {"script", "link", "iframe"} & {tag for tag, _ in page.tags}
    references = [a.get("src") or a.get("href") or "" for _, a in page.tags if {"src", "href"} & a.keys()]
    assert all(re.match(r"#|data:image/svg\+xml;base64,", reference) for reference in references)
    targets = {attributes.get("id") for _, attributes in page.tags}
    assert {reference[1:] for reference in references if reference.startswith("#")} <= targets
    pictures = [base64.b64decode(r.split(",")[1]) for r in references if r.startswith("data:")]
    assert len(pictures) == len(DRAWINGS)
    assert len([path for path in files if path.parent.name == "figures"]) == 2 * len(DRAWINGS)
    assert all(b"</svg>" in picture for picture in pictures)
    assert (first / "derivatives" / "studykit" / "figures" / "figure-6.svg").read_bytes() == pictures[0]


def test_what_is_simulated_or_made_up_says_so_at_the_top(analysed: Callable[..., str]) -> None:
    text = analysed()
    assert text.index("SIMULATED DATA") < text.index("<h1>")
    assert text.index("SYNTHETIC MOVEMENT") < text.index("<h1>")
    assert "SIMULATED DATA" not in analysed(simulated=False)


def test_text_from_the_study_is_escaped(analysed: Callable[..., str]) -> None:
    text = analysed(is_valid=False, exclusion_reason="<script>alert(1)</script>")
    assert "Dances for &lt;b&gt;everyone&lt;/b&gt; &amp; all" in text
    assert "<b>everyone" not in text
    assert "<script" not in text
    assert "excluded: &lt;script&gt;alert(1)&lt;/script&gt;" in text


def test_numbers_are_bound_to_the_trials(analysed: Callable[..., str], folder: StudyFolder) -> None:
    table = read_trials(folder.derivatives / "trials.csv")
    first = table.iloc[0]

    def mean_with(value: float) -> str:
        changed = table["heart_rate_mean_bpm"].where(table.index != 0, value)
        return numbers.number(changed[table["condition"] == first["condition"]].mean(), 1)

    was, becomes = mean_with(first["heart_rate_mean_bpm"]), mean_with(299.0)
    assert was != becomes
    assert f"<td>{was}</td>" in analysed()
    assert f"<td>{becomes}</td>" in analysed(heart_rate_mean_bpm=299.0)


def test_percentiles_are_told_only_of_dances_that_aim_at_them(
    analysed: Callable[..., str], folder: StudyFolder, tmp_path: Path
) -> None:
    assert "energies aim at percentiles 25 (light) and 75 (intense)" in analysed()
    copy = StudyFolder(Path(copytree(folder.path, tmp_path / "small")))
    written = {path: path.read_text(encoding="utf-8") for path in copy.dances.glob("*.json")}
    for path, words in written.items():
        path.write_text(words.replace('"studykit"', '"paper"').replace('"percentiles"', '"paper"'))
    text = page_of(copy)
    assert "with the preset paper" in text
    assert "percentiles" not in text
    for path, words in written.items():
        path.write_text(words.replace('"percentiles"', '"raters"'), encoding="utf-8")
    text = page_of(copy)
    assert "aim at what raters of the library called light and intense, easy and hard" in text
    assert "percentiles" not in text


def test_every_declared_test_and_correlation_stands_on_the_page(analysed: Callable[..., str]) -> None:
    words = " ".join(" ".join(Page(analysed()).words).split())
    assert len(re.findall(r"Friedman test \(chi-squared approximation", words)) == 3
    assert words.count("Every trial counts as if it came from a different person") == 2
    assert "exact permutation distribution, ties kept; zeros dropped; two-sided" in words
    assert "correction: Holm" in words


def test_enjoyment_is_that_of_the_answers(analysed: Callable[..., str], folder: StudyFolder) -> None:
    scored = enjoyment_of(paces(folder))
    text = analysed()
    for measure in ("total", "percent_of_maximum", "percent_of_range"):
        assert f"<td>{numbers.number(scored['mean'][measure])}</td>" in text
    assert f"α = {numbers.bounded(scored['cronbach_alpha'])}" in text


def test_an_excluded_trial_is_named_and_its_test_says_what_was_used(analysed: Callable[..., str]) -> None:
    text = analysed(is_valid=False, exclusion_reason="the belt fell off")
    assert "excluded: the belt fell off" in text
    assert "1 not valid (the belt fell off)" in text


def test_a_page_can_be_made_of_one_unfinished_visit(recorded_study: Callable[[], Path]) -> None:
    folder = StudyFolder(recorded_study())
    for subject in folder.path.glob("sub-*"):  # no files that could stand for a journal
        rmtree(subject)
    for path in folder.sessions()[1:]:
        path.unlink()
    (journal,) = folder.sessions()
    lines = journal.read_bytes().splitlines(keepends=True)
    performed = [n for n, line in enumerate(lines) if b'"kind":"step_completed"' in line]
    journal.write_bytes(b"".join(lines[: performed[len(performed) // 3]]))
    analyse(folder)
    material = Material(folder=folder, trials=read_trials(folder.derivatives / "trials.csv"))
    results = json.loads((folder.derivatives / "results.json").read_text(encoding="utf-8"))
    text = html(material, results, [drawn(drawing, material) for drawing in DRAWINGS[1:2]])
    assert "Not computed" in text
    assert "Nobody has answered the enjoyment scale yet" in text
