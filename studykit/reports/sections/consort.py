"""What the CONSORT statement for crossover trials asks, and what of it this report answers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from studykit.reports.document import Paragraph, Section, Table, bold
from studykit.reports.numbers import number

if TYPE_CHECKING:
    from studykit.reports.material import Material

_OPEN = "to be filled by a person"


def consort(material: Material, results: dict[str, Any]) -> Section:
    """List the items of the statement with where this report answers them, or that a person must.

    References
    ----------
    Dwan, K., Li, T., Altman, D. G., & Elbourne, D. (2019). CONSORT 2010 statement: extension to randomised
    crossover trials. BMJ, 366, l4378. doi:10.1136/bmj.l4378
    """
    items = _items(material, results)
    is_open = [answer == _OPEN for _, _, answer in items]
    rows = tuple(
        (item, asked, (bold(answer),) if left else answer)
        for (item, asked, answer), left in zip(items, is_open, strict=True)
    )
    return Section(
        title="CONSORT items for crossover trials",
        blocks=(
            Paragraph(
                words=f"Of {len(items)} items of the CONSORT 2010 statement with its extension to randomised "
                "crossover trials (Dwan et al. 2019, BMJ 366:l4378), the protocol and the data answer "
                f"{len(items) - sum(is_open)}; {sum(is_open)} are left open for the authors."
            ),
            Table(
                title="Items of the statement, in our words.",
                head=("Item", "What is asked", "Answer"),
                rows=rows,
                text_columns=frozenset({1, 2}),
            ),
        ),
    )


def _items(material: Material, results: dict[str, Any]) -> list[tuple[str, str, str]]:
    protocol, table = material.protocol, material.trials
    session, periods = protocol.session, len(protocol.conditions_list())
    tests = ", ".join(test["name"].replace("_", " ") for test in results["tests"]) or "none"
    lengths = (
        f"{periods} periods of {number(protocol.dance.duration_s, 0)} s, {number(session.rest_s, 0)} "
        f"s of rest"
    )
    square = f"rows of a {protocol.order.design.capitalize()} square, whole squares first"
    sequences = table["sequence"].nunique()
    return [
        ("1a", "named a randomised crossover trial in the title", _OPEN),
        ("1b", "structured summary that tells the crossover design", _OPEN),
        ("2a", "background and rationale", _OPEN),
        ("2b", "objectives or hypotheses", f"declared tests: {tests}; their reasons are for the authors"),
        ("3a", "rationale for a crossover; periods, washout, carry-over",
         f"{lengths}; carry-over is tested; the rationale is for the authors"),
        ("3b", "changes after the start, with reasons", _changes(material)),
        ("4a", "who could take part", _OPEN),
        ("4b", "where data were collected", _OPEN),
        ("5", "interventions, so that they can be repeated", "The dances; Methods; digests in Provenance"),
        ("6a", "outcomes, defined before the study", "Declared tests; Analysis as declared"),
        ("6b", "changes of outcomes", "the analysis follows the protocol in code/protocol.toml"),
        ("7a", "sample size, by variability within people", _OPEN),
        ("7b", "interim analyses and rules for stopping", _OPEN),
        ("8a", "how the sequence was drawn", f"by lot with seed {protocol.study.seed}; Order and balance"),
        ("8b", "kind of randomisation",
         f"{square}; {sequences} sequences used"),
        ("9", "concealment of the allocation", _OPEN),
        ("10", "who drew, enrolled and assigned", "drawn by the program; who enrolled is for the authors"),
        ("11a", "who was blinded", protocol.study.blinded or _OPEN),
        ("11b", "how alike the interventions looked", _OPEN),
        ("12a", "methods that compare within participants",
         "Analysis as declared: ranks within people, mixed models with a level a participant"),
        ("12b", "further analyses", "Order of the conditions; Sensitivity, where computed"),
        ("13a", "numbers assigned, treated, analysed, by sequence and period",
         "flow of participants; valid of recorded trials by sequence and period"),
        ("13b", "losses and exclusions, with reasons", "flow of participants; Data quality"),
        ("14a", "dates of recruitment", _OPEN),
        ("14b", "why the trial ended", _OPEN),
        ("15", "characteristics of the participants, by sequence",
         "Participants: age, sex and resting heart rate; what else matters is for the authors"),
        ("16", "number analysed in each comparison", "n and exclusions with every test"),
        ("17a", "effects with intervals, from comparisons within people",
         "Declared tests; Correlations; Models"),
        ("17b", "absolute and relative effects of yes-or-no outcomes", "no such outcome is declared"),
        ("18", "results of further analyses", "Models and the sections after it"),
        ("19", "harms", _OPEN),
        ("20", "limits, carry-over included", "carry-over is tested; the discussion is for the authors"),
        ("21", "generalisability", _OPEN),
        ("22", "interpretation", _OPEN),
        ("23", "registration", _OPEN),
        ("24", "where the protocol is", f"code/protocol.toml, SHA-256 {protocol.sha256[:16]}…"),
        ("25", "funding", _OPEN),
    ]  # fmt: skip


def _changes(material: Material) -> str:
    digests = material.trials["protocol_sha256"].nunique()
    return "none: one protocol in every record" if digests == 1 else f"{digests} protocols in the records"
