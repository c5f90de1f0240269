"""Running the search."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from studykit.choreography.cost.total import TotalCost
from studykit.choreography.rjmcmc.moves import Move
from studykit.choreography.rjmcmc.schedule import Schedule
from studykit.choreography.rjmcmc.sequence import DanceSequence

_STOP_WINDOW = 50
_COLD = 0.05


@dataclass(frozen=True, kw_only=True, slots=True)
class TraceRow:
    """Where the search stood at the end of a stage."""

    iteration: int
    temperature: float
    width: float
    cost: float
    best_cost: float
    segments: int
    accepted: float


@dataclass(frozen=True, kw_only=True, slots=True)
class SearchResult:
    """The best dance that a search met, and how it got there."""

    sequence: DanceSequence
    cost: float
    trace: tuple[TraceRow, ...]


def log_acceptance(
    change: float, temperature: float, log_odds: float, rule: Literal["exact", "metropolis"]
) -> float:
    """Give the log of the probability with which a proposal is accepted (Green 1995; Eq. 13).

    Parameters
    ----------
    change : float
        Cost proposed minus cost now.
    temperature : float
        t of Eq. 13; 0 accepts what is no worse.
    log_odds : float
        The proposal's own odds; see `Proposal`.
    rule : {"exact", "metropolis"}
        "metropolis" leaves the odds out, as the paper seems to.

    Examples
    --------
    >>> log_acceptance(0.2, 0.1, 0.0, "exact")
    -2.0
    """
    if temperature <= 0.0:
        return 0.0 if change <= 0.0 else -math.inf
    return min(0.0, -change / temperature + (log_odds if rule == "exact" else 0.0))


def run(
    start: DanceSequence,
    objective: TotalCost,
    move: Move,
    schedule: Schedule,
    *,
    rng: np.random.Generator,
    rule: Literal["exact", "metropolis"] = "exact",
) -> SearchResult:
    """Search from a first dance for the one of lowest cost.

    Parameters
    ----------
    start : DanceSequence
        Where to begin.
    objective : TotalCost
        What is lowered.
    move : Move
        How dances are changed.
    schedule : Schedule
        Temperatures and tolerances.
    rng : Generator
        All chance comes from here.
    rule : {"exact", "metropolis"}
        How proposals are accepted.

    Returns
    -------
    SearchResult
        The best dance at the final tolerances.
    """
    now = best = start
    best_cost = objective.cost(start.measures)
    history = [math.inf] * _STOP_WINDOW
    trace: list[TraceRow] = []
    for stage, (temperature, width) in enumerate(zip(schedule.temperatures, schedule.widths, strict=True)):
        cost = objective.cost(now.measures, width=width)
        accepted, stalled = 0, False
        for iteration in range(schedule.stage_iterations):
            proposal = move.propose(now, rng)
            draw = math.log(1.0 - rng.random())
            if proposal is not None:
                proposed = objective.cost(proposal.sequence.measures, width=width)
                if draw < log_acceptance(proposed - cost, temperature, proposal.log_odds, rule):
                    now, cost, accepted = proposal.sequence, proposed, accepted + 1
                    final = proposed if width == 1.0 else objective.cost(now.measures)
                    if final < best_cost:
                        best, best_cost = now, final
            if schedule.stop_below > 0.0 and temperature <= _COLD:
                slot = iteration % _STOP_WINDOW
                stalled = history[slot] - best_cost <= schedule.stop_below * best_cost
                history[slot] = best_cost
                if stalled:
                    break
        done = stage * schedule.stage_iterations + iteration + 1
        trace.append(
            TraceRow(
                iteration=done,
                temperature=float(temperature),
                width=float(width),
                cost=cost,
                best_cost=best_cost,
                segments=len(now.segments),
                accepted=accepted / (iteration + 1),
            )
        )
        if stalled:
            break
    return SearchResult(sequence=best, cost=best_cost, trace=tuple(trace))
