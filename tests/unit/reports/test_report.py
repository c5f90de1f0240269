"""The report: numbers are bound to the data, text stays text, nothing is fetched, odd studies are told."""

from __future__ import annotations

import base64
import copy
import dataclasses
import io
import json
import re
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path
from shutil import copytree, rmtree
from typing import Any

import numpy as np
import pandas as pd
import pypdf
import pytest

from studykit.analysis import run
from studykit.analysis.consistency import check_results
from studykit.analysis.crossover import order_effects
from studykit.core.errors import InputError
from studykit.recording.study_folder import StudyFolder
from studykit.reports import numbers, typeset
from studykit.reports.analyse import analyse, enjoyment_of
from studykit.reports.document import Document, Figure, Flow, Paragraph, Section, Stage, Table, bold, italic
from studykit.reports.draw import DRAWINGS
from studykit.reports.material import Material
from studykit.reports.naming import titled
from studykit.reports.report import composed, drawn, read_trials, report
from studykit.reports.sections.glance import at_a_glance
from studykit.reports.sections.sensitivity import sensitivity
from studykit.reports.sections.study import study as what_was_done
from studykit.reports.trials import paces

HOSTILE = '<script>alert("1")</script> #panic("no") $x$ \\ _a_ *b* [c] "d"'


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


def words_of(text: str) -> str:
    return " ".join(" ".join(Page(text).words).split())


def words_of_pdf(content: bytes) -> str:
    reader = pypdf.PdfReader(io.BytesIO(content))
    return " ".join(" ".join(page.extract_text() for page in reader.pages).split())


@pytest.fixture(scope="module")
def untouched(folder: StudyFolder) -> tuple[Material, dict[str, Any]]:
    """Give what was found in that study; only to be read."""
    return found(folder)


