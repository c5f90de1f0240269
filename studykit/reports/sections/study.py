"""What was done: participants and their flow, the visit, the order of the conditions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.protocol.latin_square import assignment, balance
from studykit.reports.document import Flow, Paragraph, Section, Stage, Table, listed
from studykit.reports.naming import condition
from studykit.reports.numbers import number

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pandas as pd

    from studykit.protocol.study_protocol import StudyProtocol
    from studykit.reports.material import Material

_SEXES = {"F": "female", "M": "male"}


def study(material: Material, results: dict[str, Any]) -> Section:
    """Tell who took part, what a visit was like and how fair the order was.

    Parameters
    ----------
    material : Material
        The study and its trials.
    results : dict
        The content of `results.json`.
    """
    return Section(
        title="What was done",
        sections=(
            Section(
                title="Participants",
                blocks=(flow(material, results), _people(material), _by_sequence(material)),
            ),
            Section(title="A visit", blocks=(_phases(material.protocol),)),
            _order(material.protocol, material.trials),
        ),
    )


def flow(material: Material, results: dict[str, Any]) -> Flow:
    """Follow people and trials from the plan to the analysis, with everything lost on the way."""
    protocol, table = material.protocol, material.trials
    came = {record.participant for record in material.records}
    completed = {record.participant for record in material.records if record.completed}
    planned, conditions = protocol.study.participants, len(protocol.conditions_list())
    each = conditions * protocol.session.perform_repetitions
    valid = table["is_valid"].astype(bool)
    reasons = table.loc[~valid, "exclusion_reason"].fillna("no reason given").value_counts().sort_index()
    danced = len(table[table["participant"].isin(came)])
    unfinished = sorted(came - completed)
    stages = [
        Stage(
            count=str(planned),
            text=f"{_participants(planned)} planned",
            lost=_lost(planned - len(came), "did not come"),
        ),
        Stage(
            count=str(len(came)),
            text=f"{_participants(len(came))} came",
            lost=(f"{len(unfinished)} did not finish: {', '.join(unfinished)}",) if unfinished else (),
        ),
        Stage(
            count=str(len(completed)),
            text=f"{_participants(len(completed))} finished; {len(came) * each} trials were due "
            f"({each} a participant who came)",
            lost=_lost(len(came) * each - danced, "trials were not danced"),
        ),
        Stage(
            count=str(danced),
            text="trials recorded",
            lost=tuple(f"{count} not valid: {reason}" for reason, count in reasons.items()),
        ),
        Stage(count=str(int(valid.sum())), text="valid trials", lost=_unused(results)),
        Stage(count=str(len(results["tests"])), text=f"declared tests, {_compared(results)}"),
    ]
    return Flow(title="Flow of participants and trials, after CONSORT.", stages=tuple(stages))


def _participants(count: int) -> str:
    return "participant" if count == 1 else "participants"


def _lost(count: int, words: str) -> tuple[str, ...]:
    return (f"{count} {words}",) if count > 0 else ()


def _unused(results: dict[str, Any]) -> tuple[str, ...]:
    lost = []
    for test in results["tests"]:
        exclusions = test["exclusions"]
        for person, missing in exclusions["participants_left_out"].items():
            conditions = listed([condition(name) for name in missing])
            lost.append(
                f"{test['name'].replace('_', ' ')}: participant {person} has no value in {conditions}"
            )
    return tuple(lost[:8]) + ((f"and {len(lost) - 8} more, each with its test",) if len(lost) > 8 else ())


def _compared(results: dict[str, Any]) -> str:
    counts = [f"{test['name'].replace('_', ' ')} of {test['participants']}" for test in results["tests"]]
    return f"participants compared: {listed(counts)}" if counts else "none in the protocol"


def _people(material: Material) -> Paragraph:
    told = [answers for record in material.records if (answers := record.answers_to("demographics"))]
    ages = np.array([answers["age"] for answers in told if answers.get("age") is not None], dtype=float)
    sexes = [str(answers["sex"]) for answers in told if answers.get("sex")]
    parts = []
    if len(ages):
        spread = f", standard deviation {number(float(ages.std(ddof=1)), 1)}" if len(ages) > 1 else ""
        parts.append(
            f"mean age {number(float(ages.mean()), 1)} years{spread}, range {ages.min():.0f} to "
            f"{ages.max():.0f}"
        )
    if sexes:
        parts.append(listed([f"{sexes.count(sex)} {_SEXES.get(sex, sex)}" for sex in sorted(set(sexes))]))
    devices = sorted({device for record in material.records for device in record.devices.values()})
    measured = f" Measured with {listed(devices)}." if devices else ""
    if not parts:
        return Paragraph(words=f"Nobody told age or sex.{measured}")
    return Paragraph(words=f"Of those who answered: {'; '.join(parts)}.{measured}")


def _by_sequence(material: Material) -> Table:
    """Tell who danced in which order."""
    told = {record.participant: record.answers_to("demographics") or {} for record in material.records}
    rows = []
    for sequence, own in material.trials.groupby("sequence"):
        people = [told.get(str(person), {}) for person in own["participant"].unique()]
        ages = [float(answers["age"]) for answers in people if answers.get("age") is not None]
        sexes = [str(answers.get("sex") or "") for answers in people]
        resting = own.groupby("participant")["heart_rate_resting_bpm"].first().dropna()
        rows.append(
            (
                str(sequence),
                str(len(people)),
                number(float(np.mean(ages)) if ages else None, 1),
                str(sexes.count("F")),
                str(sexes.count("M")),
                str(len(sexes) - sexes.count("F") - sexes.count("M")),
                number(float(resting.mean()) if len(resting) else None, 1),
            )
        )
    return Table(
        title="Participants by sequence (row of the square), before dancing.",
        head=(
            "Sequence",
            "Participants",
            "Mean age (years)",
            "Female",
            "Male",
            "Other or not told",
            "Mean resting heart rate (beats/min)",
        ),
        rows=tuple(rows),
    )


def _phases(protocol: StudyProtocol) -> Table:
    """List the phases of a visit as they come."""
    session, dance_s, rounds = protocol.session, protocol.dance.duration_s, len(protocol.conditions_list())
    phases = (
        ("calibrate the camera", session.calibrate_s, 1),
        ("sit, for the resting heart rate", session.baseline_s, 1),
        ("get to know the system", session.train_s, 1),
        ("watch the dance", dance_s, rounds * session.watch_repetitions),
        ("perform the dance", dance_s, rounds * session.perform_repetitions),
        ("rate the smoothness", None, rounds),
        ("rest", session.rest_s, rounds),
        ("questions about enjoyment and person", None, 1),
    )
    rows = tuple(
        (name, "as needed" if seconds is None else number(seconds, 0), str(times))
        for name, seconds, times in phases
        if times and seconds != 0.0
    )
    return Table(
        title="The phases of a visit, as they come.", head=("Phase", "Length (s)", "Times"), rows=rows
    )


def _order(protocol: StudyProtocol, table: pd.DataFrame) -> Section:
    found = balance(assignment(protocol))
    names = [condition(name) for name in found.conditions]
    periods = found.position_counts.shape[1]
    positions = Table(
        title="The plan: how many participants are given each condition in each period, first to last.",
        head=("Condition", *(str(period) for period in range(1, periods + 1))),
        rows=tuple(
            (name, *map(str, counts))
            for name, counts in zip(names, found.position_counts.tolist(), strict=True)
        ),
    )
    carried = Table(
        title="The plan: how many participants are given the condition of a column directly after that of a "
        "row.",
        head=("After …", *(condition(name) for name in found.conditions)),
        rows=tuple(
            (name, *("–" if i == j else str(count) for j, count in enumerate(counts)))
            for i, (name, counts) in enumerate(zip(names, found.carry_over_counts.tolist(), strict=True))
        ),
    )
    said = Paragraph(
        words=f"{found.participants} participants dance {len(names)} conditions in orders drawn by lot from "
        "a "
        f"{protocol.order.design.capitalize()} square, in which every condition follows every other one "
        f"equally often; seed {protocol.study.seed}. {_judgement(found)}"
    )
    return Section(
        title="Order and balance",
        blocks=(said, positions, carried, _danced(table, names, range(1, periods + 1))),
    )


def _danced(table: pd.DataFrame, names: Sequence[str], periods: range) -> Table:
    """Count who danced what when, which need not be what was planned; conditions as `names` order them."""
    valid = table[table["is_valid"].astype(bool)]
    counts = valid.groupby([valid["condition"].map(condition), "period"])["participant"].nunique()
    return Table(
        title="What was danced: participants with a valid trial, by condition and period.",
        head=("Condition", *map(str, periods)),
        rows=tuple((name, *(str(counts.get((name, period), 0)) for period in periods)) for name in names),
    )


def _judgement(found: Any) -> str:
    if found.is_balanced:
        return "Everything is balanced."
    others = listed([str(count) for count in found.balanced_participants])
    levels = "is" if found.has_balanced_levels else "is not"
    low, high = found.position_counts.min(), found.position_counts.max()
    after_low, after_high = found.carry_overs.min(), found.carry_overs.max()
    return (
        f"This number of participants cannot be balanced fully ({others} could): a condition stands in a "
        f"period {low} to {high} times and follows another {after_low} to {after_high} times. Each level of "
        f"a factor {levels} equally frequent in every period. Period and carry-over are tested below."
    )
