"""The search as it is meant, written to be read: every cost is taken anew, nothing is carried along.

`rjmcmc.kernel` does the same, change by change, some hundred times faster; both use one row of the same
random numbers an iteration, so that they can be compared move by move. Goals with terms of one's own that do
not add up over segments are searched for by this one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, pairwise

from studykit.choreography.cost.total import TotalCost
from studykit.choreography.measures import Blocks
from studykit.choreography.rjmcmc.annealing import STOP_ITERATIONS, STOP_TEMPERATURE, Annealing
from studykit.choreography.rjmcmc.moves import Move, Moves
from studykit.choreography.rjmcmc.repertoire import Repertoire
from studykit.core.arrays import Floats


@dataclass(frozen=True, kw_only=True, slots=True)
class Step:
    """Where a search stands after one iteration.

    Parameters
    ----------
    temperature, width : float
        Of the annealing.
    blocks : tuple of tuple of int
        The dance.
    cost : float
        Its cost at the present width.
    move : Move or None
        What was proposed; None where nothing could be.
    is_accepted : bool
        Whether that was done.
    best : tuple of tuple of int
        The dance of lowest cost at the final tolerances so far.
    best_cost : float
        Its cost.
    """

    temperature: float
    width: float
    blocks: Blocks
    cost: float
    move: Move | None
    is_accepted: bool
    best: Blocks
    best_cost: float


def log_acceptance(difference: float, temperature: float, log_odds: float, *, is_exact: bool) -> float:
    """Give the log of the probability with which a proposal is accepted (Green 1995; Eq. 13).

    Parameters
    ----------
    difference : float
        Cost proposed minus cost now.
    temperature : float
        t of Eq. 13; 0 accepts what is no worse.
    log_odds : float
        The proposal's own odds; see `moves.Move`.
    is_exact : bool
        Whether they count; without them it is Eq. 13 alone, as the paper seems to have it.

    Examples
    --------
    >>> log_acceptance(0.2, 0.1, 0.0, is_exact=True)
    -2.0
    """
    if temperature <= 0.0:
        return 0.0 if difference <= 0.0 else -math.inf
    return min(0.0, -difference / temperature + (log_odds if is_exact else 0.0))


def steps(
    repertoire: Repertoire,
    objective: TotalCost,
    moves: Moves,
    annealing: Annealing,
    start: Blocks,
    draws: Floats,
) -> Iterator[Step]:
    """Search from a first dance, one iteration at a time.

    Parameters
    ----------
    repertoire : Repertoire
        What is danced.
    objective : TotalCost
        What is lowered.
    moves : Moves
        How dances are changed.
    annealing : Annealing
        Temperatures and widths.
    start : tuple of tuple of int
        Where to begin.
    draws : ndarray, shape (iteration, 5)
        Uniform random numbers below 1.
    """
    now = best = start
    best_cost = objective.cost(repertoire.measures(now)) if is_allowed(repertoire, moves, now) else math.inf
    history = [math.inf] * STOP_ITERATIONS
    stages = zip(annealing.temperatures, annealing.widths, strict=True)
    for stage, (temperature, width) in enumerate(stages):
        cost = objective.cost(repertoire.measures(now), width=width)
        for iteration in range(annealing.stage_iterations):
            row = draws[stage * annealing.stage_iterations + iteration]
            move = moves.proposed(now, row)
            is_accepted = False
            if move is not None:
                proposed = move.made(now)
                change = objective.cost(repertoire.measures(proposed), width=width) - cost
                verdict = log_acceptance(change, temperature, move.log_odds, is_exact=moves.is_exact)
                is_held = all(repertoire.is_held(*join) for join in move.joins(now))
                is_accepted = math.log(1.0 - row[4]) <= verdict and is_held
                if is_accepted:
                    now, cost = proposed, cost + change
                    final = objective.cost(repertoire.measures(now))
                    if final < best_cost and is_allowed(repertoire, moves, now):
                        best, best_cost = now, final
            yield Step(
                temperature=float(temperature),
                width=float(width),
                blocks=now,
                cost=cost,
                move=move,
                is_accepted=is_accepted,
                best=best,
                best_cost=best_cost,
            )
            if annealing.stop_below > 0.0 and temperature <= STOP_TEMPERATURE:
                slot = iteration % STOP_ITERATIONS
                if history[slot] - best_cost <= annealing.stop_below * best_cost:
                    return
                history[slot] = best_cost


def is_allowed(repertoire: Repertoire, moves: Moves, blocks: Blocks) -> bool:
    """Tell whether a dance repeats nothing where nothing may be repeated, and spares protected joints."""
    for block, novelty in zip(blocks, moves.novelties, strict=True):
        if novelty is None and any(
            repertoire.same_movement(one, other) for place, one in enumerate(block) for other in block[:place]
        ):
            return False
    return all(repertoire.is_held(*join) for join in pairwise(chain.from_iterable(blocks)))
