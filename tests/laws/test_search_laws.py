"""Laws of the search: the compiled one takes every step of the plain one, and its sums are never off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from studykit.choreography import dance_library
from studykit.choreography.choreograph import dance
from studykit.choreography.reduction import reduced
from studykit.choreography.request import default_plan, requested
from studykit.choreography.rjmcmc import reference
from studykit.choreography.rjmcmc.annealing import STOP_ITERATIONS, STOP_TEMPERATURE, Annealing
from studykit.choreography.rjmcmc.chain import Search, kernel_chances, kernel_targets
from studykit.choreography.rjmcmc.kernel import arrays
from studykit.choreography.rjmcmc.kernel.running import descend, run
from studykit.choreography.rjmcmc.repertoire import Repertoire
from studykit.choreography.schedule import BlockPlan
from studykit.motion.joint_mask import spare

SIZE = 40
ITERATIONS = 1500

TWO_BLOCKS = (
    BlockPlan(duration_s=12.0, intensity="intense", variety="easy"),
    BlockPlan(duration_s=4.0, intensity="light", variety="hard"),
    BlockPlan(duration_s=16.0, intensity="light", variety="hard"),
)
WISHES = {
    "easy": {"variety": "easy"},
    "never twice": {"variety": 1.2, "intensity": "intense"},
    "not smooth": {"variety": "easy", "transition": "off"},
    "blocks": {"schedule": TWO_BLOCKS},
    "spared": {"variety": "easy", "spare": spare("right_elbow", speed_limits_rad_s=7.0)},
    "as printed": {"variety": "easy", "plan": default_plan(preset="paper")},
    "printed blocks": {"schedule": TWO_BLOCKS, "plan": default_plan(preset="paper")},
    "on reduced distances": {"variety": "easy"},
}


@pytest.fixture(scope="module", params=WISHES)
def search(request, made_library) -> Search:
    library = made_library(SIZE, seed=3)
    with pytest.MonkeyPatch.context() as patch:
        if "reduced" in request.param:
            patch.setattr(dance_library, "DENSE_LIMIT", 0)
            library = replace(library, reduced=reduced(library, np.random.default_rng(0), dimensions=16))
        goal = requested(library, **WISHES[request.param])
        known = Repertoire(library, goal.preset, mask=goal.mask)
    annealing = Annealing.geometric(iterations=ITERATIONS, start=0.5, end=0.01, start_width=5.0)
    return Search(goal=goal, repertoire=known, annealing=annealing)


def compiled(search: Search, annealing: Annealing, start, draws):
    """Run the compiled search and give its final state, its record and its best cost."""
    tables = search.repertoire.tables
    targets = kernel_targets(search.objective, search.moves, search.repertoire)
    now = arrays.state(start, int(targets.highest.max()), len(targets.weights))
    kept = arrays.record(now, len(annealing.temperatures), STOP_ITERATIONS)
    cooling = (annealing.temperatures, annealing.widths, annealing.stop_below, STOP_TEMPERATURE)
    best = run(tables, targets, kernel_chances(search.moves), now, cooling, draws, kept)
    return now, kept, best


def plain(search: Search, annealing: Annealing, start, draws) -> list[reference.Step]:
    return list(reference.steps(search.repertoire, search.objective, search.moves, annealing, start, draws))


def test_both_take_the_same_steps(search) -> None:
    rng = np.random.default_rng(1)
    start, draws = search.start(rng), rng.random((ITERATIONS, arrays.DRAWS))
    # Every iteration is a stage of its own, so that the compiled search tells of each.
    progress = np.linspace(0.0, 1.0, ITERATIONS)
    each = Annealing(
        temperatures=0.5 * (0.01 / 0.5) ** progress, widths=5.0 ** (1.0 - progress), stage_iterations=1
    )
    steps = plain(search, each, start, draws)
    now, kept, best = compiled(search, each, start, draws)
    assert kept.trace[:, 1] == pytest.approx([step.cost for step in steps], rel=1e-9, abs=1e-12)
    assert kept.trace[:, 2] == pytest.approx([step.best_cost for step in steps], rel=1e-9, abs=1e-12)
    assert kept.trace[:, 4].tolist() == [float(step.is_accepted) for step in steps]
    assert kept.trace[:, 3].tolist() == [sum(map(len, step.blocks)) for step in steps]
    assert arrays.blocks(now.segments, now.counts) == steps[-1].blocks
    assert arrays.blocks(kept.segments, kept.counts) == steps[-1].best
    assert best == pytest.approx(steps[-1].best_cost, rel=1e-9)
    kinds = {step.move.kind for step in steps if step.move is not None and step.is_accepted}
    assert kinds == {"insert", "remove", "replace"}


def test_sums_carried_along_are_those_measured_from_nothing(search) -> None:
    rng = np.random.default_rng(2)
    start, draws = search.start(rng), rng.random((ITERATIONS, arrays.DRAWS))
    # One stage: nothing is taken anew in between.
    once = Annealing(temperatures=[0.3], widths=[1.0], stage_iterations=ITERATIONS)
    now, kept, _ = compiled(search, once, start, draws)
    last = plain(search, once, start, draws)[-1]
    blocks = arrays.blocks(now.segments, now.counts)
    measures = search.repertoire.measures(blocks)
    assert blocks == last.blocks
    assert kept.trace[0, 1] == pytest.approx(search.objective.cost(measures), rel=1e-9)
    terms = search.objective.terms(measures)
    names = ("duration", "variety", *search.repertoire.values, "transition")
    assert dict(zip(names, kept.trace[0, 8:], strict=True)) == pytest.approx(
        {name: terms[name] for name in names}, rel=1e-9, abs=1e-12
    )
    for row, name in enumerate(search.repertoire.values):
        assert now.sums[row] == pytest.approx(np.array(measures.blocks[name]), rel=1e-9)


def test_no_dance_leaves_its_bounds_or_breaks_a_rule(search) -> None:
    rng = np.random.default_rng(3)
    draws = rng.random((ITERATIONS, arrays.DRAWS))
    moves = search.moves
    for step in plain(search, search.annealing, search.start(rng), draws):
        for block, (fewest, most), novelty in zip(step.blocks, moves.bounds, moves.novelties, strict=True):
            assert fewest <= len(block) <= most
            if novelty is None:
                takes = [search.repertoire.takes[segment] for segment in block]
                starts = [search.repertoire.starts_s[segment] for segment in block]
                assert len(set(zip(takes, starts, strict=True))) == len(block)


def test_a_segment_measured_wrongly_would_be_noticed(made_library) -> None:
    library = made_library(SIZE, seed=3)
    goal = requested(library, variety="easy")
    known = Repertoire(library, goal.preset)
    once = Annealing(temperatures=[0.3], widths=[1.0], stage_iterations=ITERATIONS)
    search = Search(goal=goal, repertoire=known, annealing=once)
    rng = np.random.default_rng(2)
    start, draws = search.start(rng), rng.random((ITERATIONS, arrays.DRAWS))
    last = plain(search, once, start, draws)[-1]
    right = compiled(search, once, start, draws)[1].trace[0, 1]
    known.tables.values.flags.writeable = True
    known.tables.values[0, last.blocks[0][0]] *= 1.001
    known.tables.values.flags.writeable = False
    wrong = compiled(search, once, start, draws)[1].trace[0, 1]
    assert right == pytest.approx(last.cost, rel=1e-9)
    assert wrong != pytest.approx(last.cost, rel=1e-6)


def test_a_descent_ends_where_no_single_change_helps(search) -> None:
    rng = np.random.default_rng(4)
    start, draws = search.start(rng), rng.random((ITERATIONS, arrays.DRAWS))
    _, kept, best = compiled(search, search.annealing, start, draws)
    if not np.isfinite(best):
        pytest.skip("no dance that keeps all rules was met from here")
    repertoire, objective = search.repertoire, search.objective
    targets = kernel_targets(objective, search.moves, repertoire)
    before = arrays.blocks(kept.segments, kept.counts)
    now = arrays.state(before, int(targets.highest.max()), len(targets.weights))
    cost = descend(repertoire.tables, targets, now, np.arange(repertoire.size), arrays.record(now, 1, 1))
    after = arrays.blocks(now.segments, now.counts)
    assert cost == pytest.approx(objective.cost(repertoire.measures(after)), rel=1e-9, abs=1e-12)
    assert cost <= objective.cost(repertoire.measures(before)) + 1e-12
    assert reference.is_allowed(repertoire, search.moves, after)
    for block, places in enumerate(after):
        for place in range(len(places)):
            for segment in range(repertoire.size):
                changed = (*places[:place], segment, *places[place + 1 :])
                other = (*after[:block], changed, *after[block + 1 :])
                if reference.is_allowed(repertoire, search.moves, other):
                    assert objective.cost(repertoire.measures(other)) >= cost - 1e-9


@pytest.mark.parametrize("wish", ["easy", "blocks"])
def test_the_dance_does_not_depend_on_how_many_work_on_it(made_library, wish) -> None:
    library = made_library(SIZE, seed=3)
    goal = requested(library, **WISHES[wish])
    short = Annealing.geometric(iterations=2000, start=0.3, end=0.01, start_width=4.0)
    goal = replace(goal, preset=replace(goal.preset, preview=short, preview_chains=5, is_reached=False))
    one, two, four = (dance(goal, library, seed=9, is_preview=True, workers=workers) for workers in (1, 2, 4))
    assert one.to_dict() == two.to_dict() == four.to_dict()
    assert dance(goal, library, seed=10, is_preview=True).sha256 != one.sha256
