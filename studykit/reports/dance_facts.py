"""What a page says of a dance: what was asked, how close it came, what it is made of, how it was found."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.choreography.goal import ENERGY_HIT
from studykit.figures import film, style
from studykit.figures.body import topmost
from studykit.motion import kinematics, stage
from studykit.reports.numbers import number, percent

if TYPE_CHECKING:
    from studykit.choreography.dance import Animation, Dance, DanceMeasures, DanceSegment
    from studykit.reports.beside_library import BesideLibrary

_AS_ASKED = 5e-4  # is 0.0 % in print
_TERMS = {"linear_energy": "linear", "rotational_energy": "rotational", "variety": "variety"}
_NAMES = {"linear_energy": "linear energy", "rotational_energy": "rotational energy", "variety": "variety"}
_TARGETS_FROM = {
    "percentiles": "percentiles of random dances from the library",
    "raters": "people who rated dances from the library",
    "paper": "the numbers printed in the paper",
}


@dataclass(frozen=True, kw_only=True, slots=True)
class Reading:
    """One measure of a dance beside what was asked; energies in J for a body, variety as it is.

    Parameters
    ----------
    name, unit : str
        For people.
    asked : float or None
        None where nothing was asked.
    achieved, shown : float
        Within the segments; of the movement as shown, joins included.
    """

    name: str
    unit: str
    asked: float | None
    achieved: float
    shown: float

    @property
    def off(self) -> float | None:
        """By how much of the target the movement as shown misses it."""
        return self.shown / self.asked - 1.0 if self.asked else None

    @property
    def is_close(self) -> bool:
        """Whether the movement as shown is within 5 % of the target."""
        return self.off is None or abs(self.off) <= ENERGY_HIT

    @property
    def verdict(self) -> str:
        """Say in words how far it is off."""
        if self.off is None:
            return "not asked for"
        if abs(self.off) < _AS_ASKED:
            return "as asked"
        return f"{percent(abs(self.off))} {'above' if self.off > 0.0 else 'below'}"


def readings(
    dance: Dance, measures: tuple[DanceMeasures, DanceMeasures, DanceMeasures], body_mass_kg: float
) -> list[Reading]:
    """Set energies and variety beside what was asked, in `measures`: asked, achieved, as shown."""
    found = []
    for measure, name in _NAMES.items():
        is_energy = measure != "variety"
        asked, achieved, shown = (
            getattr(each, measure) * (body_mass_kg if is_energy else 1.0) for each in measures
        )
        is_asked = dance.weights.get(_TERMS[measure], 1.0) > 0.0 and asked > 0.0
        found.append(
            Reading(
                name=name, unit="J" if is_energy else "", asked=asked if is_asked else None,
                achieved=achieved, shown=shown,
            )
        )  # fmt: skip
    return found


def facts(dance: Dance, body_mass_kg: float, beside: BesideLibrary | None = None) -> dict[str, Any]:
    """Give all that the page says of one dance, as plain values; some only beside its library."""
    whole = readings(dance, (dance.asked, dance.achieved, dance.achieved_blended), body_mass_kg)
    spared = spared_joints(dance, beside)
    blocks = _blocks(dance, body_mass_kg)
    joins = None if beside is None else beside.joins(dance)
    return {
        "title": style.title(dance),
        "condition": dance.condition,
        "is_synthetic": dance.is_synthetic,
        "is_interrupted": dance.is_interrupted,
        "note": dance.note,
        "asked": _asked(dance, whole, body_mass_kg),
        "came": [_came(whole, blocks), *_joined(dance, joins), *_kept(spared), *_space(dance)],
        "asked_s": dance.asked.duration_s,
        "shown_s": dance.achieved_blended.duration_s,
        "readings": whole,
        "jumps_mm": [1000.0 * jump for jump in dance.displacements_m],
        "is_smooth": _is_smooth(dance),
        "spared": spared,
        "has_library": beside is not None,
        "has_angles": any(joint["angle_limit"] is not None for joint in spared),
        "blocks": blocks,
        "joins": joins,
        "segments": segments(dance),
        "distinct": dance.distinct_segments,
        "search": _search(dance),
        "source": {
            "seed": dance.seed,
            "preset": dance.preset,
            "targets": _TARGETS_FROM[dance.targets_from],
            "joining": _joining(dance.animation),
            "licences": sorted({segment.licence for segment in dance.segments}),
            "library_sha256": dance.library_sha256,
            "sha256": dance.sha256,
            "version": dance.version,
        },
    }


def spared_joints(dance: Dance, beside: BesideLibrary | None = None) -> list[dict[str, Any]]:
    """Tell of each spared joint what it may do and what it does at most in the movement as shown.

    Returns
    -------
    list of dict
        `name`, `weight` (a_j of Eq. 11), `peak` and `limit` (rad/s), `angle` and `angle_limit` (rad, from the
        rest pose), `used` (the larger share of a limit, None where there is none), `energy_share`, `below`
        (share of the library's segments that keep the speed limit, None where one of the two is not there).
    """
    if dance.mask is None:
        return []
    told, masked = dance.joints(), dance.mask.to_dict()
    names = dance.motion.skeleton.joint_names
    angles = kinematics.rest_angles(dance.motion.rotations).max(axis=0)
    whole = sum(float(joint["energy"] or 0.0) for joint in told.values())
    rows = []
    for name, mask in masked.items():
        peak, angle = float(told[name]["peak_rad_s"] or 0.0), float(angles[names.index(name)])
        limit, angle_limit = mask["speed_limits_rad_s"], mask["angle_limits_rad"]
        used = [have / most for have, most in ((peak, limit), (angle, angle_limit)) if most is not None]
        rows.append(
            {
                "name": name.replace("_", " "),
                "weight": mask["weight"],
                "peak": peak,
                "limit": limit,
                "angle": angle,
                "angle_limit": angle_limit,
                "used": max(used, default=None),
                "below": None if beside is None or limit is None else beside.library.share_below(name, limit),
                "energy_share": float(told[name]["energy"] or 0.0) / whole if whole else 0.0,
            }
        )
    return rows


def segments(dance: Dance) -> list[dict[str, Any]]:
    """Tell of each segment its letter and colour, when it is danced and where it comes from."""
    letters = film.letters(dance)
    plain = [letter.rstrip("′") for letter in letters]
    again = [letter for letter in dict.fromkeys(plain) if plain.count(letter) > 1]  # as in the film strip
    tints = {letter: style.TINTS[place % len(style.TINTS)] for place, letter in enumerate(again)}
    length_s = dance.motion.duration_s / len(letters)
    jumps = dict(enumerate(dance.displacements_m, start=1))
    return [
        {
            "letter": letter,
            "colour": tints.get(letter.rstrip("′"), "#ffffff"),
            "start_s": length_s * place,
            "stop_s": length_s * (place + 1),
            "take": segment.take,
            "from_s": segment.start_s,
            "mirrored": segment.mirrored,
            "spliced_from": segment.spliced_from,
            "licence": segment.licence,
            "jump_mm": 1000.0 * jumps[place] if place in jumps else None,
            "words": _origin(segment),
        }
        for place, (letter, segment) in enumerate(zip(letters, dance.segments, strict=True))
    ]


def _origin(segment: DanceSegment) -> str:
    return f"{segment.take}{', mirrored' if segment.mirrored else ''}, from {segment.start_s:.1f} s"


def _joining(animation: Animation) -> str:
    words = "joins smoothed, standing feet held" if animation.is_cleaned else "joins and feet as they come"
    if animation.stage_m is not None:
        words += "; the pelvis keeps within {:g} × {:g} m".format(*animation.stage_m)
    return f"{animation.blend}; {words}"


def _is_smooth(dance: Dance) -> bool:
    return dance.weights.get("transition", 1.0) > 0.0


def _asked(dance: Dance, whole: list[Reading], body_mass_kg: float) -> str:
    wishes = [
        f"{reading.name} {number(reading.asked, 1)}{f' {reading.unit}' if reading.unit else ''}"
        for reading in whole
        if reading.asked is not None
    ]
    length = f"a dance of {dance.asked.duration_s:g} s"
    if len(dance.blocks) > 1:
        length += f" in {len(dance.blocks)} blocks"
    if dance.displacements_m:
        wishes.append("joins as smooth as they come" if _is_smooth(dance) else "joins however they come")
    if dance.mask is not None:
        wishes.append(f"sparing the {' and the '.join(topmost(dance.mask.spared))}, with all beyond")
    return f"{length}: {'; '.join(wishes)}. Energies are for a body of {body_mass_kg:g} kg."


def _came(whole: list[Reading], blocks: list[dict[str, Any]]) -> str:
    """Say how close all of it is: a dance of blocks only where each of them is."""
    aimed = [reading for reading in whole if reading.asked is not None]
    if not aimed:
        return "No energy and no variety was asked for."
    words = f"over the whole dance: {_verdicts(aimed)}" if blocks else _verdicts(aimed)
    off = [
        f"block {place} ({block['start_s']:g}–{block['stop_s']:g} s): {_verdicts(far)}"
        for place, block in enumerate(blocks, start=1)
        if (far := [reading for reading in block["readings"] if not reading.is_close])
    ]
    if off:
        return f"Not every block is within 5 % of what was asked: {'; '.join(off)}; {words}."
    if blocks:
        return f"Every block is within 5 % of what was asked; {words}."
    if all(reading.is_close for reading in aimed):
        return f"All of it is within 5 % of what was asked: {words}."
    return f"Not all of it is within 5 % of what was asked: {words}."


def _verdicts(readings: list[Reading]) -> str:
    return ", ".join(f"{reading.name} {reading.verdict}" for reading in readings)


def _joined(dance: Dance, joins: dict[str, Any] | None) -> list[str]:
    if not dance.displacements_m:
        return []
    mean, most = 1000.0 * np.mean(dance.displacements_m), 1000.0 * max(dance.displacements_m)
    count = len(dance.displacements_m)
    where = "At the one join" if count == 1 else f"At its {count} joins"
    spread = "" if count == 1 else f" on average and {most:.0f} mm at most"
    apart = f"{where}, the poses that meet are {mean:.0f} mm apart{spread}, before they are blended."
    return [apart] if joins is None else [apart, joins["words"]]


def _kept(spared: list[dict[str, Any]]) -> list[str]:
    limited = [joint for joint in spared if joint["used"] is not None]
    if not limited:
        return []
    fullest = max(limited, key=lambda joint: float(joint["used"]))
    broken = [joint["name"] for joint in limited if joint["used"] > 1.0]
    most = f"{percent(fullest['used'], 0)} of its limit"
    if broken:
        return [f"Beyond its limit: {', '.join(broken)}; the {fullest['name']} reaches {most}."]
    return [f"Every spared joint stays below its limit; the {fullest['name']} comes nearest, at {most}."]


def beyond_stage_m(dance: Dance) -> float:
    """Give how far a joint reaches out of the stage at most, which binds the pelvis alone; 0 without one."""
    if dance.animation.stage_m is None:
        return 0.0
    # The stage lies about the place of the pelvis in the first frame.
    places = np.vstack(
        [dance.motion.root_positions[:1], kinematics.joint_positions(dance.motion).reshape(-1, 3)]
    )
    return stage.excess_m(places, dance.animation.stage_m)


def _space(dance: Dance) -> list[str]:
    if dance.animation.stage_m is None:
        return []
    width, depth = dance.animation.stage_m
    beyond = f"hands and feet reach up to {100.0 * beyond_stage_m(dance):.0f} cm beyond"
    return [f"The pelvis keeps within {width:g} × {depth:g} m; {beyond}."]


def _blocks(dance: Dance, body_mass_kg: float) -> list[dict[str, Any]]:
    if len(dance.blocks) < 2:
        return []
    stops = list(accumulate(block.asked.duration_s for block in dance.blocks))
    return [
        {
            "start_s": stop - block.asked.duration_s,
            "stop_s": stop,
            "readings": readings(dance, (block.asked, block.achieved, block.achieved_blended), body_mass_kg),
        }
        for stop, block in zip(stops, dance.blocks, strict=True)
    ]


def _search(dance: Dance) -> dict[str, Any]:
    costs = sorted(dance.chain_costs)
    return {
        "costs": costs,
        "median": median(costs) if costs else None,
        "iterations": dance.trace[-1].iteration if dance.trace else None,
        "total": dance.cost_total,
        "terms": [
            {"name": name, "cost": cost, "weight": dance.weights.get(name)}
            for name, cost in dance.cost_terms.items()
        ],
        "variety_error": dance.variety_error,
    }