@pytest.fixture(scope="module")
def folder(_recorded: Path, tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    """Give a study that has been analysed; only to be read."""
    copied = StudyFolder(Path(copytree(_recorded, tmp_path_factory.mktemp("analysed") / "small")))
    analyse(copied)
    return copied


def found(folder: StudyFolder) -> tuple[Material, dict[str, Any]]:
    material = Material(folder=folder, trials=read_trials(folder.derivatives / "trials.csv"))
    return material, json.loads((folder.derivatives / "results.json").read_text(encoding="utf-8"))


def document_of(folder: StudyFolder, **changes: object) -> Document:
    """Give the report, without figures, after something was changed in the table of trials."""
    material, results = found(folder)
    for column, value in changes.items():
        material.trials.loc[0, column] = value
    if changes.get("simulated") is False:
        material.trials["simulated"] = False
    results |= json.loads(json.dumps(run(material.protocol.analysis, material.trials).to_dict()))
    return composed(material, results, [])


def page_of(folder: StudyFolder, **changes: object) -> str:
    return typeset.page(document_of(folder, **changes))


@pytest.fixture
def analysed(folder: StudyFolder) -> Callable[..., str]:
    """Give `page_of` for that study."""
    return partial(page_of, folder)


def test_the_report_needs_nothing_else_and_is_the_same_each_time(
    recorded_study: Callable[[], Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    some = tuple(drawing for drawing in DRAWINGS if drawing.name in ("1", "7", "8"))
    monkeypatch.setattr(import_module("studykit.reports.report"), "DRAWINGS", some)
    first, second = recorded_study(), recorded_study()
    rmtree(second / "sourcedata" / "simulation")  # what was planted is nothing to read
    page, pdf = report(first)
    report(second)
    text = page.read_text(encoding="utf-8")
    files = sorted(path for path in StudyFolder(first).derivatives.rglob("*") if path.is_file())
    assert {page, pdf} < set(files)
    for path in files:
        assert path.read_bytes() == (second / path.relative_to(first)).read_bytes(), path.name
    assert "http" not in text
    found = Page(text)
    assert not {"script", "link", "iframe"} & {tag for tag, _ in found.tags}
    references = [a.get("src") or a.get("href") or "" for _, a in found.tags if {"src", "href"} & a.keys()]
    assert all(re.match(r"#|data:image/svg\+xml;base64,", reference) for reference in references)
    targets = [attributes["id"] for _, attributes in found.tags if "id" in attributes]
    assert len(targets) == len(set(targets))
    assert {reference[1:] for reference in references if reference.startswith("#")} <= set(targets)
    pictures = [base64.b64decode(r.split(",")[1]) for r in references if r.startswith("data:")]
    assert pictures == [
        (path.parent / "figures" / f"figure-{n}.svg").read_bytes() for n in "78" for path in [page]
    ]
    assert "no dance spares a joint" in text


def test_page_and_pdf_say_the_same(folder: StudyFolder) -> None:
    document = document_of(folder)
    page, pdf = words_of(typeset.page(document)), words_of_pdf(typeset.pdf(document))
    for section in document.sections:
        assert section.title in page
        assert section.title in pdf
    cells = [
        "".join(
            piece.text if hasattr(piece, "text") else piece for piece in ([c] if isinstance(c, str) else c)
        )
        for block in document.blocks()
        if isinstance(block, Table)
        for row in block.rows
        for c in row
    ]
    numbers_shown = {cell for cell in cells if re.fullmatch(r"−?[\d.]{4,}", cell)}
    assert len(numbers_shown) > 100
    assert [cell for cell in numbers_shown if cell not in page or cell not in pdf] == []
    assert re.search(r"Table 1\..*Figure 1\.", page)
    assert re.search(r"Table 1\..*Figure 1\.", pdf)


def test_the_pdf_has_no_date_and_a_table_of_contents(folder: StudyFolder) -> None:
    document = document_of(folder)
    content = typeset.pdf(document)
    assert content == typeset.pdf(document)
    reader = pypdf.PdfReader(io.BytesIO(content))
    assert reader.metadata is not None
    assert reader.metadata.title == document.title
    assert reader.metadata.get("/CreationDate") is None
    titles = [str(entry.title) for entry in reader.outline if not isinstance(entry, list)]
    assert [title.split(maxsplit=1)[1] for title in titles] == [one.title for one in document.sections]


def everything_says(words: str) -> Document:
    """Give a document in which every text is the same."""
    svg = b'<svg xmlns="http://www.w3.org/2000/svg" width="9pt" height="9pt"><path d="M0 0h9"/></svg>'
    return Document(
        title=words,
        subtitle=words,
        banners=(words,),
        summary=(Paragraph(words=(words, italic(words), bold(words)), kind="warning"),),
        sections=(
            Section(
                title=words,
                blocks=(
                    Table(title=words, head=(words, words), rows=((words, words),), note=words),
                    Figure(name="a", title=words, caption=words, svg=svg, width_mm=9.0),
                    Figure(name="b", title=words, caption=words, problem=words),
                    Flow(title=words, stages=(Stage(text=words, count=words, lost=(words,)),) * 2),
                ),
            ),
        ),
    ).numbered()


def test_whatever_a_text_says_is_shown_as_text() -> None:
    document = everything_says(HOSTILE)
    page = typeset.page(document)
    assert "<script" not in page
    assert words_of(page).count(HOSTILE) >= 18
    assert words_of_pdf(typeset.pdf(document)).replace(" ", "").count("alert") >= 16


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
    assert "1 not valid: &lt;script&gt;alert(1)&lt;/script&gt;" in text


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
    copied = StudyFolder(Path(copytree(folder.path, tmp_path / "small")))
    written = {path: path.read_text(encoding="utf-8") for path in copied.dances.glob("*.json")}
    for path, words in written.items():
        path.write_text(words.replace('"studykit"', '"paper"').replace('"percentiles"', '"paper"'))
    text = page_of(copied)
    assert "with the preset paper" in text
    assert "percentiles" not in text
    for path, words in written.items():
        path.write_text(words.replace('"percentiles"', '"raters"'), encoding="utf-8")
    text = page_of(copied)
    assert "aim at what raters of the library called light and intense, easy and hard" in text
    assert "percentiles" not in text


def test_every_declared_result_stands_in_the_report(analysed: Callable[..., str]) -> None:
    words = words_of(analysed())
    assert (
        len(re.findall(r"Friedman: χ²\(\d\) = [\d.]+, p [<=] [\d.]+ \(chi-squared approximation\)", words))
        == 3
    )
    assert words.count("Every trial counts as if it came from a different person") == 2
    assert "xact permutation distribution, ties kept; zeros dropped; two-sided" in words
    assert "p corrected: Holm" in words
    # Three people are too few for eight conditions in eight periods.
    assert words.count("Not computed: the participants are too few") >= 3


def test_the_order_is_told_with_who_says_so(folder: StudyFolder) -> None:
    material, results = found(folder)
    rng = np.random.default_rng(4)
    rows = [
        {"participant": str(person), "sequence": person % 2, "period": period, "condition": "ab"[place],
         "previous_condition": "" if period == 1 else "ba"[place], "value": rng.normal() + person}
        for person in range(9) for period, place in ((1, person % 2), (2, 1 - person % 2))
    ]  # fmt: skip
    effects = asdict(order_effects(pd.DataFrame(rows), "value"))
    results["order_effects"] = [{"outcome": "dtw_m", "effects": json.loads(json.dumps(effects))}]
    words = words_of(typeset.page(composed(material, results, [])))
    assert "Period, sequence and carry-over." in words
    assert "sequence, which lies between them, by how much their levels differ" in words
    assert "Means by period, other things equal." in words
    assert "Carry-over cannot be told from the terms before it" in words


def test_the_first_table_names_every_declared_result(untouched: tuple[Material, dict[str, Any]]) -> None:
    _, results = untouched
    (table,) = at_a_glance(results)
    assert isinstance(table, Table)
    first = [str(row[0]) for row in table.rows]
    kinds = ("tests", "correlations", "models", "equivalences", "curves")
    names = [str(one["name"]) for kind in kinds for one in results[kind]]
    assert names
    for name in names:
        assert any(words.startswith(titled(name)) for words in first), name
    sized = copy.deepcopy(results)
    sized["equivalences"] = [
        {
            "name": "alike", "outcome": "heart_rate_mean_bpm", "a": "light-easy-on", "b": "light-easy-off",
            "low": -5.0, "high": 5.0, "not_computed_because": None,
            "found": {"n": 9, "by_t": {"estimate": 0.5, "interval": [-1.0, 2.0], "p": 0.01,
                                       "is_equivalent": True}},
        }
    ]  # fmt: skip
    sized |= {"tests": [], "correlations": [], "models": [], "curves": []}
    (alike,) = at_a_glance(sized)
    assert isinstance(alike, Table)
    assert alike.rows[0][4] == "90 %: [−1.00, 2.00]"


def test_a_model_that_lacks_a_term_is_marked_in_the_first_table(
    untouched: tuple[Material, dict[str, Any]],
) -> None:
    row = {"estimate": 1.5, "standard_error": 0.4, "interval": [0.7, 2.3]}
    term = {"name": "variety", "f": 9.0, "numerator_df": 1, "denominator_df": 12.25, "p": 0.01}
    fit = {
        "terms": [term, term | {"name": "period"}],
        "differences": [row | {"name": "variety: easy - hard"}],
        "participants": 9,
        "notes": ["a term is left out"],
    }
    model = {"name": "pulse", "outcome": "heart_rate_mean_bpm", "factors": ["variety"], "mixed_model": fit}
    _, results = untouched
    (table,) = at_a_glance(results | {"tests": [], "correlations": [], "models": [model], "curves": []})
    assert isinstance(table, Table)
    first = (
        "Pulse: variety *",
        "F(1, 12.2) = 9.00",
        ".010",
        "easy − hard = 1.50 beats/min",
        "[0.70, 2.30]",
        "9",
    )
    assert table.rows[0] == first
    assert "*: to be read with the warning" in str(table.note)


def test_the_plan_is_not_taken_for_what_was_danced(folder: StudyFolder) -> None:
    material, results = found(folder)
    table = material.trials.copy()
    table.loc[table["participant"] == "01", "is_valid"] = False
    section = what_was_done(dataclasses.replace(material, trials=table), results)
    tables = [block for part in section.sections for block in part.blocks if isinstance(block, Table)]
    (danced,) = [one for one in tables if str(one.title).startswith("What was danced")]
    (plan,) = [one for one in tables if "in each period" in str(one.title)]
    assert sum(int(str(cell)) for row in danced.rows for cell in row[1:]) == int(table["is_valid"].sum())
    assert sum(int(str(cell)) for row in plan.rows for cell in row[1:]) == 8 * 3


def test_what_was_tried_without_effect_is_told(untouched: tuple[Material, dict[str, Any]]) -> None:
    _, results = untouched
    changed = copy.deepcopy(results)
    changed["choices_without_effect"] = ["another window"]
    changed["sensitivity"][0] |= {"same_verdict": False, "other_verdicts": ["light-easy-on - light-hard-on"]}
    (table, *_) = [block for block in sensitivity(changed).blocks if isinstance(block, Table)]
    assert table.rows[0][7][0] == bold("no: Light – Easy, on − Light – Hard, on")
    said = [block.words for block in sensitivity(changed).blocks if isinstance(block, Paragraph)]
    assert any("without changing any value of a declared test: another window" in str(one) for one in said)
    assert sensitivity({}).blocks == ()


def test_enjoyment_is_that_of_the_answers(analysed: Callable[..., str], folder: StudyFolder) -> None:
    scored = enjoyment_of(paces(folder))
    text = analysed()
    for measure in ("total", "percent_of_maximum", "percent_of_range"):
        assert f"<td>{numbers.number(scored['mean'][measure])}</td>" in text
    assert f"α = {numbers.bounded(scored['cronbach_alpha'])}" in text


def test_an_excluded_trial_is_named_and_its_test_says_what_was_used(analysed: Callable[..., str]) -> None:
    text = analysed(is_valid=False, exclusion_reason="the belt fell off")
    assert "1 not valid: the belt fell off" in text
    assert "1 not valid (the belt fell off)" in text
    assert "<td>23 of 24</td>" not in text
    assert re.search(r"<strong>23</strong> valid trials", text)


def test_the_paper_stands_beside_and_is_judged(analysed: Callable[..., str]) -> None:
    words = words_of(analysed())
    assert "cannot be true: r = 0.897 gives p = .031 with no number of points" in words
    assert "chi2(3)=30.00, p<.001, W=0.50, n=20" in words


def test_items_that_a_person_must_fill_are_left_open(analysed: Callable[..., str]) -> None:
    words = words_of(analysed())
    (said,) = re.findall(r"protocol and the data answer (\d+); (\d+) are left open", words)
    assert words.count("to be filled by a person") == int(said[1]) > 10
    assert sum(map(int, said)) == 37


def test_what_the_analysis_adds_stands_in_the_report_without_words_of_its_own(folder: StudyFolder) -> None:
    material, results = found(folder)
    results["novelties"] = [
        {"name": "one", "outcome": "dtw_m", "clusters": [{"start_s": 1.5, "stop_s": 2.5, "p": 0.0321}]},
        {"name": "two", "outcome": "dtw_m", "not_computed_because": "nobody danced"},
    ]
    results["warnings"] = [{"kind": "mixed", "where": "sub-01", "words": "followed <another> protocol"}]
    words = words_of(typeset.page(composed(material, results, [])))
    assert "Novelties" in words
    assert "One: distance between dancer and guide (m)" in words
    assert "1.5 2.5 .032" in words
    assert "Not computed: nobody danced." in words
    assert words.count("followed <another> protocol") == 2


TAMPERED: dict[str, Callable[[dict[str, Any]], Any]] = {
    "participants": lambda r: r.update(participants=4),
    "valid_trials": lambda r: r.update(valid_trials=1),
    "friedman.chi_squared": lambda r: r["tests"][0]["friedman"].update(chi_squared=1.0),
    "friedman.p": lambda r: r["tests"][0]["friedman"].update(p=0.5),
    "friedman.kendalls_w": lambda r: r["tests"][0]["friedman"].update(kendalls_w=0.123),
    "friedman.mean_ranks": lambda r: r["tests"][0]["friedman"].update(mean_ranks=[1.0, 2.0, 3.0, 3.5]),
    "friedman.n": lambda r: r["tests"][0]["friedman"].update(n=2),
    "friedman.f_p": lambda r: r["tests"][1]["friedman"].update(f_p=0.9),
    "is_significant": lambda r: r["tests"][0].update(is_significant=not r["tests"][0]["is_significant"]),
    "exclusions.used": lambda r: r["tests"][0]["exclusions"].update(used=1),
    "exclusions.not_valid": lambda r: r["tests"][0]["exclusions"].update(not_valid={"lost": 1}),
    "summaries mean": lambda r: r["tests"][2]["summaries"][0].update(mean=4.1234),
    "median": lambda r: r["tests"][0]["summaries"][1].update(median=100.0),
    "standard_deviation": lambda r: r["tests"][0]["summaries"][1].update(standard_deviation=100.0),
    "w_plus": lambda r: r["tests"][0]["pairs"][0].update(w_plus=2.5),
    "rank_biserial": lambda r: r["tests"][0]["pairs"][0].update(rank_biserial=0.11),
    "pairs p": lambda r: r["tests"][0]["pairs"][0].update(p=0.011),
    "p_corrected": lambda r: r["tests"][0]["pairs"][0].update(p_corrected=0.011),
    "shift": lambda r: r["tests"][0]["pairs"][0]["shift"].update(estimate=12.3),
    "correlation r": lambda r: r["correlations"][0]["pooled"].update(r=0.123),
    "correlation p": lambda r: r["correlations"][0]["repeated_measures"].update(p=0.7),
    "order p": lambda r: r["order_effects"][0].update(
        effects={"period": {"name": "period", "f": 1.0, "numerator_df": 3, "denominator_df": 9.5, "p": 0.7}}
    ),
    "enjoyment": lambda r: r["enjoyment"]["mean"].update(percent_of_maximum=85.0),
}


@pytest.mark.parametrize("number", TAMPERED)
def test_a_number_that_was_changed_keeps_the_report_from_being_made(
    untouched: tuple[Material, dict[str, Any]], number: str
) -> None:
    material, results = untouched
    changed = copy.deepcopy(results)
    TAMPERED[number](changed)
    assert changed != results
    with pytest.raises(InputError) as refused:
        composed(material, changed, [])
    assert re.split(r"[ .]", number)[-1].rstrip("s") in str(refused.value)


def test_all_numbers_of_an_untouched_study_agree(folder: StudyFolder) -> None:
    material, results = found(folder)
    findings = check_results(results, material.trials)
    assert len(findings) > 300
    assert [finding.words for finding in findings if not finding.is_consistent] == []
    assert {"GRIM", "shift", "p against signed ranks", "corrected p"} <= {
        finding.kind for finding in findings
    }


def test_grim_finds_a_mean_that_whole_answers_cannot_have(folder: StudyFolder) -> None:
    material, results = found(folder)
    results["tests"][2]["summaries"][0]["mean"] += 0.1
    kinds = {one.kind for one in check_results(results, material.trials) if not one.is_consistent}
    assert {"GRIM", "mean"} == kinds


def test_a_report_can_be_made_of_one_unfinished_visit(recorded_study: Callable[[], Path]) -> None:
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
    material, results = found(folder)
    seventh = next(drawing for drawing in DRAWINGS if drawing.name == "7")
    document = composed(material, results, [drawn(seventh, material)])
    words = words_of(typeset.page(document))
    assert "Not computed" in words
    assert "Nobody has answered the enjoyment scale yet" in words
    assert "did not finish" in words
    assert "Not computed" in words_of_pdf(typeset.pdf(document))


def emptied(folder: StudyFolder, *columns: str, is_valid: bool = True) -> str:
    material, results = found(folder)
    for column in columns:
        material.trials[column] = float("nan")
    if not is_valid:
        material.trials["is_valid"] = False
        material.trials["exclusion_reason"] = "the camera was off"
    results |= json.loads(json.dumps(run(material.protocol.analysis, material.trials).to_dict()))
    document = composed(material, results, [])
    typeset.pdf(document)
    return words_of(typeset.page(document))


def test_a_study_without_heart_rate_or_skeleton_is_told(folder: StudyFolder) -> None:
    words = emptied(folder, "heart_rate_mean_bpm", "heart_rate_peak_bpm", "vigorous_fraction")
    assert "Not computed: nobody has a value in" in words
    assert "Movement: distance between dancer and guide χ²" in words
    words = emptied(folder, "dtw_m", "dtw_lag_s")
    assert "Movement: distance between dancer and guide not computed" in words


def test_a_study_without_a_valid_trial_is_told(folder: StudyFolder) -> None:
    words = emptied(folder, is_valid=False)
    assert "0 valid trials" in words
    assert "24 not valid: the camera was off" in words
