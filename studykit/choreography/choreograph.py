"""From goals to dances."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from threading import Event
from typing import NamedTuple

import numpy as np

from studykit.choreography.dance import (
    Animation,
    Dance,
    DanceBlock,
    DanceMeasures,
    DanceSegment,
    measured,
)
from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.goal import ENERGY_HIT, Goal
from studykit.choreography.measures import Measures
from studykit.choreography.reach import require_reachable
from studykit.choreography.rjmcmc.chain import Found
from studykit.choreography.rjmcmc.repertoire import Repertoire, repertoire
from studykit.choreography.rjmcmc.search import Outcome, search
from studykit.choreography.targets import goals
from studykit.core.errors import InputError
from studykit.core.parallel import one_core, side_by_side
from studykit.core.progress import Progress, silent
from studykit.motion import kinematics
from studykit.motion.animation import animate
from studykit.motion.motion import Motion
from studykit.motion.segmentation import SEGMENT_FRAMES
from studykit.protocol.study_protocol import StudyProtocol

_ANIMATED = 6
"""How many of the dances found are animated, at most, to see what joins do to them."""


def choreograph(
    protocol: StudyProtocol, library: DanceLibrary, *, seed: int = 0, progress: Progress = silent
) -> dict[str, Dance]:
    """Find one dance for each condition of a protocol.

    Parameters
    ----------
    protocol : StudyProtocol
        What the dances shall be like.
    library : DanceLibrary
        What they are made of.
    seed : int
        Other seeds give other dances for the same goals; the same seed gives the same, on any machine's
        number of cores.
    progress : Progress
        Told of each dance.

    Raises
    ------
    InputError
        If the library cannot give a dance that is as asked (preset "studykit").
    KeyboardInterrupt
        If it is interrupted; single dances (`dance`) keep the best so far.
    """
    wanted = goals(protocol, library)
    stop = Event()

    def found(item: tuple[Goal, _Within]) -> Dance:
        return _danced(*item, seed=seed, workers=1, stop=stop)

    with one_core():
        asked = list(wanted.values())
        within = [_reachable(goal, library) for goal in asked[:1]]  # makes what all of them need
        within += side_by_side(partial(_reachable, library=library), asked[1:], stop=stop)
        made = side_by_side(found, zip(asked, within, strict=True), stop=stop)
        return dict(zip(wanted, progress(made, label="Choreographing", total=len(wanted)), strict=True))


def dance(  # noqa: PLR0913
    goal: Goal,
    library: DanceLibrary,
    *,
    seed: int = 0,
    is_preview: bool = False,
    workers: int | None = None,
    stage_m: tuple[float, float] | None = None,
    progress: Progress = silent,
) -> Dance:
    """Find one dance.

    Parameters
    ----------
    goal : Goal
        What it shall be like; see `request.requested` and `targets.goals`.
    library : DanceLibrary
        What it is made of.
    seed : int
        Other seeds give other dances for the same goal.
    is_preview : bool
        A first look in a fraction of the time: fewer chains, joins blended but not cleaned up, and a dance
        that misses its goal is shown nevertheless.
    workers : int or None
        Chains that run side by side; as many as there are cores if not given. The dance does not depend on
        it.
    stage_m : (float, float), m, or None
        Width and depth that the dance shall keep to.
    progress : Progress
        Told of each chain.

    Raises
    ------
    InputError
        If the library is too small, a goal is out of reach (`reach.OutOfReachError`), or no dance as asked
        was found (preset "studykit"; the preset "paper" gives the best it met).
    """
    with one_core():
        return _danced(
            goal,
            _reachable(goal, library, is_probed=not is_preview),
            seed=seed,
            is_preview=is_preview,
            workers=workers,
            stage_m=stage_m,
            progress=progress,
        )


def _danced(  # noqa: PLR0913
    goal: Goal,
    within: _Within,
    *,
    seed: int,
    is_preview: bool = False,
    workers: int | None = None,
    stage_m: tuple[float, float] | None = None,
    stop: Event | None = None,
    progress: Progress = silent,
) -> Dance:
    animation = Animation(
        blend=goal.preset.blend,
        is_cleaned=goal.preset.is_cleaned and not is_preview,
        stage_m=stage_m,
    )
    known = within.known
    outcome = search(
        goal, known, seed=seed, is_preview=is_preview, workers=workers, stop=stop, progress=progress
    )
    best = outcome.ranked(goal)[0]
    missed = goal.misses(best.measures)
    if is_preview and goal.preset.is_reached and (missed or not best.is_allowed):
        # A first look asks what is within reach only where it does not get there itself.
        within = _Within(known, require_reachable(goal, known))
    is_due = goal.preset.is_reached and not outcome.is_interrupted and not is_preview
    if within.witness is not None and ((is_due and missed) or not best.is_allowed):
        # It is known to be as asked, though its joins were left to chance.
        outcome = replace(outcome, found=(*outcome.found, within.witness))
    elif is_due and missed:
        off = ", ".join(f"{name} off by {share:.0%}" for name, share in missed.items())
        spared = f" with {goal.spared} spared" if goal.mask else ""
        raise InputError(
            f"no dance of {goal.duration_s:g} s was found in {known.size} segments{spared} ({off})",
            where=f"{known.library.name}, {goal.condition}",
            remedy="add takes, or ask for a longer or less extreme dance",
        )
    chosen, motion = _shown(goal, known, outcome, animation)
    return _dance(goal, known, chosen, motion, outcome, seed=seed, animation=animation)


class _Within(NamedTuple):
    """What may be danced and, where targets are to be reached, a dance that reaches them."""

    known: Repertoire
    witness: Found | None


def require_dances(wanted: Mapping[str, Goal], library: DanceLibrary) -> None:
    """Refuse goals of which one is out of reach, before the first is searched for.

    Raises
    ------
    InputError
        If the library is too small for one, or cannot reach it (`reach.OutOfReachError`).
    """
    for goal in wanted.values():
        _reachable(goal, library)


def _reachable(goal: Goal, library: DanceLibrary, *, is_probed: bool = True) -> _Within:
    """Refuse what cannot be danced; give the segments that may be, and a dance that is as asked."""
    known = repertoire(library, goal.preset, goal.mask, goal.terms)
    most = max((block.segments for block in goal.blocks if block.novelty is None), default=1)
    if known.movements < most:
        spared = f" in which {goal.spared} stay below their limits" if goal.mask else ""
        raise InputError(
            f"the library has {known.movements} movements{spared}, a dance that never repeats needs {most}",
            where=known.library.name,
            remedy="add takes, allow more, or ask for a dance that is shorter or easier to remember",
        )
    if not goal.preset.is_reached or not is_probed:
        return _Within(known, None)
    witness = require_reachable(goal, known)
    return _Within(known, None if goal.terms else witness)  # what was probed knows no further terms


def _shown(goal: Goal, known: Repertoire, outcome: Outcome, animation: Animation) -> tuple[Found, Motion]:
    """Animate dances, the best first, until one is still as asked with its joins.

    Raises
    ------
    InputError
        If spared joints turn faster or further than allowed in all of them.
    """
    ranked = [one for one in outcome.ranked(goal) if one.is_allowed]
    fewest = min((len(goal.misses(one.measures)) for one in ranked), default=0)
    alike = [one for one in ranked if len(goal.misses(one.measures)) == fewest][:_ANIMATED]
    held = () if goal.mask is None else tuple(np.flatnonzero(goal.mask.is_limited).tolist())
    shown: list[tuple[float, Found, Motion]] = []
    for one in alike:
        rows = [row for block in known.library_rows(one.blocks) for row in block]
        motion = animate(
            [known.library.motion(row) for row in rows],
            blend=animation.blend,
            is_cleaned=animation.is_cleaned,
            stage_m=animation.stage_m,
            held=held,
        )
        if not _is_spared(goal, motion):
            continue
        shown.append((_off_when_shown(goal, motion), one, motion))
        if shown[-1][0] <= ENERGY_HIT or not goal.preset.is_reached:
            break
    if not shown:
        raise InputError(
            f"{goal.spared} turn faster or further than allowed in every dance found",
            where=known.library.name,
            remedy="allow more, or splice calm arms in if it is an arm",
        )
    return min(shown, key=lambda entry: entry[0])[1:]


def _is_spared(goal: Goal, motion: Motion) -> bool:
    """Tell whether all limits are kept in the movement as shown."""
    if goal.mask is None:
        return True
    speeds = kinematics.angular_speeds(motion.rotations, motion.frame_rate_hz).max(axis=0)
    angles = kinematics.rest_angles(motion.rotations).max(axis=0)
    return bool(goal.mask.keeps(speeds, angles).all())


def _off_when_shown(goal: Goal, motion: Motion) -> float:
    """Give by what share an energy of a block is off at most in the movement as shown."""
    counts = tuple(block.segments for block in goal.blocks)
    if sum(counts) * SEGMENT_FRAMES != len(motion):
        return float("inf")
    shown = measured(motion, (0.0,) * len(counts), counts, joint_weights=goal.counted)
    off = [0.0]
    for have, block in zip(shown, goal.blocks, strict=True):
        if goal.weights["linear"] > 0.0:
            off.append(abs(have.linear_energy / block.linear_energy - 1.0))
        if goal.weights["rotational"] > 0.0:
            off.append(abs(have.rotational_energy / block.rotational_energy - 1.0))
    return max(off)


def _dance(  # noqa: PLR0913
    goal: Goal,
    known: Repertoire,
    found: Found,
    motion: Motion,
    outcome: Outcome,
    *,
    seed: int,
    animation: Animation,
) -> Dance:
    objective = goal.objective(known.library)
    measures = known.measures(found.blocks, is_exact=True)
    rows = known.library_rows(found.blocks)
    table = known.library.segments.iloc[[row for block in rows for row in block]]
    counts = tuple(len(block) for block in rows)
    varieties = measures.blocks["variety"]
    shown = measured(motion, varieties, counts, joint_weights=goal.counted)
    blocks = tuple(
        DanceBlock(asked=block.measures, achieved=_of_block(measures, number), achieved_blended=blended)
        for number, (block, blended) in enumerate(zip(goal.blocks, shown, strict=True))
    )
    return Dance(
        condition=goal.condition,
        seed=seed,
        preset=goal.preset.name,
        targets_from=goal.targets_from,
        segments=tuple(
            DanceSegment(
                id=int(row["id"]),
                take=row["take"],
                start_s=row["start_s"],
                mirrored=bool(row["mirrored"]),
                licence=row["licence"],
                spliced_from=row.get("spliced_from", ""),
            )
            for row in table.to_dict("records")
        ),
        motion=motion,
        asked=goal.measures,
        achieved=_whole(measures),
        achieved_blended=measured(motion, (measures.variety,), (sum(counts),), joint_weights=goal.counted)[0],
        blocks=blocks,
        mask=goal.mask,
        cost_total=objective.cost(measures),
        cost_terms=objective.terms(measures),
        weights=objective.weights,
        displacements_m=measures.displacements_m,
        variety_error=found.guided_variety - measures.variety,
        chain_costs=tuple(one.cost for one in outcome.found),
        trace=found.trace,
        library_sha256=known.library.sha256,
        is_synthetic=bool(table["is_synthetic"].any()),
        animation=animation,
        note=goal.note,
        is_interrupted=outcome.is_interrupted,
    )


def _whole(measures: Measures) -> DanceMeasures:
    return DanceMeasures(
        duration_s=measures.duration_s,
        linear_energy=measures.linear_energy,
        rotational_energy=measures.rotational_energy,
        variety=measures.variety,
    )


def _of_block(measures: Measures, number: int) -> DanceMeasures:
    return DanceMeasures(
        duration_s=measures.blocks["duration"][number],
        linear_energy=measures.blocks["linear"][number],
        rotational_energy=measures.blocks["rotational"][number],
        variety=measures.blocks["variety"][number],
    )
