"""One chain: a search from one beginning, and the descent that ends it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from threading import Event, Lock

import numpy as np

from studykit.choreography.cost.block import BlockCost
from studykit.choreography.cost.total import TotalCost
from studykit.choreography.cost.transition import TransitionCost
from studykit.choreography.dance_library import CHAIN_SEGMENTS, DENSE_LIMIT
from studykit.choreography.goal import Goal
from studykit.choreography.measures import Blocks, Measures
from studykit.choreography.rjmcmc import kernel, reference
from studykit.choreography.rjmcmc.annealing import STOP_ITERATIONS, STOP_TEMPERATURE, Annealing
from studykit.choreography.rjmcmc.kernel import arrays
from studykit.choreography.rjmcmc.moves import Moves
from studykit.choreography.rjmcmc.repertoire import Repertoire
from studykit.choreography.rjmcmc.trace import TraceRow
from studykit.core.arrays import Floats
from studykit.core.progress import notice

_CANDIDATES = 2048
_ROUNDS = 3
_TO_BE_TOLD = Lock()
"""Whoever takes it says that the search compiles; it is never given back, so it is said once."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Found:
    """What one chain found.

    Parameters
    ----------
    blocks : tuple of tuple of int
        The dance, in the numbers of the repertoire.
    measures : Measures
        Its measures, not on reduced distances.
    guided_variety : float
        Its variety as the search saw it.
    cost : float
        Its cost by these.
    is_allowed : bool
        Whether it repeats nothing where nothing may be repeated, and no join breaks a limit; if not, no
        dance was met that does.
    trace : tuple of TraceRow
        How the search went.
    """

    blocks: Blocks
    measures: Measures
    guided_variety: float
    cost: float
    is_allowed: bool
    trace: tuple[TraceRow, ...]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Search:
    """A goal, a repertoire and a way to search, ready to run chains.

    Parameters
    ----------
    goal : Goal
        What is wanted.
    repertoire : Repertoire
        What is danced.
    annealing : Annealing
        Temperatures and widths.
    stop : Event
        Set it, and chains of the plain search stop where they are; compiled ones are done in a moment.
    """

    goal: Goal
    repertoire: Repertoire
    annealing: Annealing
    stop: Event = field(default_factory=Event)

    @property
    def objective(self) -> TotalCost:
        """The total cost that is lowered."""
        return self.goal.objective(self.repertoire.library)

    @classmethod
    def sized(cls, goal: Goal, repertoire: Repertoire, annealing: Annealing) -> Search:
        """Give a search whose annealing, meant for a dance of 32 s, is as much longer as the dance."""
        factor = max(1, math.ceil(goal.segments / CHAIN_SEGMENTS)) if goal.preset.is_reached else 1
        return cls(goal=goal, repertoire=repertoire, annealing=annealing.longer(factor))

    @property
    def is_compiled(self) -> bool:
        """Whether the compiled kernel can do it: every term adds up, and distances are at hand."""
        is_sum = all(isinstance(term, BlockCost | TransitionCost) for term, _ in self.objective.weighted)
        has_distances = self.repertoire.table is not None or self.repertoire.reduced is not None
        return is_sum and has_distances

    @property
    def moves(self) -> Moves:
        """How dances are changed."""
        preset = self.goal.preset
        return Moves(
            repertoire=self.repertoire,
            bounds=tuple((max(1, block.segments - 2), block.segments + 2) for block in self.goal.blocks),
            novelties=tuple(block.novelty for block in self.goal.blocks),
            neighbour=preset.neighbour if self.repertoire.size > 1 else 0.0,
            at_end=preset.moves == "at_end",
            is_exact=preset.acceptance == "exact",
        )

    def start(self, rng: np.random.Generator) -> Blocks:
        """Draw a first dance of the right length; where nothing may come back, nothing does."""
        blocks: list[tuple[int, ...]] = []
        for block in self.goal.blocks:
            chosen: list[int] = []
            for segment in rng.permutation(self.repertoire.size)[: 64 * block.segments].tolist():
                if len(chosen) < block.segments and self._fits(segment, chosen, blocks, block.novelty):
                    chosen.append(segment)
            missing = block.segments - len(chosen)
            blocks.append((*chosen, *rng.integers(self.repertoire.size, size=missing).tolist()))
        return tuple(blocks)

    def _fits(
        self, segment: int, chosen: list[int], before: list[tuple[int, ...]], novelty: float | None
    ) -> bool:
        """Tell whether a segment may follow what was drawn so far."""
        if novelty is None and any(self.repertoire.same_movement(segment, other) for other in chosen):
            return False
        last = chosen[-1] if chosen else before[-1][-1] if before else None
        return last is None or self.repertoire.is_held(last, segment)

    def run(self, rng: np.random.Generator) -> Found:
        """Run one chain."""
        start = self.start(rng)
        draws = rng.random((self.annealing.iterations, arrays.DRAWS))
        if self.is_compiled:
            blocks, trace = _compiled(self, start, draws, rng)
        else:
            steps = reference.steps(self.repertoire, self.objective, self.moves, self.annealing, start, draws)
            blocks, trace = _plain(self, steps)
        guided = self.repertoire.measures(blocks)
        # Distances that are all kept are right to six digits; those of the dance chosen are taken anew.
        is_kept = self.repertoire.table is not None
        measures = guided if is_kept else self.repertoire.measures(blocks, is_exact=True)
        return Found(
            blocks=blocks,
            measures=measures,
            guided_variety=guided.variety,
            cost=self.objective.cost(measures),
            is_allowed=reference.is_allowed(self.repertoire, self.moves, blocks),
            trace=trace,
        )


