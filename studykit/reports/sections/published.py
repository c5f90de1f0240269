"""The numbers of the paper beside this study's own, each with the verdict of the check."""

from __future__ import annotations

from typing import Any

from studykit.analysis.consistency import check_text
from studykit.analysis.consistency.published import PUBLISHED
from studykit.reports.document import Paragraph, Section, Table
from studykit.reports.naming import sentence
from studykit.reports.numbers import bounded, number, p_value

_PLAIN = frozenset({"p against chi2", "W against chi2", "rank table"})


def published(results: dict[str, Any]) -> Section:
    """Put each printed result of the paper beside the one of this study, and say whether it can be true."""
    findings = check_text("\n".join(f"{one.about}: {one.claim}" for one in PUBLISHED))
    rows = []
    for one in PUBLISHED:
        own = [finding for finding in findings if finding.claim == f"{one.about}: {one.claim}"]
        wrong = [finding.words for finding in own if not finding.is_consistent]
        telling = [finding.words for finding in own if finding.kind not in _PLAIN]
        verdict = "; ".join(wrong or telling)
        rows.append(
            (
                sentence(one.about),
                one.claim if one.is_printed else f"(asked) {one.claim}",
                _ours(results, one.result),
                ("cannot be true" if wrong else "can be true") + (f": {verdict}" if verdict else ""),
            )
        )
    return Section(
        title="The paper’s numbers beside these",
        blocks=(
            Paragraph(
                words="The protocol follows a published study. Its printed numbers are checked against each "
                "other "
                "here, as ‘studykit check --example’ does, and stand beside what this study found; lines "
                "that "
                "begin with (asked) add what the paper does not print but its text implies. Another study, "
                "of "
                "other people, need not agree with it."
            ),
            Table(
                title="Printed results of the paper, this study’s own, and whether the printed ones can be "
                "true.",
                head=("About", "Printed", "This study", "Check"),
                rows=tuple(rows),
                text_columns=frozenset({1, 2, 3}),
            ),
        ),
    )


def _ours(results: dict[str, Any], name: str) -> str:
    for test in results["tests"]:
        if test["name"] == name and test["friedman"]:
            found = test["friedman"]
            return (
                f"χ²({found['degrees_of_freedom']}) = {number(found['chi_squared'])}, p "
                f"{p_value(found['p'])}, "
                f"W = {bounded(found['kendalls_w'])}, n = {found['n']}"
            )
    for one in results["correlations"]:
        if one["name"] == name and one["pooled"]:
            within, pooled = one["repeated_measures"], one["pooled"]
            return (
                f"within people r = {bounded(within['r'])}, p {p_value(within['p'])}; pooled r = "
                f"{bounded(pooled['r'])}, p {p_value(pooled['p'])} ({pooled['n']} trials)"
            )
    if name == "enjoyment" and results["enjoyment"].get("participants"):
        mean = results["enjoyment"]["mean"]
        return (
            f"{number(mean['percent_of_maximum'], 1)} % of the highest total, "
            f"{number(mean['percent_of_range'], 1)} % of the range"
        )
    return "–"
