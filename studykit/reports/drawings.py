"""The figures of the paper that a study's dances show, and those that reviewers ask for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from studykit import figures
from studykit.analysis.tables import TRIALS
from studykit.choreography.dance import Dance
from studykit.core.errors import InputError
from studykit.figures.samples import ORDER
from studykit.figures.time_curves import PeopleCurve
from studykit.reports import simulated_people
from studykit.reports.material import Drawing, Material
from studykit.reports.pipeline import PIPELINE

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


def _free_and_sparing(material: Material) -> PaperFigure:
    sparing, free = _sparing(material)
    if free is None:
        raise InputError(
            f"there is no dance {sparing.condition} without spared joints to compare with",
            where="figure 1",
            remedy="make it with 'studykit choreograph --out FREE' and the same words but --spare, "
            "then add --dances FREE",
        )
    return figures.free_and_sparing(free, sparing)


def _sparing(material: Material) -> tuple[Dance, Dance | None]:
    """Find a dance that spares joints, and the one with the same goal that spares none."""
    sparing = [dance for dance in material.every_dance if dance.mask is not None and dance.mask.spared]
    if not sparing:
        raise InputError(
            "no dance spares a joint",
            where="figures 1 and 9",
            remedy="make one with 'studykit choreograph --library LIBRARY --intensity intense --variety hard "
            "--spare right_elbow --spare right_shoulder --out SPARED', then add --dances SPARED",
        )
    one = sparing[0]
    same = [
        dance for dance in material.every_dance if dance.mask is None and dance.condition == one.condition
    ]
    # Dances of the same library can be compared best.
    same.sort(key=lambda dance: dance.library_sha256 != one.library_sha256)
    return one, same[0] if same else None


def _sparing_profile(material: Material) -> PaperFigure:
    sparing, free = _sparing(material)
    shown = [sparing] if free is None else [free, sparing]
    return figures.energy_profile(
        shown, people=[[simulated_people.heart_rates(dance)] for dance in shown], simulated=True
    )


def _scheduled(material: Material, goal: str) -> Dance:
    """Find the dance of several blocks that are asked to differ in a goal."""
    for dance in material.every_dance:
        asked = [
            getattr(block.asked, goal) / block.asked.duration_s ** (goal != "variety")
            for block in dance.blocks
        ]
        if max(asked) > 1.1 * min(asked):
            return dance
    number, schedule = ("10a", "hiit") if goal == "linear_energy" else ("10b", "waves")
    raise InputError(
        "no dance has blocks that differ so",
        where=f"figure {number}",
        remedy=f"make one with 'studykit choreograph --library LIBRARY --schedule {schedule} --out BLOCKS', "
        "then add --dances BLOCKS",
    )


def _varying_intensity(material: Material) -> PaperFigure:
    dance = _scheduled(material, "linear_energy")
    return _varying(dance, simulated_people.heart_rates(dance), ("linear_energy", "rotational_energy"))


def _varying_variety(material: Material) -> PaperFigure:
    dance = _scheduled(material, "variety")
    return _varying(dance, simulated_people.distances(dance), ("variety",))


def _varying(dance: Dance, curve: PeopleCurve, measures: tuple[figures.Measure, ...]) -> PaperFigure:
    return figures.energy_profile([dance], measures=measures, people=[[curve]], simulated=True)


def _with_and_without(material: Material) -> PaperFigure:
    pairs = [[f"{cell}-{transition}" for transition in ("on", "off")] for cell in ORDER]
    for pair in pairs:
        if all(name in material.dances for name in pair):
            return figures.film_strips([material.dances[name] for name in pair])
    raise InputError(
        "no condition has a dance with and one without transition cost",
        where="figure 3",
        remedy='declare transition = ["on", "off"] in a protocol',
    )


def _meeting(material: Material) -> PaperFigure:
    names = [f"{cell}-{transition}" for transition in ("off", "on") for cell in ORDER]
    shown = [material.dances[name] for name in names if name in material.dances] or list(material.every_dance)
    return figures.meeting_segments(shown[0])


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
        if pair.get("shift") is not None
    ]
    return figures.forest(
        pd.DataFrame(rows), alpha=float(material.results["alpha"]), simulated=material.is_simulated
    )


def _end(interval: Any, place: int) -> float:
    return float("nan") if interval is None else float(interval[place])


def _sensitivity(material: Material) -> PaperFigure:
    import pandas as pd

    rows: list[Mapping[str, Any]] = material.results.get("sensitivity") or []
    return figures.sensitivity(
        pd.DataFrame(rows), alpha=float(material.results["alpha"]), simulated=material.is_simulated
    )


_SIMULATED = "What people show comes from simulated people."
_ESTIMATES = (
    "Squares are estimates with their intervals, filled where p, corrected, is below the level declared."
)

PAPER: tuple[Drawing, ...] = (
    Drawing(
        name="1",
        caption="A dance that spares joints (below) and a free one (above) of the same intensity: poses from "
        "the middle of equal stretches, each half of a bone in the colour of its joint's energy; spared "
        "joints have a rim of their own.",
        of=_free_and_sparing,
    ),
    Drawing(
        name="2",
        caption="The framework, from motion capture to the report.",
        of=lambda _: figures.framework(PIPELINE),
    ),
    Drawing(
        name="3",
        caption="The same goal with and without transition cost: the segments of both dances, those that "
        "come back in a colour, and the poses on both sides of each join with the displacement of the joints "
        "(Eq. 3), before blending.",
        of=_with_and_without,
    ),
    Drawing(
        name="4",
        caption="Two segments meet: the nearest poses on both sides of a join that blending leaves alone, "
        "0.4 s apart, and how far each joint moves between them. Delta in the title is that of the join "
        "itself (Eq. 3), before blending.",
        of=_meeting,
    ),
)
"""The first figures of the paper."""

EXPERIMENTS: tuple[Drawing, ...] = (
    Drawing(
        name="9",
        caption="Energies over time of a dance that spares joints, beside the free one, and heart rate, mean "
        f"with its 95 % interval. {_SIMULATED}",
        of=_sparing_profile,
    ),
    Drawing(
        name="10a",
        caption="A dance of blocks that differ in intensity: what was asked (dashed), what it became, and "
        f"heart rate, mean with its 95 % interval. {_SIMULATED}",
        of=_varying_intensity,
    ),
    Drawing(
        name="10b",
        caption="A dance of blocks that differ in variety: what was asked (dashed), what it became, and the "
        f"distance from the guide, mean with its 95 % interval. {_SIMULATED}",
        of=_varying_variety,
    ),
)
"""Its last figures, which take dances that a study need not have."""

REVIEWED: tuple[Drawing, ...] = (
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
"""Figures that reviewers ask for."""