def kernel_targets(objective: TotalCost, moves: Moves, repertoire: Repertoire) -> arrays.Targets:
    """Lay out goals for the kernel: duration and variety first, then sums as the repertoire has them."""
    costs = {term.name: (term, weight) for term, weight in objective.weighted}
    names = ["duration", "variety", *repertoire.values]
    terms = [costs[name][0] for name in names]
    blocks = [term for term in terms if isinstance(term, BlockCost)]
    transition, transition_weight = costs["transition"]
    assert isinstance(transition, TransitionCost)  # noqa: S101  # the objective is made of these
    return arrays.Targets(
        lowest=np.array([low for low, _ in moves.bounds]),
        highest=np.array([high for _, high in moves.bounds]),
        blocks=np.array([term.targets for term in blocks]),
        tolerances=np.array([term.tolerances for term in blocks]),
        weights=np.array([float(costs[name][1]) for name in names]),
        is_log=np.array([term.scale == "log" for term in blocks]),
        is_pooled=transition.form == "printed",
        transition_tolerance_m=float(transition.tolerance_m),
        transition_weight=float(transition_weight),
        novelties=np.array([arrays.NEVER if novelty is None else novelty for novelty in moves.novelties]),
    )


def kernel_chances(moves: Moves) -> arrays.Chances:
    """Lay out the moves for the kernel."""
    return arrays.Chances(
        insert=moves.insert,
        remove=moves.remove,
        neighbour=moves.neighbour,
        at_end=moves.at_end,
        is_exact=moves.is_exact,
    )


