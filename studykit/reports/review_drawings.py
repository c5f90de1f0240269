"""The figures that reviewers ask for beside those of the paper."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from studykit import figures
from studykit.analysis.tables import TRIALS
from studykit.choreography.dance import Dance
from studykit.core.errors import InputError
from studykit.figures.samples import ORDER
from studykit.reports.curves import curves
from studykit.reports.material import Drawing, Material
from studykit.reports.simulated_people import LABELS as CURVE_LABELS
from studykit.reports.trials import dances

if TYPE_CHECKING:
    from studykit.figures.canvas import PaperFigure

_LABELS = {
    "heart_rate_mean_bpm": "Mean heart rate (beats/min)",
    "dtw_m": "Movement (DTW) distance (m)",
    "smoothness_rating": "Rated smoothness",
}


def axis_label(outcome: str) -> str:
    """Say what an outcome is on an axis.

    Examples
    --------
    >>> axis_label("dtw_m"), axis_label("vigorous_fraction")
    ('Movement (DTW) distance (m)', 'Share of time at or above the vigorous threshold')
    """
    if outcome in _LABELS:
        return _LABELS[outcome]
    column = TRIALS.column(outcome)
    words = column.description[0].upper() + column.description[1:]
    return words if column.unit in ("", "1") else f"{words} ({column.unit})"


def _ordered(material: Material) -> list[Dance]:
    names = [f"{cell}-{transition}" for cell in ORDER for transition in ("on", "off")]
    return [material.dances[name] for name in names if name in material.dances]


def _declared(material: Material) -> PaperFigure:
    return figures.declared_outcomes(
        material.trials,
        [
            (test.outcome, axis_label(test.outcome), test.conditions)
            for test in material.protocol.analysis.tests
        ],
    )


def _by_period(material: Material) -> PaperFigure:
    outcomes = dict.fromkeys(test.outcome for test in material.protocol.analysis.tests)
    if not outcomes:
        raise InputError(
            "no test is declared", where="protocol", remedy="declare one under [[analysis.tests]]"
        )
    return figures.outcomes_by_period(material.trials, {name: axis_label(name) for name in outcomes})


def _forest(material: Material) -> PaperFigure:
    import pandas as pd

    rows = [
        {
            "outcome": axis_label(test["outcome"]),
            "a": pair["a"],
            "b": pair["b"],
            "estimate": pair["shift"]["estimate"],
            "low": _end(pair["shift"]["interval"], 0),
            "high": _end(pair["shift"]["interval"], 1),
            "p": pair["p_corrected"],
        }
        for test in material.results["tests"]
        for pair in test["pairs"]
    ]
    if not rows:
        raise InputError(
            "no pair of conditions was compared", where="results.json", remedy="declare pairs in the protocol"
        )
    return figures.forest(
        pd.DataFrame(rows), alpha=float(material.results["alpha"]), simulated=material.is_simulated
    )


def _end(interval: Any, place: int) -> float:
    return float("nan") if interval is None else float(interval[place])


def _courses(material: Material) -> PaperFigure:
    found = [one for one in material.results.get("curves") or () if one["found"] is not None]
    if not found:
        raise InputError(
            "no curves were compared",
            where="results.json",
            remedy="declare [[analysis.curves]] in the protocol",
        )
    courses = []
    for one in found:
        known = curves(material.folder, one["curve"])
        of = {
            name: figures.PeopleCurve(
                label=CURVE_LABELS[one["curve"]], times_s=known[name].times_s, values=known[name].values
            )
            for name in one["conditions"]
        }
        clusters = [(part["start_s"], part["stop_s"], part["p"]) for part in one["found"]["clusters"]]
        courses.append(figures.Course(curves=of, clusters=clusters))
    return figures.compared_courses(
        courses, alpha=float(material.results["alpha"]), simulated=material.is_simulated
    )


def _without_unit(label: str) -> str:
    return label.rpartition(" (")[0] or label


def _sensitivity(material: Material) -> PaperFigure:
    import pandas as pd

    rows = [
        {
            "outcome": f"{_without_unit(axis_label(row['outcome']))}: Kendall's W",
            "choice": row["choice"],
            "estimate": row["kendalls_w"],
            "low": _end(row["kendalls_w_interval"], 0),
            "high": _end(row["kendalls_w_interval"], 1),
            "p": row["p"],
        }
        for row in material.results.get("sensitivity") or ()
        if row["kendalls_w"] is not None
    ]
    if not rows:
        raise InputError(
            "no test was made again with another choice",
            where="results.json",
            remedy="run 'studykit analyse'",
        )
    return figures.sensitivity(
        pd.DataFrame(rows), alpha=float(material.results["alpha"]), simulated=material.is_simulated
    )


_INTERVALS = "Points are participants; black outlines are means with their 95 % interval (Student's t)."
_ESTIMATES = (
    "Squares are estimates with their intervals, filled where p, corrected, is below the declared level."
)

REVIEWED: tuple[Drawing, ...] = (
    Drawing(
        name="heart-rate-by-condition",
        caption=f"Mean heart rate while performing, by condition. {_INTERVALS} "
        "Lines join one participant's values.",
        of=lambda material: figures.heart_rate_by_condition(material.trials),
    ),
    Drawing(
        name="heart-rate-against-energy",
        caption=f"Mean heart rate against the energy of the dance. {_INTERVALS} Lines have the slope common "
        "to all participants; conditions with nearly the same energy are moved apart.",
        of=lambda material: figures.heart_rate_against_energy(material.trials),
    ),
    Drawing(
        name="movement-against-variety",
        caption=f"Distance between dancer and guide against the variety of the dance. {_INTERVALS} Lines "
        "have the slope common to all participants; conditions with nearly the same variety are moved apart.",
        of=lambda material: figures.movement_against_variety(material.trials),
    ),
    Drawing(
        name="asked-and-achieved",
        caption="What was asked of each dance, what its segments achieve, and what the dance as shown has, "
        "with its joins.",
        of=lambda material: figures.asked_and_achieved(dances(material.dances)),
    ),
    Drawing(
        name="declared-outcomes",
        caption="Every outcome that a test was declared for: points are participants, hollow without "
        "transition cost; outlined, means with their 95 % intervals (Student's t).",
        of=_declared,
    ),
    Drawing(
        name="outcomes-by-period",
        caption="Outcomes in the order in which they were measured. Points are participants; the line joins "
        "the means of the periods, with their 95 % intervals (Student's t).",
        of=_by_period,
    ),
    Drawing(
        name="differences",
        caption=f"Differences of the pairs declared: Hodges-Lehmann shifts, first minus second. {_ESTIMATES}",
        of=_forest,
    ),
    Drawing(
        name="courses",
        caption="The course of what people did over the time of a dance: means with their 95 % intervals; "
        "bars below: stretches in which the conditions differ (cluster-based permutation test, p corrected).",
        of=_courses,
    ),
    Drawing(
        name="sensitivity",
        caption=f"What comes out with other defensible choices. {_ESTIMATES} Dashed: the declared analysis.",
        of=_sensitivity,
    ),
    Drawing(
        name="search",
        caption="The searches for the dances: cost of the moment and best so far; at the right, the best of "
        "each chain and the dance that was taken.",
        of=lambda material: figures.search_traces(_ordered(material)),
    ),
)
"""Figures that reviewers ask for, by name."""
