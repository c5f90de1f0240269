"""From goals to dances."""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass

from studykit.choreography.dance import (
    Dance,
    DanceBlock,
    DanceMeasures,
    DanceSegment,
    blended_measures,
    measured,
)
from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.goal import CLOSE, ENERGY_HIT, Goal
from studykit.choreography.measures import Measures
from studykit.choreography.reach import require_reachable
from studykit.choreography.rjmcmc.chain import Found, Search
from studykit.choreography.rjmcmc.repertoire import Repertoire, repertoire
from studykit.choreography.targets import goals
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.core.seeding import stream
from studykit.motion import kinematics
from studykit.motion.animation import animate
from studykit.motion.blending import joined
from studykit.motion.motion import Motion
from studykit.protocol.study_protocol import StudyProtocol

PATIENCE = 4
"""How many times the preset's chains are tried while none has hit all goals."""
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
    """
    wanted = goals(protocol, library)
    return {
        condition: dance(goal, library, seed=seed)
        for condition, goal in progress(wanted.items(), label="Choreographing", total=len(wanted))
    }


def dance(
    goal: Goal,
    library: DanceLibrary,
    *,
    seed: int = 0,
    is_preview: bool = False,
    workers: int | None = None,
    stage_m: tuple[float, float] | None = None,
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

    Raises
    ------
    InputError
        If the library is too small, a goal is out of reach (`reach.OutOfReachError`), or no dance as asked
        was found (preset "studykit"; the preset "paper" gives the best it met).
    """
    known = repertoire(library, goal.preset, goal.mask, goal.terms)
    _require_segments(goal, known)
    if goal.preset.is_reached:
        require_reachable(goal, known, seed=seed)
    outcome = _searched(goal, known, seed=seed, is_preview=is_preview, workers=workers)
    best = outcome.ranked(goal)[0]
    missed = goal.misses(best.measures)
    if missed and goal.preset.is_reached and not is_preview and not outcome.is_interrupted:
        off = ", ".join(f"{name} off by {share:.0%}" for name, share in missed.items())
        raise InputError(
            f"{len(library)} segments hold no dance of {goal.duration_s:g} s for {goal.condition} ({off})",
            where=library.name,
            remedy="add takes, or ask for a longer or less extreme dance in [dance]",
        )
    if is_preview:
        motion = joined(_motions(known, best), blend=goal.preset.blend)
        return _dance(goal, known, best, motion, outcome, seed)
    chosen, motion = _shown(goal, known, outcome, stage_m)
    return _dance(goal, known, chosen, motion, outcome, seed)


@dataclass(frozen=True, kw_only=True, slots=True)
class _Outcome:
    """All that the chains found, in their order."""

    found: tuple[Found, ...]
    is_interrupted: bool

    def ranked(self, goal: Goal) -> list[Found]:
        """Put the dances in order: those that miss least first, of these the closest, then the cheapest."""

        def rank(one: Found) -> tuple[int, int, float]:
            missed = goal.misses(one.measures)
            return len(missed), len(goal.misses(one.measures, share=CLOSE)), one.cost

        return sorted(self.found, key=rank)


def _require_segments(goal: Goal, known: Repertoire) -> None:
    """Refuse a library that has fewer segments than a dance without repetition needs."""
    most = max((block.segments for block in goal.blocks if block.novelty is None), default=1)
    if known.size < most:
        spared = f" in which {goal.spared} stay below their limits" if goal.mask else ""
        raise InputError(
            f"the library has {known.size} segments{spared}, a dance that never repeats needs {most}",
            where=known.library.name,
            remedy="add takes, ask for a shorter dance, or for one that is easier to remember",
        )


def _searched(goal: Goal, known: Repertoire, *, seed: int, is_preview: bool, workers: int | None) -> _Outcome:
    """Run chains until one hits all goals; whole batches, so that the number of cores changes nothing."""
    preset = goal.preset
    search = Search.sized(goal, known, preset.preview if is_preview else preset.annealing)
    chains = preset.preview_chains if is_preview else preset.chains
    batches = PATIENCE if preset.is_reached and not is_preview else 1
    found: list[Found] = []
    with ThreadPoolExecutor(workers or os.cpu_count()) as pool:
        for batch in range(batches):
            numbers = range(batch * chains, (batch + 1) * chains)
            futures: list[Future[Found]] = []
            try:
                futures.extend(
                    pool.submit(search.run, stream(seed, "dance", goal.condition, chain)) for chain in numbers
                )
                found += [future.result() for future in futures]
            except KeyboardInterrupt:
                search.stop.set()
                found += _finished(futures)
                if not found:
                    raise
                return _Outcome(found=tuple(found), is_interrupted=True)
            if any(not goal.misses(one.measures) for one in found):
                break
    return _Outcome(found=tuple(found), is_interrupted=False)


