"""One chain of the search, and the descent that ends it."""

from __future__ import annotations

import math
from typing import Any

from studykit.choreography.rjmcmc.kernel.arrays import NEVER, REPLACE
from studykit.choreography.rjmcmc.kernel.compiling import compiled, inlined
from studykit.choreography.rjmcmc.kernel.moving import (
    are_joins_held,
    is_allowed,
    is_repetition,
    proposed,
)
from studykit.choreography.rjmcmc.kernel.weighing import (
    change,
    commit,
    measure,
    term_cost,
    transition_cost,
    weigh,
)


@inlined
def log_acceptance(difference: float, temperature: float, log_odds: float, is_exact: bool) -> float:
    """Give the log of the probability with which a proposal is accepted (Green 1995; Eq. 13)."""
    if temperature <= 0.0:
        return 0.0 if difference <= 0.0 else -math.inf
    return min(0.0, -difference / temperature + (log_odds if is_exact else 0.0))


@compiled
def run(tables: Any, targets: Any, chances: Any, now: Any, annealing: Any, draws: Any, kept: Any) -> float:
    """Search from a first dance for the one of lowest cost at the final tolerances.

    Parameters
    ----------
    now : State
        Where to begin; changed.
    annealing : tuple of (ndarray, ndarray, float, float)
        Temperatures and widths by stage; the share of the best cost and the temperature of the rule to stop.
    draws : ndarray, shape (iteration, 5)
        Uniform random numbers below 1; as many rows for every stage.
    kept : Record
        Where the best dance and the trace go.

    Returns
    -------
    float
        The lowest cost; infinite if no dance was met that keeps what must be kept.
    """
    temperatures, widths, stop_below, stop_temperature = annealing
    stages = temperatures.shape[0]
    each = draws.shape[0] // stages
    measure(tables, now)
    best = weigh(targets, now, 1.0)
    if not is_allowed(tables, targets, now):
        best = math.inf
    for stage in range(stages):
        temperature, width = temperatures[stage], widths[stage]
        measure(tables, now)  # sums that were carried through thousands of changes are taken anew
        cost = weigh(targets, now, width)
        kept.tried[:] = 0.0
        kept.taken[:] = 0.0
        is_over = False
        iteration = 0
        for iteration in range(each):
            row = stage * each + iteration
            move, block, place, segment, odds = proposed(tables, targets, chances, now, draws, row)
            if move >= 0:
                kept.tried[move] += 1.0
                what = (move, block, place, segment)
                draw = math.log(1.0 - draws[row, 4])
                ceiling = cost
                if temperature > 0.0:
                    ceiling += temperature * ((odds if chances.is_exact else 0.0) - draw)
                candidate = change(tables, targets, now, what, width, ceiling + 1e-9, kept.change)
                verdict = log_acceptance(candidate - cost, temperature, odds, chances.is_exact)
                if draw <= verdict and are_joins_held(tables, now, what):
                    commit(targets, now, what, width, kept.change)
                    cost = candidate
                    kept.taken[move] += 1.0
                    # Narrow tolerances cost no less than wide ones.
                    if cost < best:
                        final = cost
                        if width != 1.0:
                            final = weigh(targets, now, 1.0)
                            weigh(targets, now, width)
                        if final < best and is_allowed(tables, targets, now):
                            best = final
                            _keep(now, kept)
            if stop_below > 0.0 and temperature <= stop_temperature:
                slot = iteration % kept.history.shape[0]
                is_over = kept.history[slot] - best <= stop_below * best
                kept.history[slot] = best
                if is_over:
                    break
        done = stage * each + iteration + 1
        _write(tables, targets, now, kept, stage, (float(done), cost, best, iteration + 1.0))
        if is_over:
            break
    return best


@inlined
def _keep(now: Any, kept: Any) -> None:
    for block in range(now.counts.shape[0]):
        kept.counts[block] = now.counts[block]
        for place in range(now.counts[block]):
            kept.segments[block, place] = now.segments[block, place]


@inlined
def _write(tables: Any, targets: Any, now: Any, kept: Any, stage: int, told: Any) -> None:
    """Write one row of the trace."""
    trace, blocks = kept.trace, now.counts.shape[0]
    segments = 0
    for block in range(blocks):
        segments += now.counts[block]
    trace[stage, 0], trace[stage, 1], trace[stage, 2], iterations = told
    trace[stage, 3] = segments
    trace[stage, 4] = kept.taken.sum() / iterations
    for move in range(3):
        if kept.tried[move] > 0.0:
            trace[stage, 5 + move] = kept.taken[move] / kept.tried[move]
    measure(tables, now)  # what has no weight is not carried along
    weigh(targets, now, 1.0)
    terms = targets.weights.shape[0]
    for term in range(terms):
        trace[stage, 8 + term] = term_cost(targets, now.totals[term], blocks)
    trace[stage, 8 + terms] = (
        transition_cost(targets, now.totals[terms], segments - 1) if segments > 1 else 0.0
    )


@compiled
def descend(tables: Any, targets: Any, now: Any, candidates: Any, kept: Any) -> float:
    """Change one segment, or the places of two, as long as that lowers the cost; give the cost.

    Parameters
    ----------
    now : State
        Where to begin, keeping all that must be kept; changed.
    candidates : ndarray, shape (candidate,)
        Segments to try at every place.
    kept : Record
        Room to work in.
    """
    measure(tables, now)
    cost = weigh(targets, now, 1.0)
    blocks = now.counts.shape[0]
    improved = True
    while improved:
        improved = False
        for block in range(blocks):
            for place in range(now.counts[block]):
                best, choice = cost - 1e-12, -1
                for segment in candidates:
                    what = (REPLACE, block, place, segment)
                    never = targets.novelties[block] == NEVER
                    if never and is_repetition(tables, now, block, segment, place):
                        continue
                    changed = change(tables, targets, now, what, 1.0, best, kept.change)
                    if changed < best and are_joins_held(tables, now, what):
                        best, choice = changed, segment
                if choice >= 0:
                    what = (REPLACE, block, place, choice)
                    change(tables, targets, now, what, 1.0, math.inf, kept.change)
                    commit(targets, now, what, 1.0, kept.change)
                    cost, improved = best, True
        lowered = _exchange(tables, targets, now, cost)
        if lowered < cost:
            cost, improved = lowered, True
        measure(tables, now)
        cost = weigh(targets, now, 1.0)
    return cost


@inlined
def _exchange(tables: Any, targets: Any, now: Any, cost: float) -> float:
    """Exchange pairs of segments where that lowers the cost; give the cost."""
    blocks, segments = now.counts.shape[0], now.segments
    for first in range(blocks):
        for second in range(first, blocks):
            for one in range(now.counts[first]):
                for other in range(one + 1 if first == second else 0, now.counts[second]):
                    a, b = segments[first, one], segments[second, other]
                    segments[first, one], segments[second, other] = b, a
                    measure(tables, now)
                    changed = weigh(targets, now, 1.0)
                    if changed < cost - 1e-12 and is_allowed(tables, targets, now):
                        cost = changed
                    else:
                        segments[first, one], segments[second, other] = a, b
    return cost
