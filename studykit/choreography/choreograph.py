"""From goals to dances."""

from __future__ import annotations

from dataclasses import replace

from studykit.choreography.dance import Dance, DanceMeasures, DanceSegment, blended_measures
from studykit.choreography.dance_library import DanceLibrary, require_segments
from studykit.choreography.goal import Goal, goals
from studykit.choreography.rjmcmc.descent import reordered
from studykit.choreography.rjmcmc.moves import MoveSet
from studykit.choreography.rjmcmc.run import SearchResult, run
from studykit.choreography.rjmcmc.sequence import Repertoire
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.core.seeding import stream
from studykit.motion.blending import joined
from studykit.protocol.study_protocol import StudyProtocol

PATIENCE = 4
"""How many times the preset's chains are tried while none has hit all goals."""


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
        Other seeds give other dances for the same goals; the same seed gives the same.
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


def dance(goal: Goal, library: DanceLibrary, *, seed: int = 0) -> Dance:
    """Find one dance.

    Raises
    ------
    InputError
        If the library is too small, or no dance as asked was found (preset "studykit"; the preset "paper"
        gives the best it met).
    """
    if goal.novelty is None:
        require_segments(library, goal.segments)
    repertoire = Repertoire(library, goal.preset.variety)
    best, misses = _best_of_chains(goal, repertoire, seed)
    if misses and goal.preset.is_reached:
        off = ", ".join(f"{name} off by {share:.0%}" for name, share in misses.items())
        raise InputError(
            f"{len(library)} segments hold no dance of {goal.duration_s:g} s for {goal.condition} ({off})",
            where=library.name,
            remedy="add takes, or ask for a longer or less extreme dance in [dance]",
        )
    return _dance(goal, library, repertoire, best, seed)


def _best_of_chains(goal: Goal, repertoire: Repertoire, seed: int) -> tuple[SearchResult, dict[str, float]]:
    """Give the dance of lowest cost among those that miss least, and what it misses."""
    found: list[tuple[int, float, int, SearchResult]] = []
    preset = goal.preset
    for chain in range(preset.chains * (PATIENCE if preset.is_reached else 1)):
        result = _search(goal, repertoire, seed=seed, chain=chain)
        found.append((len(goal.misses(result.sequence.measures)), result.cost, chain, result))
        if chain + 1 >= preset.chains and min(found)[0] == 0:
            break
    best = min(found)[-1]
    return best, goal.misses(best.sequence.measures)


def _search(goal: Goal, repertoire: Repertoire, *, seed: int, chain: int) -> SearchResult:
    rng = stream(seed, "dance", goal.condition, chain)
    wanted = goal.segments
    moves = MoveSet(
        repertoire=repertoire,
        bounds=(
            max(1, wanted - 2),
            wanted + 2 if goal.novelty is not None else min(wanted + 2, repertoire.size),
        ),
        novelty=goal.novelty,
        place=goal.preset.moves,
    )
    start = repertoire.sequence(
        tuple(int(s) for s in rng.choice(repertoire.size, size=wanted, replace=goal.novelty is not None))
    )
    objective = goal.objective()
    found = run(start, objective, moves, goal.preset.schedule, rng=rng, rule=goal.preset.acceptance)
    if not goal.preset.reorders:
        return found
    sequence = reordered(found.sequence, objective, repertoire)
    return replace(found, sequence=sequence, cost=objective.cost(sequence.measures))


def _dance(
    goal: Goal, library: DanceLibrary, repertoire: Repertoire, result: SearchResult, seed: int
) -> Dance:
    # Sums that were carried through thousands of changes are taken anew.
    measures = repertoire.sequence(result.sequence.segments).measures
    motion = joined(
        [library.motion(segment) for segment in result.sequence.segments], blend=goal.preset.blend
    )
    objective = goal.objective()
    rows = library.segments.iloc[list(result.sequence.segments)]
    return Dance(
        condition=goal.condition,
        seed=seed,
        preset=goal.preset.name,
        targets_from=goal.targets_from,
        segments=tuple(
            DanceSegment(
                id=row["id"],
                take=row["take"],
                start_s=row["start_s"],
                mirrored=bool(row["mirrored"]),
                licence=row["licence"],
            )
            for row in rows.to_dict("records")
        ),
        motion=motion,
        asked=DanceMeasures(
            duration_s=goal.duration_s,
            linear_energy=goal.linear_energy,
            rotational_energy=goal.rotational_energy,
            variety=goal.variety,
        ),
        achieved=DanceMeasures(
            duration_s=measures.duration_s,
            linear_energy=measures.linear_energy,
            rotational_energy=measures.rotational_energy,
            variety=measures.variety,
        ),
        achieved_blended=blended_measures(motion, measures.variety),
        cost_total=objective.cost(measures),
        cost_terms=objective.terms(measures),
        displacements_m=measures.displacements_m,
        trace=result.trace,
        library_sha256=library.sha256,
        is_synthetic=bool(rows["is_synthetic"].any()),
    )
