"""The last step of a search: the same segments in a better order."""

from __future__ import annotations

from itertools import combinations

from studykit.choreography.cost.total import TotalCost
from studykit.choreography.rjmcmc.sequence import DanceSequence, Repertoire


def reordered(found: DanceSequence, objective: TotalCost, repertoire: Repertoire) -> DanceSequence:
    """Exchange two segments of a dance as long as that lowers its cost.

    The order changes nothing but the joins, so intensity, variety and length stay as they were found.
    """
    best, cost = found, objective.cost(found.measures)
    improved = True
    while improved:
        improved = False
        for first, second in combinations(range(len(best.segments)), 2):
            order = list(best.segments)
            order[first], order[second] = order[second], order[first]
            candidate = repertoire.sequence(tuple(order))
            if (proposed := objective.cost(candidate.measures)) < cost - 1e-12:
                best, cost, improved = candidate, proposed, True
    return best
