"""Costs, and how they change when one segment does."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from studykit.choreography.rjmcmc.kernel.arrays import (
    DURATION,
    INSERT,
    REMOVE,
    SUMS,
    VARIETY,
)
from studykit.choreography.rjmcmc.kernel.compiling import inlined, inside, summing
from studykit.motion.segmentation import SEGMENT_S


@summing
def distance(tables: Any, a: int, b: int) -> float:
    """Give how different two segments are."""
    if a == b:
        return 0.0
    if tables.distances.shape[0] > 0:
        return tables.distances[a, b]
    total = 0.0
    for axis in range(tables.coordinates.shape[1]):
        step = np.float64(tables.coordinates[a, axis]) - np.float64(tables.coordinates[b, axis])
        total += step * step
    return math.sqrt(total + tables.residuals[a] + tables.residuals[b])


@summing
def displacement(tables: Any, before: int, after: int) -> float:
    """Give Eq. 3."""
    total = 0.0
    for joint in range(tables.first_poses.shape[2]):
        x = np.float64(tables.first_poses[after, 0, joint]) - np.float64(tables.last_poses[before, 0, joint])
        y = np.float64(tables.first_poses[after, 1, joint]) - np.float64(tables.last_poses[before, 1, joint])
        z = np.float64(tables.first_poses[after, 2, joint]) - np.float64(tables.last_poses[before, 2, joint])
        total += math.sqrt(x * x + y * y + z * z)
    return total / tables.first_poses.shape[2]


@inlined
def _distance_sum(tables: Any, now: Any, block: int, segment: int, but: int) -> float:
    """Sum the distances of a segment to those of a block, but the one at a place."""
    total = 0.0
    for place in range(now.counts[block]):
        if place != but:
            total += distance(tables, segment, now.segments[block, place])
    return total


@inlined
def _gaussian(square: float) -> float:
    return -math.expm1(-0.5 * square)


@inlined
def _part(targets: Any, term: int, block: int, value: float, width: float) -> float:
    """Give what a block adds to a term: its cost, or its squared deviation where those are pooled."""
    target = targets.blocks[term, block]
    if not targets.is_log[term]:
        off = value - target
    elif value > 0.0:
        off = math.log(value / target)
    else:
        off = math.inf
    square = (off / (targets.tolerances[term, block] * width)) ** 2
    return square if targets.is_pooled else _gaussian(square)


@inlined
def _join_part(targets: Any, jump: float, width: float) -> float:
    square = (jump / (targets.transition_tolerance_m * width)) ** 2
    return square if targets.is_pooled else _gaussian(square)


@inlined
def _total(targets: Any, totals: Any, blocks: int, joins: int) -> float:
    """Give Eq. 1 from the sums of all parts."""
    cost = 0.0
    for term in range(targets.weights.shape[0]):
        if targets.weights[term] > 0.0:
            cost += targets.weights[term] * term_cost(targets, totals[term], blocks)
    if joins > 0 and targets.transition_weight > 0.0:
        cost += targets.transition_weight * transition_cost(targets, totals[-1], joins)
    return cost


@inlined
def term_cost(targets: Any, total: float, blocks: int) -> float:
    """Give one block term from the sum of its parts."""
    return _gaussian(total) if targets.is_pooled else total / blocks


@inlined
def transition_cost(targets: Any, total: float, joins: int) -> float:
    """Give the transition term from the sum of its parts."""
    return _gaussian(total) / joins if targets.is_pooled else total / joins


@inlined
def _variety(pairs_sum: float, count: int) -> float:
    return 2.0 * pairs_sum / (count * (count - 1)) if count > 1 else 0.0


@inside
def measure(tables: Any, now: Any) -> None:
    """Take all sums of a dance anew."""
    now.sums[:] = 0.0
    now.distances[:] = 0.0
    before = -1
    for block in range(now.counts.shape[0]):
        for place in range(now.counts[block]):
            segment = now.segments[block, place]
            for row in range(now.sums.shape[0]):
                now.sums[row, block] += tables.values[row, segment]
            for other in range(place):
                now.distances[block] += distance(tables, segment, now.segments[block, other])
            now.jumps[block, place] = 0.0 if before < 0 else displacement(tables, before, segment)
            before = segment


@inside
def weigh(targets: Any, now: Any, width: float) -> float:
    """Take all parts of the cost anew, at tolerances that are `width` times as wide; give the cost."""
    now.totals[:] = 0.0
    joins = -1
    for block in range(now.counts.shape[0]):
        count = now.counts[block]
        for term in range(targets.weights.shape[0]):
            if term == DURATION:
                value = count * SEGMENT_S
            elif term == VARIETY:
                value = _variety(now.distances[block], count)
            else:
                value = now.sums[term - SUMS, block]
            now.parts[term, block] = _part(targets, term, block, value, width)
            now.totals[term] += now.parts[term, block]
        for place in range(count):
            joins += 1
            now.join_parts[block, place] = (
                0.0 if joins == 0 else _join_part(targets, now.jumps[block, place], width)
            )
            now.totals[-1] += now.join_parts[block, place]
    return _total(targets, now.totals, now.counts.shape[0], joins)


@inlined
def before_place(now: Any, block: int, place: int) -> int:
    """Give the segment before a place, or -1."""
    if place > 0:
        return now.segments[block, place - 1]
    return now.segments[block - 1, now.counts[block - 1] - 1] if block > 0 else -1


@inlined
def at_place(now: Any, block: int, place: int) -> tuple[int, int, int]:
    """Give the segment at a place or, past the end of a block, the first of the next; -1 if none."""
    if place < now.counts[block]:
        return now.segments[block, place], block, place
    if block + 1 < now.counts.shape[0]:
        return now.segments[block + 1, 0], block + 1, 0
    return -1, 0, 0


@inlined
def change(tables: Any, targets: Any, now: Any, what: Any, width: float, ceiling: float, new: Any) -> float:
    """Give the cost of a dance with one change, leaving it as it is.

    Costs are never negative, so what is cheap to know comes first: a change whose first terms cost more than
    `ceiling` is given up (Solonen et al. 2012 call it early rejection).

    Parameters
    ----------
    what : tuple of int
        Move, block, place, segment.
    ceiling : float
        Above it the cost does not matter; infinity is given then.
    new : ndarray
        Filled with what `commit` needs; see `Record`.
    """
    move, block, place, segment = what
    terms = targets.weights.shape[0]
    blocks = now.counts.shape[0]
    old = now.segments[block, place] if move != INSERT else -1
    count = now.counts[block] + (1 if move == INSERT else -1 if move == REMOVE else 0)
    cost = 0.0
    for term in range(terms):
        if term != VARIETY:
            if term == DURATION:
                value = count * SEGMENT_S
            else:
                value = now.sums[term - SUMS, block]
                if move != REMOVE:
                    value += tables.values[term - SUMS, segment]
                if move != INSERT:
                    value -= tables.values[term - SUMS, old]
            cost += _changed_term(targets, now, new, term, block, value, width)
    if cost > ceiling:
        return math.inf
    before = before_place(now, block, place)
    after, after_block, after_place = at_place(now, block, place if move == INSERT else place + 1)
    joins = -1 + count - now.counts[block]
    for number in range(blocks):
        joins += now.counts[number]
    new[1], new[2] = 0.0, 0.0
    if targets.transition_weight > 0.0:
        total = now.totals[terms]
        if move != INSERT and before >= 0:
            total -= now.join_parts[block, place]
        if after >= 0 and (move != INSERT or before >= 0):
            total -= now.join_parts[after_block, after_place]
        if move != REMOVE and before >= 0:
            new[1] = displacement(tables, before, segment)
            total += _join_part(targets, new[1], width)
        if after >= 0 and (move != REMOVE or before >= 0):
            new[2] = displacement(tables, before if move == REMOVE else segment, after)
            total += _join_part(targets, new[2], width)
        new[3 + terms] = total
        if joins > 0:
            cost += targets.transition_weight * transition_cost(targets, total, joins)
        if cost > ceiling:
            return math.inf
    new[0] = 0.0
    if targets.weights[VARIETY] > 0.0:
        but = -1 if move == INSERT else place
        new[0] = now.distances[block]
        if move != REMOVE:
            new[0] += _distance_sum(tables, now, block, segment, but)
        if move != INSERT:
            new[0] -= _distance_sum(tables, now, block, old, but)
        cost += _changed_term(targets, now, new, VARIETY, block, _variety(new[0], count), width)
    return cost


@inlined
def _changed_term(
    targets: Any, now: Any, new: Any, term: int, block: int, value: float, width: float
) -> float:
    """Give the weighted cost of a block term that changes in one block, and note it for `commit`."""
    terms = targets.weights.shape[0]
    new[4 + 2 * terms + term] = value  # the layout: pairs, two jumps, totals (the joins last), parts, values
    if targets.weights[term] <= 0.0:
        return 0.0
    part = _part(targets, term, block, value, width)
    new[4 + terms + term] = part
    new[3 + term] = now.totals[term] + part - now.parts[term, block]
    return targets.weights[term] * term_cost(targets, new[3 + term], now.counts.shape[0])


@inside
def commit(targets: Any, now: Any, what: Any, width: float, new: Any) -> None:
    """Make the change that `change` has weighed."""
    move, block, place, segment = what
    terms = targets.weights.shape[0]
    has_joins = targets.transition_weight > 0.0
    before = before_place(now, block, place)
    after, after_block, after_place = at_place(now, block, place if move == INSERT else place + 1)
    if after >= 0 and has_joins:
        is_first = move == REMOVE and before < 0
        now.jumps[after_block, after_place] = new[2]
        now.join_parts[after_block, after_place] = 0.0 if is_first else _join_part(targets, new[2], width)
    count = now.counts[block]
    if move == INSERT:
        for at in range(count, place, -1):
            now.segments[block, at] = now.segments[block, at - 1]
            now.jumps[block, at] = now.jumps[block, at - 1]
            now.join_parts[block, at] = now.join_parts[block, at - 1]
        now.counts[block] = count + 1
    elif move == REMOVE:
        for at in range(place, count - 1):
            now.segments[block, at] = now.segments[block, at + 1]
            now.jumps[block, at] = now.jumps[block, at + 1]
            now.join_parts[block, at] = now.join_parts[block, at + 1]
        now.counts[block] = count - 1
    if move != REMOVE:
        now.segments[block, place] = segment
        now.jumps[block, place] = new[1]
        now.join_parts[block, place] = (
            _join_part(targets, new[1], width) if before >= 0 and has_joins else 0.0
        )
    now.distances[block] = new[0]
    for term in range(terms):
        if targets.weights[term] > 0.0:
            now.totals[term] = new[3 + term]
            now.parts[term, block] = new[4 + terms + term]
        if term >= SUMS:
            now.sums[term - SUMS, block] = new[4 + 2 * terms + term]
    if has_joins:
        now.totals[terms] = new[3 + terms]
