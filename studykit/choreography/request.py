"""One dance, asked for in words: how long, how intense, how varied, sparing what."""

from __future__ import annotations

from collections.abc import Sequence
from typing import get_args

from studykit.choreography.cost.term import CostTerm, SegmentTerm
from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.goal import Goal
from studykit.choreography.preset import PRESETS
from studykit.choreography.schedule import BlockPlan, Schedule
from studykit.choreography.schedule import schedule as ready_made
from studykit.choreography.targets import limited, scheduled, spared_by
from studykit.core.errors import InputError
from studykit.motion.joint_mask import JointMask
from studykit.motion.joint_mask import spare as spared
from studykit.protocol.condition import Intensity, Transition, Variety
from studykit.protocol.study_protocol import DancePlan

DEFAULT_S = 32.0
SPEED_PERCENTILE = 50.0


def requested(  # noqa: PLR0913 - as many words as a wish has
    library: DanceLibrary,
    *,
    duration_s: float = DEFAULT_S,
    intensity: Intensity | float = "light",
    variety: Variety | float = "easy",
    transition: Transition = "on",
    spare: str | Sequence[str] | JointMask = (),
    schedule: str | Schedule | None = None,
    terms: Sequence[SegmentTerm | CostTerm] = (),
    plan: DancePlan | None = None,
) -> Goal:
    """Say what one dance shall be like.

    Parameters
    ----------
    library : DanceLibrary
        What it is made of.
    duration_s : float
        A multiple of 4 s.
    intensity : {"light", "intense"} or float
        A word, or the percentile of the library's random dances that is aimed at, 0 to 100.
    variety : {"easy", "hard"} or float
        A word, or a share of the median distance of unrelated segments.
    transition : {"on", "off"}
        Whether joins shall be smooth.
    spare : str, sequence of str, or JointMask
        Joints that are to be spared, with all beyond them: "right_elbow" means the forearm and the hand. Each
        stays below what it does in the middle segment of the library, unless a mask says otherwise. What
        the plan spares is spared too.
    schedule : str, tuple of BlockPlan, or None
        Blocks that differ, instead of one duration, intensity and variety: "hiit", "waves", "warm-up", or
        your own; see `choreography.schedule`.
    terms : sequence of SegmentTerm or CostTerm
        Further terms of the cost.
    plan : DancePlan or None
        What the words mean and how much each goal counts, from a protocol; without it, see `default_plan`.

    Raises
    ------
    InputError
        If a word, joint, schedule or number is none that is known.

    Examples
    --------
    >>> from studykit import open_library  # doctest: +SKIP
    >>> requested(open_library("libraries/cmu"), intensity="intense", spare="right_elbow")  # doctest: +SKIP
    """
    if transition not in get_args(Transition):
        raise InputError(f'there is no "{transition}"', where="transition", remedy="choose on or off")
    plan = plan or default_plan()
    for where, level in (("intensity", intensity), ("variety", variety)):
        if not isinstance(level, str | int | float):
            raise InputError(f"{level!r} is no level", where=where, remedy="give a word or a number")
    words = [word if isinstance(word, str) else f"{word:g}" for word in (intensity, variety)]
    if schedule is not None:
        words = [schedule if isinstance(schedule, str) else "schedule"]
    if isinstance(schedule, str):
        schedule = ready_made(schedule)
    if schedule is None:
        blocks: Schedule = (BlockPlan(duration_s=duration_s, intensity=intensity, variety=variety),)
    else:
        blocks = tuple(schedule)
    mask = spared_by(plan, library)
    if isinstance(spare, JointMask) or spare:
        named = spare if isinstance(spare, JointMask) else spared(spare)
        named = limited(named, library, SPEED_PERCENTILE)
        mask = named if mask is None else mask.stricter(named)
    return scheduled(
        plan, blocks, library, name="-".join([*words, transition]), mask=mask, terms=tuple(terms)
    )


def default_plan(*, preset: str = "studykit") -> DancePlan:
    """Give what the words mean where no protocol says: as in the study of the paper.

    Raises
    ------
    InputError
        If there is no such preset.
    """
    if preset not in PRESETS:
        raise InputError(
            f'there is no preset "{preset}"', where="preset", remedy=f"choose {' or '.join(PRESETS)}"
        )
    return DancePlan.model_validate(
        {
            "duration_s": DEFAULT_S,
            "preset": preset,
            "intensity": {"light": 25.0, "intense": 75.0, "tolerance": 0.1},
            "variety": {"easy": 0.55, "hard": 0.94, "tolerance": 0.1},
            "weights": dict.fromkeys(("duration", "transition", "variety", "linear", "rotational"), 1.0),
        }
    )
