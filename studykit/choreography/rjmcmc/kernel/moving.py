"""Which changes are tried, with their exact odds."""

from __future__ import annotations

import math
from typing import Any

from studykit.choreography.dance_library import MOVEMENT_S
from studykit.choreography.rjmcmc.join_speed import join_peak
from studykit.choreography.rjmcmc.kernel.arrays import (
    INSERT,
    NEVER,
    REMOVE,
    REPLACE,
)
from studykit.choreography.rjmcmc.kernel.compiling import inlined, inside
from studykit.choreography.rjmcmc.kernel.weighing import at_place, before_place


@inlined
def log_density(tables: Any, targets: Any, chances: Any, now: Any, choice: Any) -> float:
    """Give how much likelier a segment is proposed at a place than the prior has it there, as a logarithm.

    The prior over the segments of a block is the urn of Blackwell and MacQueen (or every segment alike); new
    ones come from its own conditional or, with probability `chances.neighbour`, from the successors of the
    segment before.

    Parameters
    ----------
    choice : tuple of int
        Block, place, the segment in question, and the place that does not count (-1: all count).
    """
    block, place, segment, but = choice
    before = before_place(now, block, place)
    if chances.neighbour <= 0.0 or before < 0:
        return 0.0
    is_near = False
    for rank in range(tables.successors.shape[1]):
        if tables.successors[before, rank] == segment:
            is_near = True
            break
    if not is_near:
        return math.log(1.0 - chances.neighbour)
    size = tables.values.shape[1]
    prior = 1.0 / size
    novelty = targets.novelties[block]
    if 0.0 < novelty < math.inf:
        others, copies = 0, 0
        for other in range(now.counts[block]):
            if other != but:
                others += 1
                copies += now.segments[block, other] == segment
        prior = (novelty / size + copies) / (novelty + others)
    return math.log(1.0 - chances.neighbour + chances.neighbour / (tables.successors.shape[1] * prior))


@inlined
def _drawn(
    tables: Any, targets: Any, chances: Any, now: Any, choice: Any, source: float, which: float
) -> int:
    """Draw a segment for a place: a successor of the one before, a copy of another, or any."""
    block, place, but = choice
    before = before_place(now, block, place)
    if before >= 0:
        if source < chances.neighbour:
            return tables.successors[before, int(which * tables.successors.shape[1])]
        source = (source - chances.neighbour) / (1.0 - chances.neighbour)
    novelty = targets.novelties[block]
    others = now.counts[block] - (1 if but >= 0 else 0)
    if novelty > 0.0 and source * (1.0 + others / novelty) >= 1.0:
        other = int(which * others)
        return now.segments[block, other + 1 if 0 <= but <= other else other]
    return int(which * tables.values.shape[1])


@inlined
def is_same_movement(tables: Any, a: int, b: int) -> bool:
    """Tell whether two segments are the same, mirror images, or overlapping pieces of one take."""
    return tables.takes[a] == tables.takes[b] and abs(tables.starts_s[a] - tables.starts_s[b]) < MOVEMENT_S


@inlined
def is_repetition(tables: Any, now: Any, block: int, segment: int, but: int) -> bool:
    """Tell whether a block already shows the movement of a segment, at another place than one."""
    for place in range(now.counts[block]):
        if place != but and is_same_movement(tables, segment, now.segments[block, place]):
            return True
    return False


@inside
def is_held(tables: Any, before: int, after: int) -> bool:
    """Tell whether protected joints stay below their limits across a join."""
    for joint in range(tables.speed_limits.shape[0]):
        peak = join_peak(tables.tails[before, joint], tables.heads[after, joint])
        if peak > tables.speed_limits[joint]:
            return False
    return True


@inlined
def are_joins_held(tables: Any, now: Any, what: Any) -> bool:
    """Tell whether protected joints stay below their limits across the joins that a change would make."""
    move, block, place, segment = what
    if tables.speed_limits.shape[0] == 0:
        return True
    before = before_place(now, block, place)
    after = at_place(now, block, place if move == INSERT else place + 1)[0]
    if move == REMOVE:
        return before < 0 or after < 0 or is_held(tables, before, after)
    if before >= 0 and not is_held(tables, before, segment):
        return False
    return after < 0 or is_held(tables, segment, after)


@inside
def is_allowed(tables: Any, targets: Any, now: Any) -> bool:
    """Tell whether a whole dance keeps all that must be kept."""
    for block in range(now.counts.shape[0]):
        for place in range(now.counts[block]):
            segment = now.segments[block, place]
            if targets.novelties[block] == NEVER and is_repetition(tables, now, block, segment, place):
                return False
            if tables.speed_limits.shape[0] > 0:
                before = before_place(now, block, place)
                if before >= 0 and not is_held(tables, before, segment):
                    return False
    return True


@inlined
def proposed(
    tables: Any, targets: Any, chances: Any, now: Any, draws: Any, row: int
) -> tuple[int, int, int, int, float]:
    """Draw a change: move (-1 where it is not allowed), block, place, segment, and the log of its odds."""
    block = int(draws[row, 1] * now.counts.shape[0])
    share = draws[row, 1] * now.counts.shape[0] - block
    count = now.counts[block]
    forbidden = (-1, 0, 0, 0, 0.0)
    if draws[row, 0] < chances.insert:
        if count >= targets.highest[block]:
            return forbidden
        place = count if chances.at_end else int(share * (count + 1))
        segment = _drawn(tables, targets, chances, now, (block, place, -1), draws[row, 2], draws[row, 3])
        if targets.novelties[block] == NEVER and is_repetition(tables, now, block, segment, -1):
            return forbidden
        odds = math.log(chances.remove / chances.insert)
        if chances.at_end:
            odds -= math.log(count + 1.0)
        return (
            INSERT,
            block,
            place,
            segment,
            odds - log_density(tables, targets, chances, now, (block, place, segment, -1)),
        )
    place = int(share * count)
    old = now.segments[block, place]
    back = log_density(tables, targets, chances, now, (block, place, old, place))
    if draws[row, 0] < chances.insert + chances.remove:
        # What was not added at the end could not come back: an exact chain removes the last one only.
        is_stuck = chances.at_end and chances.is_exact and place < count - 1
        if count <= targets.lowest[block] or is_stuck:
            return forbidden
        odds = math.log(chances.insert / chances.remove)
        if chances.at_end:
            odds += math.log(float(count))
        return REMOVE, block, place, -1, odds + back
    segment = _drawn(tables, targets, chances, now, (block, place, place), draws[row, 2], draws[row, 3])
    if targets.novelties[block] == NEVER and is_repetition(tables, now, block, segment, place):
        return forbidden
    there = log_density(tables, targets, chances, now, (block, place, segment, place))
    return REPLACE, block, place, segment, back - there
