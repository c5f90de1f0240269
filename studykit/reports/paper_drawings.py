"""The figures of the paper, drawn from a study and, where it lacks them, from further dances."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from studykit import figures
from studykit.choreography.dance import Dance
from studykit.core.errors import InputError
from studykit.figures.samples import ORDER
from studykit.protocol.analysis_plan import Curve
from studykit.reports import simulated_people
from studykit.reports.curves import curves
from studykit.reports.material import Drawing, Material
from studykit.reports.pipeline import PIPELINE

if TYPE_CHECKING:
    from studykit.figures.canvas import PaperFigure

_SIMULATED: dict[Curve, Callable[[Dance], figures.PeopleCurve]] = {
    "heart_rate": simulated_people.heart_rates,
    "distance": simulated_people.distances,
}


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
    found = [_people(material, dance, "heart_rate") for dance in shown]
    return figures.energy_profile(
        shown, people=[[curve] for curve, _ in found], simulated=any(simulated for _, simulated in found)
    )


def _people(material: Material, dance: Dance, kind: Curve) -> tuple[figures.PeopleCurve, bool]:
    """Give what people showed in a dance, or what simulated ones would, and whether they were simulated."""
    simulated = _SIMULATED[kind]
    if dance not in material.dances.values():
        return simulated(dance), True
    found = curves(material.folder, kind)[dance.condition]
    curve = figures.PeopleCurve(
        label=simulated_people.LABELS[kind], times_s=found.times_s, values=found.values
    )
    return curve, material.is_simulated


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
    return _varying(material, "linear_energy", "heart_rate", ("linear_energy", "rotational_energy"))


def _varying_variety(material: Material) -> PaperFigure:
    return _varying(material, "variety", "distance", ("variety",))


def _varying(
    material: Material, goal: figures.Measure, kind: Curve, measures: tuple[figures.Measure, ...]
) -> PaperFigure:
    dance = _scheduled(material, goal)
    curve, simulated = _people(material, dance, kind)
    return figures.energy_profile([dance], measures=measures, people=[[curve]], simulated=simulated)


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


def _four_dances(material: Material) -> PaperFigure:
    names = [f"{cell}-on" for cell in ORDER if f"{cell}-on" in material.dances]
    shown = [material.dances[name] for name in names]
    return figures.four_dances(
        [_strip(dance, material) for dance in shown],
        simulated=any(record.simulated for record in material.records),
        synthetic=any(dance.is_synthetic for dance in shown),
    )


def _strip(dance: Dance, material: Material) -> figures.DanceStrip:
    """Put the curves of everybody who danced a dance to its end beneath it."""
    hearts, distances = (
        curves(material.folder, kind)[dance.condition] for kind in ("heart_rate", "distance")
    )
    return figures.DanceStrip(
        condition=dance.condition,
        motion=dance.motion,
        times_s=hearts.times_s,
        heart_rate_bpm=hearts.values,
        distance_m=distances.values,
    )


def _smoothness(material: Material) -> PaperFigure:
    asked = material.protocol.questionnaires.smoothness
    return figures.smoothness_by_condition(material.trials, scale=asked.scale, question=asked.text)


_INTERVALS = "Points are participants; black outlines are means with their 95 % interval (Student's t)."
_ELSE_SIMULATED = "Where nobody of the study danced it, people are simulated."

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
    Drawing(
        name="6",
        caption="The dances made with transition cost: poses from the middle of equal stretches of each "
        "dance, each half of a bone in the colour of its joint's energy (linear and rotational) in that "
        "stretch, on one scale for all joints and dances; below, heart rate and distance between dancer and "
        "guide, mean over participants with its 95 % interval.",
        of=_four_dances,
    ),
    Drawing(
        name="7",
        caption=f"Distance between dancer and guide (dynamic time warping), by condition. {_INTERVALS} "
        "Lines join one participant's values.",
        of=lambda material: figures.movement_by_condition(material.trials),
    ),
    Drawing(
        name="8",
        caption=f"Ratings of smoothness with and without transition cost. {_INTERVALS}",
        of=_smoothness,
    ),
    Drawing(
        name="9",
        caption="Energies over time of a dance that spares joints, beside the free one, and heart rate, mean "
        f"with its 95 % interval. {_ELSE_SIMULATED}",
        of=_sparing_profile,
    ),
    Drawing(
        name="10a",
        caption="A dance of blocks that differ in intensity: what was asked (dashed), what it became, and "
        f"heart rate, mean with its 95 % interval. {_ELSE_SIMULATED}",
        of=_varying_intensity,
    ),
    Drawing(
        name="10b",
        caption="A dance of blocks that differ in variety: what was asked (dashed), what it became, and the "
        f"distance from the guide, mean with its 95 % interval. {_ELSE_SIMULATED}",
        of=_varying_variety,
    ),
)
"""The figures of the paper under their numbers; the screens of Figure 5 are not drawn from data."""
