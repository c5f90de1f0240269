"""What a library can reach: whether a goal can be met at all, and if not, what comes nearest."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import Any

from studykit.choreography.cost.term import SegmentTerm
from studykit.choreography.dance_library import CHAIN_SEGMENTS
from studykit.choreography.goal import Block, Goal
from studykit.choreography.measures import Measures
from studykit.choreography.rjmcmc.annealing import Annealing
from studykit.choreography.rjmcmc.chain import Found, Search
from studykit.choreography.rjmcmc.repertoire import Repertoire
from studykit.core.errors import InputError
from studykit.core.seeding import stream
from studykit.motion.body import DEFAULT_BODY_MASS_KG

_PROBE = Annealing.geometric(iterations=20_000, start=0.1, end=1e-4, start_width=1.0)
_ENERGY_WIDTH, _VARIETY_WIDTH = 5.0, 20.0
_CHAINS = 24


class OutOfReachError(InputError):
    """A goal that the library cannot meet.

    Parameters
    ----------
    problem, remedy, where : str
        See `InputError`.
    nearest : Goal
        The same goal with the nearest values that can be reached together.
    """

    def __init__(self, problem: str, *, remedy: str, where: str, nearest: Goal) -> None:
        super().__init__(problem, remedy=remedy, where=where)
        self.nearest = nearest

    def __reduce__(self) -> tuple[Any, ...]:
        made = partial(
            OutOfReachError, self.problem, remedy=self.remedy, where=self.where, nearest=self.nearest
        )
        return made, ()


def nearest(goal: Goal, repertoire: Repertoire) -> Found:
    """Find the dance that comes nearest to a goal, whatever its joins.

    Joins and further terms do not count, and tolerances are so wide that far is worse than near: what is
    lowered is, in effect, the squared distance to the goal, with energies and variety reached jointly.

    Raises
    ------
    InputError
        If no dance was met that keeps all limits and repeats nothing where nothing may be repeated.
    """
    summed = tuple(term for term in goal.terms if isinstance(term, SegmentTerm))
    names = [term.name for term in summed]
    far = _how_far(goal, repertoire)
    wide = replace(
        goal,
        linear_tolerance=max(_ENERGY_WIDTH * goal.linear_tolerance, far["linear"]),
        rotational_tolerance=max(_ENERGY_WIDTH * goal.rotational_tolerance, far["rotational"]),
        variety_tolerance=max(_VARIETY_WIDTH * goal.variety_tolerance, far["variety"]),
        weights={**goal.weights, "transition": 0.0, "mask": 0.0, **dict.fromkeys(names, 0.0)},
        terms=summed,
    )
    search = Search.sized(wide, repertoire, _PROBE)
    best: Found | None = None
    for chain in range(_CHAINS):
        found = search.run(stream(0, "reach", goal.condition, chain))
        if best is None or _rank(goal, found) < _rank(goal, best):
            best = found
        if best.is_allowed and not goal.misses(best.measures):
            break
    assert best is not None  # noqa: S101  # there is a chain
    if not best.is_allowed:
        raise InputError(
            f"no order of {repertoire.size} segments keeps all limits and repeats nothing",
            where=f"{repertoire.library.name}, {goal.condition}",
            remedy="allow more, ask for a dance that is shorter or easier to remember, or add takes",
        )
    return replace(best, cost=goal.objective(repertoire.library).cost(best.measures), trace=())


def _how_far(goal: Goal, repertoire: Repertoire) -> dict[str, float]:
    """Give how far goals lie from usual dances, on their scales: beyond, a narrower cost would be flat."""
    calibration = repertoire.library.calibration
    is_cosine = goal.preset.variety == "cosine"
    varieties = calibration.chain_cosine_varieties if is_cosine else calibration.chain_varieties
    far = {"variety": max(abs(block.variety - float(varieties.mean())) for block in goal.blocks)}
    for name in ("linear", "rotational"):
        usual = float(repertoire.values[name].mean())
        each = [getattr(block, f"{name}_energy") / block.segments for block in goal.blocks]
        is_log = goal.preset.intensity == "log"
        far[name] = max(
            abs(math.log(energy / usual)) if is_log else CHAIN_SEGMENTS * abs(energy - usual)
            for energy in each
        )
    return far


def _rank(goal: Goal, found: Found) -> tuple[bool, int, float]:
    return not found.is_allowed, len(goal.misses(found.measures)), found.cost


def require_reachable(goal: Goal, repertoire: Repertoire) -> Found:
    """Refuse a goal that no dance of a repertoire meets, before any dance is searched for.

    Returns
    -------
    Found
        A dance that meets it, with joins left to chance.

    Raises
    ------
    OutOfReachError
        Says what is out of reach and what comes nearest.
    """
    found = nearest(goal, repertoire)
    missed = goal.misses(found.measures)
    if not missed:
        return found
    reachable = tuple(_reached(block, found.measures, number) for number, block in enumerate(goal.blocks))
    spared = f" with {goal.spared} spared" if goal.mask is not None else ""
    values = "; ".join(map(_words, zip(reachable, goal.blocks, strict=True)))
    if "variety" in missed:
        low, high = variety_range(replace(goal, blocks=reachable), repertoire)
        values += f" (varieties of these energies are {low:.1f} to {high:.1f})"
    problem = (
        f"{repertoire.size} segments cannot reach this{spared}: {', '.join(missed)} cannot be had "
        f"together with the rest; nearest is {values}"
    )
    raise OutOfReachError(
        problem,
        where=f"{repertoire.library.name}, {goal.condition}",
        remedy="ask for that, for a less extreme dance, or add takes",
        nearest=replace(goal, blocks=reachable, note=f"What was asked is out of reach: {problem}."),
    )


def _reached(block: Block, found: Measures, number: int) -> Block:
    return replace(
        block,
        duration_s=found.blocks["duration"][number],
        linear_energy=found.blocks["linear"][number],
        rotational_energy=found.blocks["rotational"][number],
        variety=found.blocks["variety"][number],
    )


def _words(pair: tuple[Block, Block]) -> str:
    reached, asked = pair
    mass = DEFAULT_BODY_MASS_KG
    longer = f"{reached.duration_s:g} s, " if reached.duration_s != asked.duration_s else ""
    return (
        f"{longer}linear energy {mass * reached.linear_energy:.1f} "
        f"(asked {mass * asked.linear_energy:.1f}) J, "
        f"rotational {mass * reached.rotational_energy:.1f} ({mass * asked.rotational_energy:.1f}) J, "
        f"variety {reached.variety:.1f} ({asked.variety:.1f})"
    )


def variety_range(goal: Goal, repertoire: Repertoire) -> tuple[float, float]:
    """Give the lowest and highest variety that dances of the energies asked for can have.

    Variety depends on energy: still dances are alike, and few segments move much.
    """
    ends = []
    for factor in (0.0, 3.0):
        blocks = tuple(replace(block, variety=block.variety * factor + 1e-9) for block in goal.blocks)
        ends.append(nearest(replace(goal, blocks=blocks), repertoire).measures.variety)
    return min(ends), max(ends)
