"""The moves leave exactly the dances they should: every branch of them counted, on a toy of three segments.

Each random number that a move draws is replaced by all its values in turn, so that the whole matrix of
transition probabilities comes out of the moves themselves, to the last digit.
"""

from __future__ import annotations

import math
from collections import defaultdict
from functools import cache
from itertools import product

import numpy as np
import pytest

from studykit.choreography.cost.total import TotalCost
from studykit.choreography.cost.transition import TransitionCost
from studykit.choreography.cost.variety import VarietyCost
from studykit.choreography.rjmcmc.moves import MoveSet
from studykit.choreography.rjmcmc.run import log_acceptance
from studykit.choreography.rjmcmc.sequence import Repertoire

SIZE, BOUNDS, TEMPERATURE = 3, (1, 3), 0.4
GRID = 30  # shares of 30: every threshold of the toy (0.4, 0.6, 1/2, 2/3) lies between two of them


class UndecidedError(Exception):
    """A draw that has not been decided yet, with its number of values."""


class Scripted:
    """Stands in for a generator: gives the values decided so far, then asks for one more."""

    def __init__(self, decided: tuple[int, ...]) -> None:
        self._left = list(decided)

    def _next(self, values: int) -> int:
        if not self._left:
            raise UndecidedError(values)
        return self._left.pop(0)

    def random(self) -> float:
        return (self._next(GRID) + 0.5) / GRID

    def integers(self, values: int) -> int:
        return self._next(values)


def proposals(moves: MoveSet, now, decided: tuple[int, ...] = ()) -> dict:
    """Give every outcome of one move with its probability."""
    try:
        proposal = moves.propose(now, Scripted(decided))
    except UndecidedError as ask:
        # The third draw of a repertoire without repetition is drawn again until it is new: what would need a
        # fourth draw is left out, and the others share its probability.
        again = moves.novelty is None and len(decided) == 3
        if again:
            return {}
        outcomes: dict = defaultdict(float)
        branches = [proposals(moves, now, (*decided, value)) for value in range(ask.args[0])]
        branches = [branch for branch in branches if branch]
        for branch in branches:
            for outcome, probability in branch.items():
                outcomes[outcome] += probability / len(branches)
        return outcomes
    if proposal is None:
        return {None: 1.0}
    return {(proposal.sequence.segments, proposal.log_odds): 1.0}


class Toy:
    """All dances of one to three segments, their costs and where the moves lead."""

    def __init__(self, library, novelty: float | None, place: str = "anywhere") -> None:
        self.repertoire = Repertoire(library, "euclidean_z")
        self.novelty = novelty
        self.moves = MoveSet(repertoire=self.repertoire, bounds=BOUNDS, novelty=novelty, place=place)
        self.objective = TotalCost(
            (
                (VarietyCost(target=100.0, tolerance=80.0), 1.0),
                (TransitionCost(tolerance_m=0.3), 1.0),
            )
        )
        self.dances = [
            dance
            for count in range(BOUNDS[0], BOUNDS[1] + 1)
            for dance in product(range(SIZE), repeat=count)
            if novelty is not None or len(set(dance)) == count
        ]
        self.sequences = [self.repertoire.sequence(dance) for dance in self.dances]
        self.costs = np.array([self.objective.cost(sequence.measures) for sequence in self.sequences])

    def target(self) -> np.ndarray:
        """Give p(n) x prior of the urn x exp(-C / t), p(n) even, to the sum of 1."""
        prior = np.array([self._prior(dance) for dance in self.dances])
        weights = prior * np.exp(-self.costs / TEMPERATURE)
        return weights / weights.sum()

    def _prior(self, dance: tuple[int, ...]) -> float:
        if self.novelty is None:
            return 1.0 / math.perm(SIZE, len(dance))
        probability = 1.0
        for place, segment in enumerate(dance):
            same = dance[:place].count(segment)
            if math.isinf(self.novelty):
                probability /= SIZE
            else:
                probability *= (self.novelty / SIZE + same) / (self.novelty + place)
        return probability

    @cache  # noqa: B019 - toys live as long as the tests
    def outcomes(self) -> list[dict]:
        """Give all that one move can make of each dance."""
        return [proposals(self.moves, now) for now in self.sequences]

    @cache  # noqa: B019
    def matrix(self, rule: str) -> np.ndarray:
        """Give the probability of every step of the chain."""
        number = {dance: n for n, dance in enumerate(self.dances)}
        steps = np.zeros((len(self.dances),) * 2)
        for n, outcomes in enumerate(self.outcomes()):
            for outcome, probability in outcomes.items():
                if outcome is None:
                    continue
                dance, log_odds = outcome
                to = number[dance]
                accepted = log_acceptance(self.costs[to] - self.costs[n], TEMPERATURE, log_odds, rule)
                steps[n, to] += probability * math.exp(accepted)
            steps[n, n] += 1.0 - steps[n].sum()
        return steps