def _finished(futures: list[Future[Found]]) -> Iterator[Found]:
    """Call off what has not begun and wait for the rest: chains are short, or told to stop."""
    for future in futures:
        future.cancel()
    for future in futures:
        with suppress(CancelledError):
            yield future.result()


def _motions(known: Repertoire, found: Found) -> list[Motion]:
    return [known.library.motion(row) for block in known.library_rows(found.blocks) for row in block]


def _shown(
    goal: Goal, known: Repertoire, outcome: _Outcome, stage_m: tuple[float, float] | None
) -> tuple[Found, Motion]:
    """Animate dances, the best first, until one is still as asked with its joins.

    Raises
    ------
    InputError
        If spared joints turn faster than allowed in all of them.
    """
    ranked = outcome.ranked(goal)
    fewest = len(goal.misses(ranked[0].measures))
    alike = [one for one in ranked if len(goal.misses(one.measures)) == fewest][:_ANIMATED]
    held = () if goal.mask is None else tuple(known.protected.tolist())
    shown: list[tuple[float, Found, Motion]] = []
    for one in alike:
        motion = animate(
            _motions(known, one),
            blend=goal.preset.blend,
            is_cleaned=goal.preset.is_cleaned,
            stage_m=stage_m,
            held=held,
        )
        if goal.preset.is_reached and not _is_spared(goal, motion):
            continue
        off = _off_when_shown(goal, motion)
        shown.append((off, one, motion))
        if off <= ENERGY_HIT or not goal.preset.is_reached:
            break
    if not shown:
        raise InputError(
            f"{goal.spared} turn faster than allowed in every dance found",
            where=known.library.name,
            remedy="allow a higher speed, or splice still limbs in",
        )
    return min(shown, key=lambda entry: entry[0])[1:]


def _is_spared(goal: Goal, motion: Motion) -> bool:
    if goal.mask is None:
        return True
    peaks = kinematics.angular_speeds(motion.rotations, motion.frame_rate_hz).max(axis=0)
    return bool((peaks <= goal.mask.speed_limits_rad_s).all())


def _off_when_shown(goal: Goal, motion: Motion) -> float:
    """Give by what share an energy of a block is off at most in the movement as shown."""
    counts = tuple(block.segments for block in goal.blocks)
    if sum(counts) * 120 != len(motion):
        return float("inf")
    shown = measured(motion, (0.0,) * len(counts), counts)
    return max(
        max(
            abs(have.linear_energy / block.linear_energy - 1.0),
            abs(have.rotational_energy / block.rotational_energy - 1.0),
        )
        for have, block in zip(shown, goal.blocks, strict=True)
    )


def _dance(
    goal: Goal, known: Repertoire, found: Found, motion: Motion, outcome: _Outcome, seed: int
) -> Dance:
    objective = goal.objective(known.library)
    rows = known.library_rows(found.blocks)
    table = known.library.segments.iloc[[row for block in rows for row in block]]
    counts = tuple(len(block) for block in rows)
    varieties = found.measures.blocks["variety"]
    shown = measured(motion, varieties, counts)
    blocks = tuple(
        DanceBlock(asked=block.measures, achieved=_of_block(found.measures, number), achieved_blended=blended)
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
        achieved=_whole(found.measures),
        achieved_blended=blended_measures(motion, found.measures.variety),
        blocks=blocks,
        mask=goal.mask,
        cost_total=objective.cost(found.measures),
        cost_terms=objective.terms(found.measures),
        weights=objective.weights,
        displacements_m=found.measures.displacements_m,
        variety_error=found.guided_variety - found.measures.variety,
        chain_costs=tuple(one.cost for one in outcome.found),
        trace=found.trace,
        library_sha256=known.library.sha256,
        is_synthetic=bool(table["is_synthetic"].any()),
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