def _compiled(
    search: Search, start: Blocks, draws: Floats, rng: np.random.Generator
) -> tuple[Blocks, tuple[TraceRow, ...]]:
    # The compiler is loaded where it is needed; importing studykit costs little.
    from studykit.choreography.rjmcmc.kernel.running import run

    repertoire, annealing, moves = search.repertoire, search.annealing, search.moves
    tables = repertoire.tables
    targets = kernel_targets(search.objective, moves, repertoire)
    now = arrays.state(start, int(targets.highest.max()), len(targets.weights))
    kept = arrays.record(now, len(annealing.temperatures), STOP_ITERATIONS)
    if not kernel.is_compiled() and _TO_BE_TOLD.acquire(blocking=False):
        notice(kernel.COMPILING)
    cooling = (annealing.temperatures, annealing.widths, annealing.stop_below, STOP_TEMPERATURE)
    best = run(tables, targets, kernel_chances(moves), now, cooling, draws, kept)
    blocks = arrays.blocks(kept.segments, kept.counts)
    if search.goal.preset.descent > 0.0 and math.isfinite(best):
        blocks = _descended(search, tables, targets, blocks, rng)
    names = ("duration", "variety", *repertoire.values, "transition")
    return blocks, _trace(kept.trace, annealing, names)


def _descended(
    search: Search, tables: arrays.Tables, targets: arrays.Targets, blocks: Blocks, rng: np.random.Generator
) -> Blocks:
    """Go down from a dance to the nearest that no single change betters.

    Where distances are reduced, the target of variety is moved by what the reduction got wrong of this dance,
    and the descent goes on from there.
    """
    from studykit.choreography.rjmcmc.kernel.running import descend

    repertoire = search.repertoire
    targets = targets._replace(
        weights=targets.weights * search.goal.preset.descent, blocks=targets.blocks.copy()
    )
    size = repertoire.size
    candidates = np.arange(size)
    if size > DENSE_LIMIT:
        candidates = np.sort(rng.choice(size, size=_CANDIDATES, replace=False))
    varieties = targets.blocks[arrays.VARIETY].copy()
    best, lowest = blocks, math.inf
    for _ in range(_ROUNDS):
        if repertoire.reduced is not None:
            wrong = [repertoire.variety(block, is_exact=True) - repertoire.variety(block) for block in blocks]
            targets.blocks[arrays.VARIETY] = varieties - np.array(wrong)
        now = arrays.state(blocks, int(targets.highest.max()), len(targets.weights))
        descend(tables, targets, now, candidates, arrays.record(now, 1, 1))
        blocks = arrays.blocks(now.segments, now.counts)
        if repertoire.reduced is None:
            return blocks
        cost = search.objective.cost(repertoire.measures(blocks, is_exact=True))
        if cost < lowest:
            best, lowest = blocks, cost
    return best


def _trace(rows: Floats, annealing: Annealing, names: tuple[str, ...]) -> tuple[TraceRow, ...]:
    done = rows[np.isfinite(rows[:, 0])]

    def share(value: float) -> float | None:
        return None if math.isnan(value) else float(value)

    return tuple(
        TraceRow(
            iteration=int(row[0]),
            temperature=float(annealing.temperatures[stage]),
            width=float(annealing.widths[stage]),
            cost=float(row[1]),
            best_cost=float(row[2]),
            segments=int(row[3]),
            accepted=float(row[4]),
            inserted=share(row[5]),
            removed=share(row[6]),
            replaced=share(row[7]),
            terms=dict(zip(names, row[8:].tolist(), strict=True)),
        )
        for stage, row in enumerate(done)
    )


def _plain(search: Search, steps: Iterable[reference.Step]) -> tuple[Blocks, tuple[TraceRow, ...]]:
    """Run the plain search; one that is told to stop gives the best dance so far."""
    rows: list[TraceRow] = []
    each = search.annealing.stage_iterations
    accepted, step = 0, None
    for number, step in enumerate(steps, start=1):
        accepted += step.is_accepted
        if number % each == 0:
            rows.append(
                TraceRow(
                    iteration=number,
                    temperature=step.temperature,
                    width=step.width,
                    cost=step.cost,
                    best_cost=step.best_cost,
                    segments=sum(len(block) for block in step.blocks),
                    accepted=accepted / each,
                    terms=search.objective.terms(search.repertoire.measures(step.blocks)),
                )
            )
            accepted = 0
        if search.stop.is_set():
            break
    assert step is not None  # noqa: S101  # an annealing has an iteration
    return step.best, tuple(rows)
