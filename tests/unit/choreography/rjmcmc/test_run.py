"""The search itself: acceptance, annealing, stopping, and what it visits in the long run."""

from __future__ import annotations

import math
from collections import Counter
from itertools import product

import numpy as np
import pytest

from studykit.choreography.cost.total import TotalCost
from studykit.choreography.cost.transition import TransitionCost
from studykit.choreography.cost.variety import VarietyCost
from studykit.choreography.rjmcmc.moves import MoveSet, Proposal
from studykit.choreography.rjmcmc.run import log_acceptance, run
from studykit.choreography.rjmcmc.schedule import Schedule
from studykit.choreography.rjmcmc.sequence import Repertoire

OBJECTIVE = TotalCost(
    ((VarietyCost(target=100.0, tolerance=80.0), 1.0), (TransitionCost(tolerance_m=0.3), 1.0))
)


def steady(temperature: float, iterations: int, **options) -> Schedule:
    return Schedule(temperatures=[temperature], widths=[1.0], stage_iterations=iterations, **options)


@pytest.mark.parametrize(
    ("change", "temperature", "log_odds", "rule", "expected"),
    [
        (0.3, 0.1, 0.0, "exact", -3.0),
        (0.3, 0.1, math.log(2.0), "exact", -3.0 + math.log(2.0)),
        (0.3, 0.1, math.log(2.0), "metropolis", -3.0),
        (-0.3, 0.1, math.log(0.5), "exact", 0.0),
        (0.0, 0.1, math.log(0.5), "exact", math.log(0.5)),
        (0.0, 0.1, math.log(0.5), "metropolis", 0.0),
        (1e-12, 0.0, 5.0, "exact", -math.inf),
        (0.0, 0.0, -5.0, "exact", 0.0),
    ],
)
def test_the_chance_of_acceptance(change, temperature, log_odds, rule, expected) -> None:
    assert log_acceptance(change, temperature, log_odds, rule) == pytest.approx(expected)


@pytest.fixture(scope="module")
def repertoire(made_library):
    return Repertoire(made_library(3), "euclidean_z")


class Watched:
    """A move that counts where the chain is each time it moves."""

    def __init__(self, moves: MoveSet, every: int) -> None:
        self.visits: Counter[tuple[int, ...]] = Counter()
        self._moves, self._every, self._calls = moves, every, 0

    def propose(self, now, rng) -> Proposal | None:
        self._calls += 1
        if self._calls % self._every == 0:
            self.visits[now.segments] += 1
        return self._moves.propose(now, rng)


def visits_too_far_off(repertoire, rule: str) -> float:
    """Give chi-squared a degree of freedom of the chain's visits to the 12 dances of one or two segments."""
    temperature, dances = 0.4, [d for n in (1, 2) for d in product(range(3), repeat=n)]
    watched = Watched(MoveSet(repertoire=repertoire, bounds=(1, 2)), every=25)
    start = repertoire.sequence((0, 1))
    run(start, OBJECTIVE, watched, steady(temperature, 60_000), rng=np.random.default_rng(7), rule=rule)
    weights = np.array(
        [
            math.exp(-OBJECTIVE.cost(repertoire.sequence(d).measures) / temperature) / 3.0 ** len(d)
            for d in dances
        ]
    )
    expected = weights / weights.sum() * watched.visits.total()
    observed = np.array([watched.visits[d] for d in dances])
    return float(((observed - expected) ** 2 / expected).sum() / (len(dances) - 1))


def test_long_runs_visit_dances_by_their_target(repertoire) -> None:
    assert visits_too_far_off(repertoire, "exact") < 2.25  # 99 % of 11 degrees of freedom


def test_the_plain_rule_would_be_noticed(repertoire) -> None:
    assert visits_too_far_off(repertoire, "metropolis") > 10.0


def search(made_library, seed: int, schedule: Schedule | None = None, **options):
    repertoire = Repertoire(made_library(30), "euclidean_z")
    moves = MoveSet(repertoire=repertoire, bounds=(2, 6), **options)
    schedule = schedule or Schedule.geometric(iterations=2000, start=0.3, end=0.002, start_width=4.0)
    return repertoire, run(
        repertoire.sequence((0, 1, 2, 3)), OBJECTIVE, moves, schedule, rng=np.random.default_rng(seed)
    )


def test_the_same_seed_finds_the_same_dance_by_the_same_way(made_library) -> None:
    (_, first), (_, again), (_, other) = (search(made_library, seed) for seed in (1, 1, 2))
    assert first.sequence == again.sequence
    assert first.trace == again.trace
    assert first.trace != other.trace


def test_the_best_dance_met_is_kept_with_its_cost(made_library) -> None:
    repertoire, result = search(made_library, 4)
    assert 2 <= len(result.sequence.segments) <= 6
    assert OBJECTIVE.cost(repertoire.sequence(result.sequence.segments).measures) == pytest.approx(
        result.cost
    )
    assert len(result.trace) == 100
    assert result.trace[-1].iteration == 2000
    best = [row.best_cost for row in result.trace]
    assert best == sorted(best, reverse=True)
    assert best[-1] == result.cost < OBJECTIVE.cost(repertoire.sequence((0, 1, 2, 3)).measures)


def test_at_temperature_zero_nothing_gets_worse(made_library) -> None:
    cold = Schedule(temperatures=np.zeros(40), widths=np.ones(40), stage_iterations=20)
    _, result = search(made_library, 5, cold)
    costs = [row.cost for row in result.trace]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] < costs[0]
    assert result.trace[-1].best_cost == pytest.approx(costs[-1])
    hot = Schedule(temperatures=np.ones(40), widths=np.ones(40), stage_iterations=20)
    costs = [row.cost for row in search(made_library, 5, hot)[1].trace]
    assert costs != sorted(costs, reverse=True)


def test_a_search_that_gets_no_better_stops_when_cold(made_library) -> None:
    plan = {"temperatures": [1.0, 0.5, 0.0, 0.0, 0.0], "widths": np.ones(5), "stage_iterations": 2000}
    _, whole = search(made_library, 6, Schedule(**plan))
    _, stopped = search(made_library, 6, Schedule(**plan, stop_below=0.03))
    assert whole.trace[-1].iteration == 10_000
    # Never while hot; once cold, after at least 50 iterations and then for good.
    assert 4050 <= stopped.trace[-1].iteration < 6000
    assert len(stopped.trace) == 3
    assert stopped.cost >= whole.cost


def test_a_search_that_begins_cold_looks_around_first(made_library) -> None:
    _, result = search(made_library, 8, steady(0.0, 5000, stop_below=0.03))
    assert 50 < result.trace[-1].iteration < 5000
