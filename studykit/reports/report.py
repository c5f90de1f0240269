"""The whole study as one document, as a page and as a PDF: what was done, what came out, and how."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from studykit.analysis.consistency import check_results
from studykit.analysis.tables import TRIALS, check
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.reports import typeset
from studykit.reports.analyse import analyse, write
from studykit.reports.document import Document, Figure, Paragraph, Section, Table
from studykit.reports.draw import DRAWINGS, save
from studykit.reports.material import Drawing, Material
from studykit.reports.page import width_mm
from studykit.reports.place import AnyStudy, folder_of
from studykit.reports.sections.consort import consort
from studykit.reports.sections.glance import at_a_glance
from studykit.reports.sections.methods import methods
from studykit.reports.sections.models import further
from studykit.reports.sections.outcomes import (
    by_condition,
    correlations,
    declared_tests,
    enjoyment,
)
from studykit.reports.sections.published import published
from studykit.reports.sections.quality import problems_by_words, quality, shown_dances
from studykit.reports.sections.sensitivity import sensitivity
from studykit.reports.sections.study import study as what_was_done

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pandas as pd

PAGE, PDF = "report.html", "report.pdf"
_MOST_WARNINGS = 5


def report(study: AnyStudy, *, progress: Progress = silent) -> tuple[Path, Path]:
    """Analyse a study, draw its figures and write everything as one page and one PDF that need nothing else.

    Writes `report.html` and `report.pdf` into the study's `derivatives/studykit`, beside the tables and the
    figures. Every number in them comes from those files, the protocol or the dances, and is checked against
    the others before anything is written; the same recordings give the same bytes.

    Parameters
    ----------
    study : Study, StudyFolder, Path or str
        Where it was recorded.
    progress : Progress
        Told of each visit.

    Returns
    -------
    tuple of Path
        The page and the PDF.

    Raises
    ------
    InputError
        If nothing was recorded, numbers contradict each other, or a file cannot be written.
    """
    folder = folder_of(study)
    analyse(folder, progress=progress)
    material = Material(folder=folder, trials=read_trials(folder.derivatives / "trials.csv"))
    results = json.loads((folder.derivatives / "results.json").read_text(encoding="utf-8"))
    document = composed(material, results, [drawn(drawing, material) for drawing in DRAWINGS])
    paths = (folder.derivatives / PAGE, folder.derivatives / PDF)
    write(paths[0], typeset.page(document))
    write(paths[1], typeset.pdf(document))
    return paths


def read_trials(path: Path) -> pd.DataFrame:
    """Read a table of trials back, and check it against its schema."""
    import pandas as pd

    return check(pd.read_csv(path, dtype=TRIALS.dtypes), TRIALS)


def drawn(drawing: Drawing, material: Material) -> Figure:
    """Draw a figure and save it beside the report; what keeps it from being drawn is told in its place."""
    is_numbered = drawing.name[0].isdigit()
    title = f"Figure {drawing.name} of the paper" if is_numbered else drawing.title
    try:
        figure = drawing.of(material)
    except InputError as error:
        return Figure(name=drawing.stem, title=title, caption=drawing.caption, problem=str(error))
    svg, *_ = save(figure, material.folder.figures / drawing.stem)
    marks = "".join(f"{mark.capitalize()}. " for mark in figure.marks)
    return Figure(
        name=drawing.stem,
        title=title,
        caption=f"{marks}{drawing.caption}",
        svg=svg.read_bytes(),
        width_mm=width_mm(figure),
    )


def composed(material: Material, results: dict[str, Any], figures: Sequence[Figure]) -> Document:
    """Put the sections of a report together, after checking its numbers against each other.

    Parameters
    ----------
    material : Material
        The study and its trials.
    results : dict
        The content of `results.json`.
    figures : sequence of Figure
        In order.

    Raises
    ------
    InputError
        If numbers contradict each other; it names the first.
    """
    agreeing = refuse_contradictions(results, material.trials)
    sections = (
        what_was_done(material, results),
        quality(material, results),
        shown_dances(material),
        by_condition(material),
        declared_tests(results),
        correlations(results),
        *further(results),
        sensitivity(results),
        enjoyment(results),
        _figures(figures),
        published(results),
        methods(material, results, agreeing),
        consort(material, results),
    )
    return Document(
        title=material.protocol.study.title,
        subtitle=f"Report of the study {material.protocol.study.name}. Every number comes from the "
        "recordings, the "
        "protocol or the dances of this study.",
        banners=_banners(material, results),
        summary=(*at_a_glance(results), *_warnings(results)),
        sections=tuple(section for section in sections if section.blocks or section.sections),
    ).numbered()


def refuse_contradictions(results: dict[str, Any], trials: pd.DataFrame) -> int:
    """Count the numbers that were found again, and refuse results of which one contradicts the others.

    Raises
    ------
    InputError
        Naming the first such number.
    """
    findings = check_results(results, trials)
    wrong = [finding for finding in findings if not finding.is_consistent]
    if wrong:
        more = f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else ""
        raise InputError(
            f"{wrong[0].words}{more}",
            where="results.json",
            remedy="analyse the study again before reporting it",
        )
    return len(findings)


def _figures(figures: Sequence[Figure]) -> Section:
    """Give the figures, and in one table those that this study has nothing for."""
    missing = tuple((figure.title, figure.problem) for figure in figures if figure.problem)
    shown = tuple(figure for figure in figures if not figure.problem)
    table = Table(
        title="Figures that could not be drawn.",
        head=("Figure", "Why not"),
        rows=missing,
        text_columns=frozenset({1}),
    )
    return Section(title="Figures", blocks=(*shown, *([table] if missing else [])))


def _banners(material: Material, results: dict[str, Any]) -> tuple[str, ...]:
    banners = []
    if results["is_simulated"]:
        banners.append(
            "SIMULATED DATA: people or devices in this study were simulated. No number below says anything "
            "about "
            "real people."
        )
    if any(dance.is_synthetic for dance in material.dances.values()):
        banners.append("SYNTHETIC MOVEMENT: the dances were made up by a program, not danced by a person.")
    return tuple(banners)


def _warnings(results: dict[str, Any]) -> tuple[Paragraph, ...]:
    """Say first what narrows the results; where that is much, the table of all follows under data quality."""
    said = [
        f"{where[0]}{f' and {len(where) - 1} more' if len(where) > 1 else ''}: {words}"
        for words, where in problems_by_words(results).items()
    ]
    shown, more = said[:_MOST_WARNINGS], len(said) - _MOST_WARNINGS
    if more > 0:
        shown.append(f"And {more} more, under data quality.")
    return tuple(Paragraph(words=words, kind="warning") for words in shown)
