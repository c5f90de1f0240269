"""What the compiled search works on: plain arrays, grouped by who owns them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studykit.core.arrays import Booleans, Floats, Integers

Singles = NDArray[np.float32]

INSERT, REMOVE, REPLACE = 0, 1, 2
DRAWS = 5
"""Random numbers that an iteration uses: for the move, the place, the source, the segment, the verdict."""
DURATION, VARIETY, SUMS = 0, 1, 2
"""Rows of the block terms: the first two, and where sums over segments begin."""
NEVER = -1.0
"""Novelty of a block in which no movement comes back."""


class Tables(NamedTuple):
    """What the search reads of a library.

    Parameters
    ----------
    values : ndarray, shape (sum, segment)
        What a segment adds to each sum (energies, and whatever else is summed).
    first_poses, last_poses : ndarray, shape (segment, 3, 24), m
        Boundary poses, each axis by itself, single precision.
    distances : ndarray, shape (segment, segment) or (0, 0)
        How different segments are, where the library is small enough to keep that.
    coordinates, residuals : ndarray, shape (segment, dimension) and (segment,)
        Otherwise: reduced features, and the squared length of what the reduction leaves out.
    takes, starts_s : ndarray, shape (segment,)
        Which take a segment comes from, and where it begins.
    successors : ndarray, shape (segment, neighbour)
        Segments that begin much as this one ends.
    tails, heads : ndarray, shape (segment, protected joint, 7, 4)
        Rotations of protected joints at the end and at the beginning.
    speed_limits : ndarray, shape (protected joint,), rad/s
        What their peak may be across a join.
    """

    values: Floats
    first_poses: Singles
    last_poses: Singles
    distances: Floats
    coordinates: Singles
    residuals: Floats
    takes: Integers
    starts_s: Floats
    successors: NDArray[np.int32]
    tails: Floats
    heads: Floats
    speed_limits: Floats


class Targets(NamedTuple):
    """What the search aims at, in numbers.

    Parameters
    ----------
    lowest, highest : ndarray, shape (block,)
        Fewest and most segments of a block.
    blocks, tolerances : ndarray, shape (2 + sum, block)
        Targets of the block terms (length in s, variety, sums) and their tolerances.
    weights : ndarray, shape (2 + sum,)
        lambda of the block terms.
    is_log : ndarray of bool, shape (2 + sum,)
        Whether a term compares logarithms.
    is_pooled : bool
        One cost of all squared deviations (as printed) instead of the mean of one cost a block or join.
    transition_tolerance_m, transition_weight : float
        Of the joins.
    novelties : ndarray, shape (block,)
        How rarely segments come back in a block; `NEVER`: no movement does.
    """

    lowest: Integers
    highest: Integers
    blocks: Floats
    tolerances: Floats
    weights: Floats
    is_log: Booleans
    is_pooled: bool
    transition_tolerance_m: float
    transition_weight: float
    novelties: Floats


class Chances(NamedTuple):
    """How changes are proposed and accepted.

    Parameters
    ----------
    insert, remove : float
        How often each is tried, as shares of 1; what is left is for replacing.
    neighbour : float
        Share of new segments that are drawn from the successors of the segment before.
    at_end : bool
        Whether segments are added at the end of a block only.
    is_exact : bool
        Whether acceptance follows Green (1995), or Eq. 13 alone.
    """

    insert: float
    remove: float
    neighbour: float
    at_end: bool
    is_exact: bool


class State(NamedTuple):
    """A dance in the making, with everything its cost is made of.

    Parameters
    ----------
    segments : ndarray, shape (block, place)
        Rows of the library.
    counts : ndarray, shape (block,)
        How many of the places are used.
    sums : ndarray, shape (sum, block)
        Sums over the segments of a block.
    distances : ndarray, shape (block,)
        Sum of the distances of all pairs of a block.
    jumps : ndarray, shape (block, place), m
        Displacement at the join before each segment; 0 before the first of all.
    parts : ndarray, shape (2 + sum, block)
        What each block adds to each term at the present width.
    join_parts : ndarray, shape (block, place)
        What each join adds to the transition term.
    totals : ndarray, shape (2 + sum + 1,)
        Sums of the parts, the joins last.
    """

    segments: Integers
    counts: Integers
    sums: Floats
    distances: Floats
    jumps: Floats
    parts: Floats
    join_parts: Floats
    totals: Floats


class Record(NamedTuple):
    """What a chain writes down, and the room it works in.

    Parameters
    ----------
    segments, counts : ndarray, shape (block, place) and (block,)
        The best dance so far.
    trace : ndarray, shape (stage, 9 + 2 + sum)
        Iterations done, cost, best cost, segments, share accepted, shares of the inserts, removals and
        replacements tried that were accepted, and every term at its final tolerance, the joins last.
    change : ndarray, shape (4 + 3 * (2 + sum),)
        What a change that was weighed would bring.
    history : ndarray, shape (iteration,)
        Best costs, for the rule to stop.
    tried, taken : ndarray, shape (3,)
        Counts of each move.
    """

    segments: Integers
    counts: Integers
    trace: Floats
    change: Floats
    history: Floats
    tried: Floats
    taken: Floats


def state(blocks: tuple[tuple[int, ...], ...], places: int, terms: int) -> State:
    """Lay out a dance, not yet measured, for a search with so many places a block and block terms."""
    count = len(blocks)
    laid = State(
        segments=np.zeros((count, places), dtype=np.int64),
        counts=np.array([len(block) for block in blocks], dtype=np.int64),
        sums=np.zeros((terms - SUMS, count)),
        distances=np.zeros(count),
        jumps=np.zeros((count, places)),
        parts=np.zeros((terms, count)),
        join_parts=np.zeros((count, places)),
        totals=np.zeros(terms + 1),
    )
    for number, block in enumerate(blocks):
        laid.segments[number, : len(block)] = block
    return laid


def record(now: State, stages: int, stop_iterations: int) -> Record:
    """Give an empty record for a chain that begins with a dance."""
    terms = len(now.parts)
    return Record(
        segments=now.segments.copy(),
        counts=now.counts.copy(),
        trace=np.full((stages, 9 + terms), np.nan),
        change=np.zeros(4 + 3 * terms),
        history=np.full(stop_iterations, np.inf),
        tried=np.zeros(3),
        taken=np.zeros(3),
    )


def blocks(segments: Integers, counts: Integers) -> tuple[tuple[int, ...], ...]:
    """Read the segments of a dance, block by block."""
    rows = zip(segments.tolist(), counts.tolist(), strict=True)
    return tuple(tuple(row[:count]) for row, count in rows)
