"""What the data are like: what was measured of each trial, what was excluded, and the dances themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from studykit.analysis.tables import TRIALS
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.protocol.condition import ALL_CONDITIONS
from studykit.reports.document import Block, Paragraph, Section, Table
from studykit.reports.naming import condition, sentence
from studykit.reports.numbers import anything, number, percent
from studykit.reports.trials import dances

if TYPE_CHECKING:
    import pandas as pd

    from studykit.reports.material import Material

_GOALS = {
    "linear_energy": "Linear energy (J)",
    "rotational_energy": "Rotational energy (J)",
    "variety": "Variety",
}


def quality(material: Material, results: dict[str, Any]) -> Section:
    """Tell what was measured, what is missing, which trials are not analysed, and what else is wrong.

    Parameters
    ----------
    material : Material
        The study and its trials.
    results : dict
        The content of `results.json`.
    """
    table = material.trials
    excluded = table[~table["is_valid"].astype(bool)]
    blocks: list[Block] = [_coverage(table)]
    if len(excluded):
        blocks.append(_excluded(excluded))
    else:
        blocks.append(Paragraph(words="No recorded trial was excluded."))
    blocks.append(_by_sequence(table))
    if problems := problems_by_words(results):
        blocks.append(_problems(problems))
    return Section(title="Data quality", blocks=tuple(blocks))


def problems_by_words(results: dict[str, Any]) -> dict[str, list[str]]:
    """Give every problem of the study with the places where it occurs."""
    found: dict[str, list[str]] = {}
    for one in results.get("warnings") or ():
        found.setdefault(str(one["words"]), []).append(str(one["where"]))
    return found


def _problems(problems: dict[str, list[str]]) -> Table:
    return Table(
        title="What narrows what the numbers say.",
        head=("What", "Where"),
        rows=tuple((words, ", ".join(where)) for words, where in problems.items()),
        text_columns=frozenset({1}),
    )


def _coverage(table: pd.DataFrame) -> Table:
    valid = table[table["is_valid"].astype(bool)]
    rows = []
    for column in TRIALS.columns:
        if column.kind != "number" or column.name not in table:
            continue
        values = valid[column.name].dropna()
        spread = [values.min(), values.median(), values.max()] if len(values) else [None] * 3
        unit = {"1": "", "bpm": "beats/min"}.get(column.unit, column.unit)
        rows.append(
            (
                sentence(column.description.replace("dtw_m", "the distance from the guide")),
                unit,
                str(len(values)),
                str(len(valid) - len(values)),
                *(anything(None if value is None else float(value)) for value in spread),
            )
        )
    return Table(
        title=f"What was measured in the {len(valid)} valid trials.",
        head=("Measure", "Unit", "Trials", "Missing", "Lowest", "Median", "Highest"),
        rows=tuple(rows),
        text_columns=frozenset({1}),
        note="A missing value is left out of the comparison that needs it, and counted there.",
    )


def _excluded(table: pd.DataFrame) -> Table:
    return Table(
        title="Trials that are not analysed.",
        head=("Participant", "Session", "Period", "Condition", "Reason"),
        rows=tuple(
            (
                str(row["participant"]),
                str(row["session"]),
                str(row["period"]),
                condition(str(row["condition"])),
                str(row["exclusion_reason"]),
            )
            for row in table.to_dict("records")
        ),
        text_columns=frozenset({3, 4}),
    )


def _by_sequence(table: pd.DataFrame) -> Table:
    """Count trials by sequence and period, as CONSORT asks of crossover trials."""
    periods = sorted(table["period"].unique())
    rows = []
    for sequence, own in table.groupby("sequence"):
        cells = [own[own["period"] == period]["is_valid"].astype(bool) for period in periods]
        counts = [f"{int(one.sum())} of {len(one)}" for one in cells]
        rows.append((str(sequence), str(own["participant"].nunique()), *counts))
    return Table(
        title="Valid of recorded trials, by sequence (row of the square) and period.",
        head=("Sequence", "Participants", *(f"Period {period}" for period in periods)),
        rows=tuple(rows),
    )


def shown_dances(material: Material) -> Section:
    """Tell what was asked of each dance and what it came to be."""
    table = dances({name: material.dances[name] for name in ALL_CONDITIONS if name in material.dances})
    rows = [{str(key): value for key, value in row.items()} for row in table.to_dict("records")]
    words = Paragraph(
        words=f"Energies are sums over the poses of a dance for a body of {DEFAULT_BODY_MASS_KG:g} kg; "
        "variety "
        "is the mean feature distance between the segments of a dance. Achieved is measured within segments, "
        "shown on the dance with its joins, as the participants saw it. On and off: with and without "
        "transition cost, which makes the joins smooth."
    )
    joins = _joins(rows)
    return Section(
        title="The dances", blocks=(words, _goals(rows), *([joins] if joins else []), _segments(rows))
    )


def _goals(rows: list[dict[str, Any]]) -> Table:
    head = ["Dance"]
    for name in _GOALS.values():
        head += [f"{name} asked", "achieved", "off by"] + (["shown"] if name != "Variety" else [])
    return Table(
        title="What was asked of each dance and what it has.",
        head=tuple(head),
        rows=tuple((condition(row["condition"]), *_reached(row)) for row in rows),
        note="Off by: how far what was achieved lies from what was asked.",
    )


def _reached(row: dict[str, Any]) -> list[str]:
    cells = []
    for goal in _GOALS:
        factor = 1.0 if goal == "variety" else DEFAULT_BODY_MASS_KG
        asked, achieved, shown = (factor * row[f"{goal}_{kind}"] for kind in ("asked", "achieved", "shown"))
        off = percent(achieved / asked - 1.0) if asked else "–"
        cells += [number(asked, 1), number(achieved, 1), off]
        cells += [number(shown, 1)] if goal != "variety" else []
    return cells


def _joins(rows: list[dict[str, Any]]) -> Table | None:
    """Compare each dance made with transition cost with the one made without."""
    jumps = {row["condition"]: row["join_displacement_m"] for row in rows}
    cells = dict.fromkeys(str(name).rsplit("-", maxsplit=1)[0] for name in jumps)
    pairs = [
        (cell, jumps[f"{cell}-on"], jumps[f"{cell}-off"])
        for cell in cells
        if {f"{cell}-on", f"{cell}-off"} <= jumps.keys()
    ]
    if not pairs:
        return None
    return Table(
        title="How far the joints jump where segments meet, before blending (mean over joints, Eq. 3).",
        head=("Dance", "With transition cost (m)", "Without (m)", "With / without"),
        rows=tuple(
            (condition(cell), number(on, 3), number(off, 3), number(on / off if off else None, 2))
            for cell, on, off in pairs
        ),
    )


def _segments(rows: list[dict[str, Any]]) -> Table:
    return Table(
        title="What the dances are made of: numbers of their segments in the library, in order.",
        head=("Dance", "Length (s)", "Segments", "Distinct", "Which"),
        rows=tuple(
            (
                condition(row["condition"]),
                number(row["duration_s"], 1),
                str(len(str(row["segments"]).split())),
                str(row["distinct_segments"]),
                str(row["segments"]),
            )
            for row in rows
        ),
        text_columns=frozenset({4}),
    )
