"""The moves leave exactly the dances they should: every branch of them counted, on a toy of three segments.

Random numbers are replaced by a grid that no threshold of the toy falls on, so that the whole matrix of
transition probabilities comes out of the moves themselves, to the last digit.
"""

from __future__ import annotations

import math
from collections import defaultdict
from functools import cache
from itertools import product

import numpy as np
import pytest
from scipy import stats

from studykit.choreography.cost.block import BlockCost
from studykit.choreography.cost.total import TotalCost
from studykit.choreography.cost.transition import TransitionCost
from studykit.choreography.preset import STUDYKIT
from studykit.choreography.rjmcmc.chain import kernel_chances, kernel_targets
from studykit.choreography.rjmcmc.kernel import arrays
from studykit.choreography.rjmcmc.moves import Moves
from studykit.choreography.rjmcmc.reference import log_acceptance
from studykit.choreography.rjmcmc.repertoire import Repertoire

SIZE, BOUNDS, TEMPERATURE = 3, (1, 3), 0.4
NEIGHBOUR = 0.5
# Shares at which the toy decides are multiples of 1/5, 1/12, 1/12 and 1/6; the grid has their middles.
GRID = [(np.arange(steps) + 0.5) / steps for steps in (5, 12, 12, 6)]


class Toy:
    """All dances of one to three segments, their costs and where the moves lead."""

    def __init__(self, library, novelty: float | None, neighbour: float, *, at_end: bool) -> None:
        self.repertoire = Repertoire(library, STUDYKIT)
        self.novelty = novelty
        self.moves = Moves(
            repertoire=self.repertoire,
            bounds=(BOUNDS,),
            novelties=(novelty,),
            neighbour=neighbour,
            at_end=at_end,
        )
        self.objective = TotalCost(
            (
                (BlockCost(name="duration", targets=(8.0,), tolerances=(30.0,)), 1.0),
                (BlockCost(name="variety", targets=(100.0,), tolerances=(80.0,)), 1.0),
                (BlockCost(name="linear", targets=(1.0,), tolerances=(2.0,), scale="log"), 0.3),
                (BlockCost(name="rotational", targets=(1.0,), tolerances=(2.0,), scale="log"), 0.0),
                (TransitionCost(tolerance_m=0.3), 1.0),
            )
        )
        self.dances = [
            (dance,)
            for count in range(BOUNDS[0], BOUNDS[1] + 1)
            for dance in product(range(SIZE), repeat=count)
            if novelty is not None or len(set(dance)) == count
        ]
        self.costs = np.array([self.objective.cost(self.repertoire.measures(d)) for d in self.dances])

    def target(self) -> np.ndarray:
        """Give p(n) x prior of the urn x exp(-C / t), p(n) even, to the sum of 1."""
        prior = np.array([self._prior(dance[0]) for dance in self.dances])
        weights = prior * np.exp(-self.costs / TEMPERATURE)
        return weights / weights.sum()

    def _prior(self, dance: tuple[int, ...]) -> float:
        # Where nothing comes back, dances that would repeat are simply left out of all.
        novelty = math.inf if self.novelty is None else self.novelty
        probability = 1.0
        for place, segment in enumerate(dance):
            same = dance[:place].count(segment)
            if math.isinf(novelty):
                probability /= SIZE
            else:
                probability *= (novelty / SIZE + same) / (novelty + place)
        return probability

    @cache  # noqa: B019 - toys live as long as the tests
    def outcomes(self, number: int) -> dict:
        """Give all that one move can make of a dance, and how probably."""
        found: dict = defaultdict(float)
        for draws in product(*GRID):
            move = self.moves.proposed(self.dances[number], draws)
            key = None if move is None else (move.made(self.dances[number]), round(move.log_odds, 12))
            found[key] += 1.0
        total = math.prod(map(len, GRID))
        return {key: count / total for key, count in found.items()}

    @cache  # noqa: B019
    def matrix(self, *, is_exact: bool) -> np.ndarray:
        """Give the probability of every step of the chain."""
        number = {dance: n for n, dance in enumerate(self.dances)}
        steps = np.zeros((len(self.dances),) * 2)
        for n in range(len(self.dances)):
            for outcome, probability in self.outcomes(n).items():
                if outcome is not None:
                    to = number[outcome[0]]
                    change = self.costs[to] - self.costs[n]
                    accepted = log_acceptance(change, TEMPERATURE, outcome[1], is_exact=is_exact)
                    steps[n, to] += probability * math.exp(accepted)
            steps[n, n] += 1.0 - steps[n].sum()
        return steps


@pytest.fixture(scope="module")
def toy(made_library):
    library = made_library(SIZE)
    return cache(
        lambda novelty, neighbour=NEIGHBOUR, at_end=False: Toy(library, novelty, neighbour, at_end=at_end)
    )


def stationary(steps: np.ndarray) -> np.ndarray:
    """Give the shares in which the chain visits the dances in the long run."""
    system = np.vstack((steps.T - np.eye(len(steps)), np.ones(len(steps))))
    return np.linalg.lstsq(system, np.append(np.zeros(len(steps)), 1.0), rcond=None)[0]


