"""From settings to dances: the designer's only way to what computes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Protocol, TypeVar

import numpy as np

from studykit.choreography.choreograph import dance as found
from studykit.choreography.dance_library import CHAIN_SEGMENTS, DanceLibrary
from studykit.choreography.goal import ENERGY_HIT
from studykit.choreography.reach import OutOfReachError
from studykit.choreography.request import default_plan, requested
from studykit.choreography.schedule import Schedule, hiit, variety_waves, warm_up
from studykit.core.errors import InputError
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.motion.joint_mask import JointMask
from studykit.motion.segmentation import SEGMENT_S
from studykit.motion.skeleton import JOINT_NAMES
from studykit.widgets.body_map.spared import mask
from studykit.widgets.designer import account
from studykit.widgets.designer.settings import RANGES, SCHEDULES, Settings

if TYPE_CHECKING:
    from studykit.choreography.dance import Dance, DanceMeasures
    from studykit.choreography.goal import Goal

Made = TypeVar("Made")

FIXED: Final = {
    "hiit": {"duration_s": "4 × 32 s", "intensity": "intense, light, ..."},
    "waves": {"duration_s": "4 × 32 s", "variety": "easy, hard, ..."},
    "warm-up": {
        "duration_s": "32 + 64 + 32 s",
        "intensity": "light, intense, light",
        "variety": "easy, hard, easy",
    },
}
"""What the sliders do not set where a dance has a schedule, and what the schedule has in its place."""


class Source(Protocol):
    """Who turns words into goals and goals into dances: studykit's choreography, or one in its place."""

    def requested(self, library: DanceLibrary, **words: Any) -> Goal:
        """Turn words into numbers on a library."""

    def dance(self, goal: Goal, library: DanceLibrary, *, seed: int, is_preview: bool) -> Dance:
        """Find a dance."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Obstacle:
    """Why no dance is as asked, and what could be asked instead.

    Parameters
    ----------
    sentence : str
        What stands in the way, and what to do.
    nearest : Goal or None
        The nearest goal that the library can reach, where one is known.
    """

    sentence: str
    nearest: Goal | None = None


class Workshop:
    """A library, and who makes dances of it.

    Parameters
    ----------
    library : DanceLibrary
        What dances are made of.
    source : Source, optional
        Who makes them; studykit's own choreography if not given.
    """

    def __init__(self, library: DanceLibrary, *, source: Source | None = None) -> None:
        self.library = library
        self._source = source or Choreography()

    def scales(self) -> dict[str, Any]:
        """Give the ends of the sliders, the words at their places, and what each schedule settles itself."""
        plan = default_plan()
        return {
            **{name: list(ends) for name, ends in RANGES.items()},
            "step_s": SEGMENT_S,
            "words": {
                "intensity": [[plan.intensity.light, "light"], [plan.intensity.intense, "intense"]],
                "variety": [[plan.variety.easy, "easy"], [plan.variety.hard, "hard"]],
            },
            "schedules": [[name, words] for name, words in SCHEDULES.items()],
            "fixed": FIXED,
        }

    def usual_speeds(self) -> dict[str, float]:
        """Give how fast each joint turns at most in half of the segments, rad/s."""
        limits = self.library.speed_limits()
        return {
            name: float(limit) for name, limit in zip(JOINT_NAMES, limits, strict=True) if np.isfinite(limit)
        }

    def goal(self, settings: Settings) -> Goal | Obstacle:
        """Turn settings into numbers, or say what the library cannot reach."""
        return _tried(
            lambda: self._source.requested(
                self.library,
                duration_s=settings.duration_s,
                intensity=settings.intensity,
                variety=settings.variety,
                transition="on" if settings.transition else "off",
                spare=_spared(settings),
                schedule=_schedule(settings),
            )
        )

    def dance(self, goal: Goal, seed: int, *, is_preview: bool) -> Dance | Obstacle:
        """Find a dance, or say why none was found."""
        return _tried(lambda: self._source.dance(goal, self.library, seed=seed, is_preview=is_preview))

    def settings_near(self, goal: Goal, settings: Settings) -> Settings:
        """Set the sliders as near to a goal as they come; a schedule keeps its own levels."""
        if settings.schedule != "none":
            return settings
        (block,) = goal.blocks
        chains = self.library.calibration
        in_chains = CHAIN_SEGMENTS / block.segments
        ranks = [
            100.0 * np.mean(known < in_chains * energy)
            for known, energy in (
                (chains.chain_linear_energies, block.linear_energy),
                (chains.chain_rotational_energies, block.rotational_energy),
            )
        ]
        least, most = RANGES["variety"]
        share = min(max(block.variety / chains.median_distance, least), most)
        return replace(
            settings,
            duration_s=block.duration_s,
            intensity=float(round(np.mean(ranks))),
            variety=round(share, 2) if block.variety else settings.variety,
        )

    def save(self, dance: Dance, folder: str | Path) -> str:
        """Write a dance to files, and give the name that they have."""
        from studykit.library.dance_file import write_dances

        name = f"{dance.condition}-seed{dance.seed}"
        write_dances({name: dance}, folder)
        return name

    def targets(self, goal: Goal) -> dict[str, str]:
        """Say what the sliders mean in numbers."""
        linear = sum(block.linear_energy for block in goal.blocks) * DEFAULT_BODY_MASS_KG
        rotational = sum(block.rotational_energy for block in goal.blocks) * DEFAULT_BODY_MASS_KG
        return {
            "intensity": f"{linear:.1f} J linear, {rotational:.1f} J rotational",
            "variety": "at 100 % segments differ like unrelated movements",
        }

    def blocks(self, goal: Goal, dance: Dance) -> list[dict[str, Any]]:
        """Set the targets of each block beside what the dance has there."""
        starts = account.block_starts([block.asked.duration_s for block in dance.blocks])
        return [
            {
                "start_s": start,
                "stop_s": start + block.asked.duration_s,
                "measures": account.measure_rows(
                    block.asked, block.achieved, block.achieved_blended, _tolerances(goal, block.asked)
                ),
            }
            for start, block in zip(starts, dance.blocks, strict=True)
        ]

    def words(self, goal: Goal, dance: Dance, *, is_preview: bool) -> str:
        """Say in a sentence or two what was found."""
        missed = [
            row["name"]
            for block in self.blocks(goal, dance)
            for row in block["measures"]
            if not row["is_hit"]
        ]
        rows = account.joint_rows(dance, goal.mask)
        beyond = [row["joint"].replace("_", " ") for row in rows if not row["is_within"]]
        verdicts = [f"Beyond its limit: {', '.join(beyond)}."] if beyond else []
        if missed:
            verdicts.append(f"Not close enough: {', '.join(dict.fromkeys(missed))}.")
        close = " ".join(verdicts) or "All is close enough."
        if dance.is_interrupted:
            return f"The search was stopped; this is the best dance until then. {close}"
        return f"A quick look. {close}" if is_preview else f"Found. {close}"


def _spared(settings: Settings) -> JointMask | tuple[()]:
    asked = mask(settings.weights, settings.speed_limits_rad_s)
    return asked if asked.spared else ()


def _schedule(settings: Settings) -> Schedule | None:
    """Give the blocks of the dance; what a schedule leaves open comes from the sliders."""
    if settings.schedule == "hiit":
        return hiit(variety=settings.variety)
    if settings.schedule == "waves":
        return variety_waves(intensity=settings.intensity)
    return warm_up() if settings.schedule == "warm-up" else None


def _tried(deed: Callable[[], Made]) -> Made | Obstacle:
    try:
        return deed()
    except OutOfReachError as error:
        return Obstacle(sentence=f"{error.problem}; {error.remedy}.", nearest=error.nearest)
    except InputError as error:
        return Obstacle(sentence=str(error))


def _tolerances(goal: Goal, asked: DanceMeasures) -> dict[str, float]:
    """Give how far each measure may be off, in its own unit; a term of weight 0 is not asked for."""
    allowed = {
        "duration_s": ("duration", 0.0),
        "linear_energy": ("linear", ENERGY_HIT * asked.linear_energy),
        "rotational_energy": ("rotational", ENERGY_HIT * asked.rotational_energy),
        "variety": ("variety", goal.variety_tolerance),
    }
    return {name: off for name, (term, off) in allowed.items() if goal.weights.get(term, 1.0) > 0.0}


class Choreography:
    """studykit's own choreography."""

    def requested(self, library: DanceLibrary, **words: Any) -> Goal:
        """See `studykit.choreography.request.requested`."""
        return requested(library, **words)

    def dance(self, goal: Goal, library: DanceLibrary, *, seed: int, is_preview: bool) -> Dance:
        """See `studykit.choreography.choreograph.dance`."""
        return found(goal, library, seed=seed, is_preview=is_preview)
