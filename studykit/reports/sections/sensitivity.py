"""What hangs on choices that could have been made otherwise."""

from __future__ import annotations

from typing import Any

from studykit.reports.document import Block, Paragraph, Section, Table, bold, italic, listed
from studykit.reports.naming import condition, place, titled
from studykit.reports.numbers import bounded, interval, number, p_cell, percent


def sensitivity(results: dict[str, Any]) -> Section:
    """Set the declared tests, and the time at vigorous intensity, beside what other choices give.

    Parameters
    ----------
    results : dict
        The content of `results.json`; older ones may lack all of this.
    """
    tests, times = results.get("sensitivity") or [], results.get("vigorous_times") or []
    blocks: list[Block] = []
    if tests:
        blocks += [
            Paragraph(
                words="Every declared test again, each time with one defensible choice made otherwise; a "
                "verdict that changes hangs on that choice. This concerns the tests only: models, "
                "correlations and curves are made as declared."
            ),
            _tests(tests),
        ]
    if unchanged := results.get("choices_without_effect"):
        blocks.append(
            Paragraph(
                words=f"Tried too, without changing any value of a declared test: {listed(unchanged)}.",
                kind="note",
            )
        )
    if times:
        blocks.append(_times(times))
    return Section(title="Sensitivity", blocks=tuple(blocks))


def _tests(rows: list[dict[str, Any]]) -> Table:
    """Set every declared test with every choice, and in bold the verdicts that change."""
    return Table(
        title="Declared tests with one choice made otherwise.",
        head=(
            "Test, choice",
            (italic("n"),),
            "χ²",
            (italic("p"),),
            (italic("W"),),
            "Interval",
            "Significant pairs",
            "Same verdict",
        ),
        rows=tuple(
            (
                f"{titled(row['name'])}, {row['choice']}",
                str(row["participants"]),
                number(row["chi_squared"]),
                p_cell(row["p"]),
                bounded(row["kendalls_w"]),
                interval(row["kendalls_w_interval"]),
                str(row["significant_pairs"]),
                row["not_computed_because"] or ("yes" if row["same_verdict"] else (bold(_changed(row)),)),
            )
            for row in rows
        ),
        text_columns=frozenset({7}),
        note="Same verdict: whether test and pairs are as significant, and in the same direction, as the "
        "declared ones; if not, which are not.",
    )


def _changed(row: dict[str, Any]) -> str:
    pairs = [" − ".join(map(condition, pair.split(" - "))) for pair in row.get("other_verdicts") or ()]
    return f"no: {listed(pairs)}" if pairs else "no"


def _times(rows: list[dict[str, Any]]) -> Table:
    choices = list(dict.fromkeys(row["choice"] for row in rows))
    conditions = sorted({str(row["condition"]) for row in rows}, key=place)
    found = {(row["choice"], row["condition"]): row for row in rows}
    cells = ((choice, *(found.get((choice, name)) for name in conditions)) for choice in choices)
    return Table(
        title="Mean share of the window at vigorous intensity, with one choice made otherwise.",
        head=("Choice", *map(condition, conditions)),
        rows=tuple(
            (titled(choice), *(percent(None if row is None else row["mean"]) for row in shares))
            for choice, *shares in cells
        ),
        note="Over all valid trials with a heart rate; the window and the threshold that the protocol "
        "declares stand under Methods.",
    )
