"""The last step: another order of the same segments, never a worse one."""

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations

import pytest

from studykit.choreography.cost.total import TotalCost
from studykit.choreography.cost.transition import TransitionCost
from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.rjmcmc.descent import reordered
from studykit.choreography.rjmcmc.sequence import Repertoire


@pytest.mark.parametrize("seed", range(5))
def test_the_order_found_cannot_be_bettered_by_an_exchange(
    made_library: Callable[..., DanceLibrary], seed: int
) -> None:
    repertoire = Repertoire(made_library(8, seed=seed), "euclidean_z")
    objective = TotalCost(((TransitionCost(tolerance_m=0.3), 1.0),))
    start = repertoire.sequence((0, 1, 2, 3, 4, 5))
    found = reordered(start, objective, repertoire)
    costs = [objective.cost(repertoire.sequence(order).measures) for order in permutations(range(6))]
    cost = objective.cost(found.measures)
    assert sorted(found.segments) == list(start.segments)
    assert cost <= objective.cost(start.measures)
    assert cost <= sorted(costs)[len(costs) // 10]
    assert found.linear_energy == pytest.approx(start.linear_energy)
    assert found.distance_sum == pytest.approx(start.distance_sum)


def test_without_a_transition_term_the_order_stays(made_library: Callable[..., DanceLibrary]) -> None:
    repertoire = Repertoire(made_library(8), "euclidean_z")
    start = repertoire.sequence((3, 1, 2))
    assert reordered(start, TotalCost(()), repertoire) is start