@pytest.mark.parametrize("at_end", [False, True])
@pytest.mark.parametrize("neighbour", [0.0, NEIGHBOUR])
@pytest.mark.parametrize("novelty", [math.inf, 1.0, None])
def test_the_chain_visits_dances_as_often_as_its_target_says(toy, novelty, neighbour, at_end) -> None:
    one = toy(novelty, neighbour, at_end=at_end)
    steps, target = one.matrix(is_exact=True), one.target()
    assert len(target) == (39 if novelty is not None else 15)
    assert target.max() > 2.0 * target.min()
    flow = target[:, None] * steps
    assert flow == pytest.approx(flow.T, abs=1e-12)  # reversible, dance by dance
    assert stationary(steps) == pytest.approx(target, abs=1e-10)


@pytest.mark.parametrize("at_end", [False, True])
@pytest.mark.parametrize("novelty", [math.inf, 1.0])
def test_leaving_the_odds_out_would_be_noticed(toy, novelty, at_end) -> None:
    one = toy(novelty, NEIGHBOUR, at_end=at_end)
    visits = stationary(one.matrix(is_exact=False))
    assert 0.5 * np.abs(visits - one.target()).sum() > 0.03


def test_another_concentration_would_be_noticed(toy) -> None:
    visits = stationary(toy(1.0).matrix(is_exact=True))
    assert 0.5 * np.abs(visits - toy(math.inf).target()).sum() > 0.02


def test_proposing_neighbours_for_nothing_would_be_noticed(toy) -> None:
    # Wrong: neighbours are proposed, and their odds are those of an urn alone.
    near, far = toy(1.0), toy(1.0, 0.0)
    number = {dance: n for n, dance in enumerate(near.dances)}
    steps = np.zeros((len(near.dances),) * 2)
    for n, now in enumerate(near.dances):
        odds = {outcome[0]: outcome[1] for outcome in far.outcomes(n) if outcome is not None}
        for outcome, probability in near.outcomes(n).items():
            if outcome is not None and outcome[0] != now:
                to = number[outcome[0]]
                change = near.costs[to] - near.costs[n]
                accepted = log_acceptance(change, TEMPERATURE, odds[outcome[0]], is_exact=True)
                steps[n, to] += probability * math.exp(accepted)
        steps[n, n] = 1.0 - steps[n].sum()
    flow = near.target()[:, None] * steps
    assert np.abs(flow - flow.T).max() > 1e-4


def test_40_40_20(toy) -> None:
    one = toy(math.inf)
    shares: dict[int, float] = defaultdict(float)
    for outcome, probability in one.outcomes(one.dances.index(((0, 1),))).items():
        shares[len(outcome[0][0]) - 2] += probability
    assert shares == pytest.approx({1: 0.4, -1: 0.2, 0: 0.4})


@pytest.mark.parametrize(("dance", "refused"), [((0,), 0.2), ((0, 1, 2), 0.4)])
def test_a_length_out_of_bounds_is_not_proposed(toy, dance, refused) -> None:
    one = toy(math.inf)
    outcomes = one.outcomes(one.dances.index((dance,)))
    assert outcomes[None] == pytest.approx(refused)
    assert all(1 <= len(outcome[0][0]) <= 3 for outcome in outcomes if outcome)


def test_the_end_is_the_only_place_of_the_paper_s_addition(toy) -> None:
    end = toy(math.inf, 0.0, at_end=True)
    outcomes = end.outcomes(end.dances.index(((0, 1),)))
    longer = {outcome[0][0] for outcome in outcomes if outcome and len(outcome[0][0]) == 3}
    assert longer == {(0, 1, 0), (0, 1, 1), (0, 1, 2)}


def visits(one: Toy, *, is_exact: bool, samples: int = 6000, apart: int = 40) -> np.ndarray:
    """Count how often the compiled chain is found at each dance, at one temperature."""
    from studykit.choreography.rjmcmc.kernel.running import run

    tables = one.repertoire.tables
    targets = kernel_targets(one.objective, one.moves, one.repertoire)
    chances = kernel_chances(one.moves)._replace(is_exact=is_exact)
    rng = np.random.default_rng(7)
    now = arrays.state(one.dances[0], BOUNDS[1], len(targets.weights))
    kept = arrays.record(now, 1, 1)
    cooling = (np.array([TEMPERATURE]), np.array([1.0]), 0.0, 0.0)
    number = {dance: n for n, dance in enumerate(one.dances)}
    counts = np.zeros(len(one.dances))
    for _ in range(samples):
        run(tables, targets, chances, now, cooling, rng.random((apart, arrays.DRAWS)), kept)
        counts[number[arrays.blocks(now.segments, now.counts)]] += 1
    return counts


@pytest.mark.parametrize("novelty", [math.inf, 1.0])
def test_the_compiled_chain_is_found_where_its_target_says(toy, novelty) -> None:
    one = toy(novelty)
    counts = visits(one, is_exact=True)
    assert stats.chisquare(counts, counts.sum() * one.target()).pvalue > 0.001


def test_a_compiled_chain_without_odds_is_found_elsewhere(toy) -> None:
    one = toy(1.0)
    counts = visits(one, is_exact=False)
    assert stats.chisquare(counts, counts.sum() * one.target()).pvalue < 1e-6