@pytest.fixture(scope="module")
def toy(made_library):
    library = made_library(SIZE)
    return cache(lambda novelty, place="anywhere": Toy(library, novelty, place))


def stationary(steps: np.ndarray) -> np.ndarray:
    """Give the shares in which the chain visits the dances in the long run."""
    system = np.vstack((steps.T - np.eye(len(steps)), np.ones(len(steps))))
    return np.linalg.lstsq(system, np.append(np.zeros(len(steps)), 1.0), rcond=None)[0]


@pytest.mark.parametrize("novelty", [math.inf, 2.0, None])
def test_the_chain_visits_dances_as_often_as_its_target_says(toy, novelty) -> None:
    steps, target = toy(novelty).matrix("exact"), toy(novelty).target()
    assert len(target) == (39 if novelty is not None else 15)
    assert target.max() > 2.0 * target.min()
    flow = target[:, None] * steps
    assert flow == pytest.approx(flow.T, abs=1e-13)  # reversible, dance by dance
    assert stationary(steps) == pytest.approx(target, abs=1e-10)


@pytest.mark.parametrize("novelty", [math.inf, 2.0, None])
def test_leaving_the_odds_out_would_be_noticed(toy, novelty) -> None:
    visits = stationary(toy(novelty).matrix("metropolis"))
    assert 0.5 * np.abs(visits - toy(novelty).target()).sum() > 0.1


def test_adding_at_the_end_only_would_be_noticed(toy) -> None:
    # The paper's move: taking away from the middle has no way back, so no odds make it exact.
    end = toy(math.inf, "at_end")
    flow = end.target()[:, None] * end.matrix("exact")
    assert np.abs(flow - flow.T).max() > 1e-3


def test_another_concentration_would_be_noticed(toy) -> None:
    visits = stationary(toy(2.0).matrix("exact"))
    assert 0.5 * np.abs(visits - toy(math.inf).target()).sum() > 0.02


def test_40_40_20(toy) -> None:
    now = toy(math.inf).repertoire.sequence((0, 1))
    shares: dict[int, float] = defaultdict(float)
    for outcome, probability in proposals(toy(math.inf).moves, now).items():
        shares[len(outcome[0]) - 2] += probability
    assert shares == pytest.approx({1: 0.4, -1: 0.2, 0: 0.4})


@pytest.mark.parametrize(("dance", "refused"), [((0,), 0.2), ((0, 1, 2), 0.4)])
def test_a_length_out_of_bounds_is_not_proposed(toy, dance, refused) -> None:
    outcomes = proposals(toy(math.inf).moves, toy(math.inf).repertoire.sequence(dance))
    assert outcomes[None] == pytest.approx(refused)
    assert all(1 <= len(outcome[0]) <= 3 for outcome in outcomes if outcome)


def test_the_end_is_the_only_place_of_the_paper_s_addition(toy) -> None:
    end = toy(math.inf, "at_end")
    outcomes = proposals(end.moves, end.repertoire.sequence((0, 1)))
    longer = {outcome[0] for outcome in outcomes if len(outcome[0]) == 3}
    assert longer == {(0, 1, 0), (0, 1, 1), (0, 1, 2)}


def test_without_repetition_no_segment_comes_twice(toy) -> None:
    fresh = toy(None)
    for now in fresh.sequences:
        for outcome in proposals(fresh.moves, now):
            assert outcome is None or len(set(outcome[0])) == len(outcome[0])
