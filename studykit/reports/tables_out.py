"""Tables as files: LaTeX with booktabs for a paper, CSV for everything else."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable
from pathlib import Path

from studykit.core.errors import InputError
from studykit.reports import dance_tables, people_tables
from studykit.reports.analyse import write
from studykit.reports.material import Material
from studykit.reports.paper_table import Cell, Heading, PaperTable

TABLES: tuple[Callable[[Material], PaperTable], ...] = (
    people_tables.participants,
    dance_tables.parameters,
    dance_tables.energy_targets,
    dance_tables.achieved_targets,
    dance_tables.body_segments,
    people_tables.survey_items,
    people_tables.vigorous_shares,
    people_tables.enjoyment_items,
    people_tables.enjoyment_comparison,
)
"""Every table of a study, in order."""

_ESCAPED = {
    "\\": "\\textbackslash{}", "{": "\\{", "}": "\\}", "&": "\\&", "%": "\\%", "$": "\\$", "#": "\\#",
    "_": "\\_", "~": "\\textasciitilde{}", "^": "\\textasciicircum{}", "−": "$-$", "–": "--", "“": "``",
    "”": "''", "’": "'", "≥": "$\\ge$", "×": "$\\times$",
}  # fmt: skip


def write_tables(material: Material) -> tuple[Path, ...]:
    """Write the tables of a study into its `derivatives/studykit/tables`, each as .tex and as .csv.

    Tables for which nothing was measured yet are left out; the same recordings give the same bytes.

    Parameters
    ----------
    material : Material
        What they are made from.

    Returns
    -------
    tuple of Path
        The files.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    paths: list[Path] = []
    for made in TABLES:
        try:
            table = made(material)
        except InputError:
            continue  # there is nothing to show yet
        stem = material.folder.derivatives / "tables" / table.name
        for ending, content in ((".tex", latex(table)), (".csv", csv_text(table))):
            path = stem.with_suffix(ending)
            write(path, content)
            paths.append(path)
    return tuple(paths)


def latex(table: PaperTable) -> str:
    r"""Write a table for LaTeX; the document needs `\usepackage{booktabs}`.

    Numbers stand at the right with the decimals of their column; a missing one is a dash.
    """
    columns = "".join("l" if heading.decimals is None else "r" for heading in table.headings)
    lines = [
        "\\begin{table}",
        "\\centering",
        f"\\caption{{{escaped(table.caption)}}}",
        f"\\label{{tab:{table.name}}}",
        f"\\begin{{tabular}}{{{columns}}}",
        "\\toprule",
        _line([escaped(heading.words) for heading in table.headings]),
        "\\midrule",
        *(
            _line([escaped(_printed(row[heading.key], heading)) for heading in table.headings])
            for row in table.rows
        ),
        "\\bottomrule",
        "\\end{tabular}",
    ]
    if table.note:
        lines += ["", f"\\smallskip{{\\footnotesize {escaped(table.note)}}}"]
    return "\n".join([*lines, "\\end{table}", ""])


def csv_text(table: PaperTable) -> str:
    """Write a table as CSV, with every digit; a missing value is empty."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([heading.key for heading in table.headings])
    for row in table.rows:
        writer.writerow(
            ["" if _is_missing(row[heading.key]) else row[heading.key] for heading in table.headings]
        )
    return out.getvalue()


def escaped(text: str) -> str:
    r"""Write text so that LaTeX shows it as it is.

    Examples
    --------
    >>> print(escaped("50 % of x_1 & more"))
    50 \% of x\_1 \& more
    """
    return "".join(_ESCAPED.get(character, character) for character in text)


def _line(cells: list[str]) -> str:
    return " & ".join(cells) + r" \\"


def _printed(value: Cell, heading: Heading) -> str:
    if _is_missing(value):
        return "–"
    if heading.decimals is None or isinstance(value, str):
        return str(value)
    return f"{value:.{heading.decimals}f}".replace("-", "−")


def _is_missing(value: Cell) -> bool:
    return value is None or (isinstance(value, float) and math.isnan(value))
