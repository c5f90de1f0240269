"""From goals to dances on a made-up library: what is given, what is refused, and what stops it."""

from __future__ import annotations

import os
import signal
import sys
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from studykit.choreography.choreograph import choreograph, dance
from studykit.choreography.cost.term import SegmentTerm, gaussian
from studykit.choreography.preset import PAPER
from studykit.choreography.reach import OutOfReachError
from studykit.choreography.request import requested
from studykit.choreography.rjmcmc import chain
from studykit.choreography.rjmcmc.annealing import Annealing
from studykit.choreography.rjmcmc.search import PATIENCE
from studykit.choreography.schedule import BlockPlan
from studykit.choreography.targets import goal, goals
from studykit.core.errors import InputError
from studykit.core.parallel import one_core
from studykit.io.protocol_file import read_protocol
from studykit.motion import kinematics
from studykit.motion.animation import animate
from studykit.motion.blending import joined
from studykit.motion.joint_mask import spare
from studykit.protocol.condition import Condition

PROTOCOL = read_protocol(Path(__file__).parents[3] / "protocols" / "dance-2x2x2.toml")
DANCING = sys.modules["studykit.choreography.choreograph"]  # the package gives the function of that name
HAND = 23


@pytest.fixture(scope="module")
def library(swinging):
    return swinging(24)


@pytest.fixture(scope="module")
def reachable(library, within_reach):
    """Give a goal of four segments that the library reaches quickly."""
    return within_reach(requested(library, duration_s=16.0), library)


@pytest.fixture(scope="module")
def found(library, reachable):
    return dance(reachable, library, seed=2)


def tiny(preset, iterations: int, **changes):
    annealing = Annealing(
        temperatures=np.geomspace(0.2, 0.001, 5), widths=np.ones(5), stage_iterations=iterations // 5
    )
    return replace(preset, annealing=annealing, preview=annealing, **changes)


# --- what is given ---------------------------------------------------------------------------------------


def test_a_dance_is_its_segments_animated(library, found) -> None:
    rows = [segment.id for segment in found.segments]
    with one_core():
        moved = animate([library.motion(row) for row in rows])
    assert np.array_equal(found.motion.rotations, moved.rotations)
    assert np.array_equal(found.motion.root_positions, moved.root_positions)
    assert [segment.take for segment in found.segments] == [f"take-{row // 2}" for row in rows]
    assert [segment.start_s for segment in found.segments] == [4.0 * (row % 2) for row in rows]
    assert found.is_synthetic
    assert not found.is_interrupted
    assert found.distinct_segments == len(set(rows))


def test_a_dance_is_as_asked_and_says_what_it_costs(found, reachable) -> None:
    assert found.asked == reachable.measures
    assert len(found.motion) == 480
    assert found.achieved.duration_s == 16.0
    assert found.achieved.linear_energy == pytest.approx(found.asked.linear_energy, rel=0.05)
    assert found.achieved.rotational_energy == pytest.approx(found.asked.rotational_energy, rel=0.05)
    assert abs(found.achieved.variety - found.asked.variety) <= reachable.variety_tolerance
    assert found.cost_total == pytest.approx(
        sum(found.weights[name] * cost for name, cost in found.cost_terms.items())
    )
    assert found.weights == {name: reachable.weights[name] for name in found.cost_terms}
    # Both chains are told; the dance may not be the cheapest of them, but it is one of them.
    assert len(found.chain_costs) == reachable.preset.chains
    assert min(abs(found.cost_total - cost) for cost in found.chain_costs) < 1e-5
    assert found.variety_error == pytest.approx(0.0, abs=1e-3)


def test_blocks_are_met_one_by_one(library, within_reach) -> None:
    plans = (BlockPlan(duration_s=16.0), BlockPlan(duration_s=16.0))
    level = within_reach(requested(library, schedule=plans), library)
    calm, wild = level.blocks
    aims = tuple(
        replace(
            block,
            linear_energy=factor * block.linear_energy,
            rotational_energy=factor * block.rotational_energy,
        )
        for block, factor in ((calm, 1.0), (wild, 1.25))
    )
    found = dance(replace(level, blocks=aims), library, seed=1, is_preview=True)
    assert len(found.blocks) == 2
    for block, aim in zip(found.blocks, aims, strict=True):
        assert block.asked == aim.measures
        assert block.achieved.linear_energy == pytest.approx(aim.linear_energy, rel=0.05)
        assert block.achieved.rotational_energy == pytest.approx(aim.rotational_energy, rel=0.05)
    assert found.blocks[1].achieved.linear_energy > 1.1 * found.blocks[0].achieved.linear_energy


def test_a_dance_says_which_segments_are_mirrored_and_who_set_its_targets(library, quick) -> None:
    sides = library.segments.assign(mirrored=np.arange(24) % 3 == 0)
    rated = {
        "linear_energy": {"light": 1.0, "intense": 8.0 * library.linear_energies.sum(axis=1).mean()},
        "rotational_energy": {"light": 0.5, "intense": 8.0 * library.rotational_energies.sum(axis=1).mean()},
        "variety": {"easy": 80.0, "hard": 150.0},
    }
    other = replace(library, segments=sides, calibration=replace(library.calibration, rated=rated))
    asked = goal(PROTOCOL.dance, Condition.parse("intense-easy-on"), other)
    found = dance(replace(asked, preset=quick), other, seed=2, is_preview=True)
    assert found.asked.linear_energy == rated["linear_energy"]["intense"]
    assert [segment.mirrored for segment in found.segments] == [s.id % 3 == 0 for s in found.segments]
    assert found.targets_from == "raters"


def test_another_seed_is_another_dance_and_the_same_the_same(library, reachable) -> None:
    first, again, other = (dance(reachable, library, seed=seed, is_preview=True) for seed in (2, 2, 6))
    assert first.sha256 == again.sha256 != other.sha256
    assert first.to_dict() == again.to_dict()


def test_a_spared_hand_stays_below_its_limit_in_what_is_shown(library, within_reach) -> None:
    limit = float(np.quantile(library.peak_speeds[:, HAND], 0.6))
    mask = spare("right_hand", speed_limits_rad_s=limit)
    asked = within_reach(requested(library, duration_s=16.0, spare=mask), library)
    found = dance(asked, library, seed=1)
    peaks = kinematics.angular_speeds(found.motion.rotations, 30.0).max(axis=0)
    assert peaks[HAND] <= limit
    assert found.mask is asked.mask
    assert all(library.peak_speeds[segment.id, HAND] <= limit for segment in found.segments)
    assert found.achieved.linear_energy == pytest.approx(asked.measures.linear_energy, rel=0.05)
    assert found.achieved.rotational_energy == pytest.approx(asked.measures.rotational_energy, rel=0.05)
    # Wrong: the same goal without the mask uses segments in which the hand is faster.
    free = dance(replace(asked, mask=None), library, seed=1, is_preview=True)
    assert any(library.peak_speeds[segment.id, HAND] > limit for segment in free.segments)


def test_the_paper_s_preset_gives_the_best_it_met(library, reachable, monkeypatch) -> None:
    shown = []
    monkeypatch.setattr(DANCING, "animate", lambda motions, **how: shown.append(how) or joined(motions))
    far = replace(
        reachable,
        blocks=tuple(replace(b, linear_energy=100.0 * b.linear_energy) for b in reachable.blocks),
        preset=tiny(PAPER, 500),
    )
    found = dance(far, library, seed=1)
    assert found.preset == "paper"
    assert 2 <= len(found.segments) <= 6
    assert len(found.chain_costs) == 1
    assert found.achieved.linear_energy < 0.1 * found.asked.linear_energy
    assert [(how["blend"], how["is_cleaned"]) for how in shown] == [("bridge", False)]


def test_a_first_look_is_shown_even_if_it_misses(library, reachable, monkeypatch) -> None:
    monkeypatch.setattr(DANCING, "require_reachable", lambda *_, **__: None)
    wild = replace(reachable, blocks=tuple(replace(b, linear_energy=50.0) for b in reachable.blocks))
    shown = dance(wild, library, seed=1, is_preview=True)
    assert shown.achieved.linear_energy < 0.5 * shown.asked.linear_energy
    blended = joined([library.motion(segment.id) for segment in shown.segments])
    assert shown.motion.rotations == pytest.approx(blended.rotations, abs=1e-12)
    assert not shown.animation.is_cleaned
    assert len(shown.chain_costs) == wild.preset.preview_chains
    with pytest.raises(InputError, match="no dance of 16 s was found"):
        dance(wild, library, seed=1)


def test_one_dance_a_condition_in_the_order_of_the_protocol(library, monkeypatch) -> None:
    made, told = [], []
    monkeypatch.setattr(DANCING, "require_reachable", lambda *_: None)

    def danced(goal, _known, *, seed, **_):
        made.append((goal.condition, seed))
        return goal.condition

    monkeypatch.setattr(DANCING, "_danced", danced)

    def progress(items, *, label, total):
        told.append((label, total))
        return items

    dances = choreograph(PROTOCOL, library, seed=9, progress=progress)
    assert list(dances) == list(PROTOCOL.order.labels) == list(goals(PROTOCOL, library))
    assert list(dances.values()) == list(dances)
    assert sorted(made) == sorted((label, 9) for label in PROTOCOL.order.labels)
    assert told == [("Choreographing", 8)]


def test_no_dance_is_searched_for_where_another_is_out_of_reach(library, monkeypatch) -> None:
    monkeypatch.setattr(DANCING, "search", lambda *_, **__: pytest.fail("a dance was searched for"))
    with pytest.raises(InputError, match="cannot reach this"):
        choreograph(PROTOCOL, library)


# --- what is refused -------------------------------------------------------------------------------------


def test_a_library_too_small_for_the_length_is_refused(made_library, reachable) -> None:
    varied = replace(reachable, blocks=tuple(replace(block, novelty=None) for block in reachable.blocks))
    with pytest.raises(InputError, match=r"^made-up: the library has 3 movements, .* needs 4; add takes"):
        dance(varied, made_library(3))


def test_where_no_chain_hits_the_dance_that_showed_it_possible_is_given(library, reachable) -> None:
    # Chains of twenty steps find nothing; that the goal is within reach was found out before.
    hasty = replace(reachable, preset=tiny(reachable.preset, 20, descent=0.0))
    found = dance(hasty, library, seed=1)
    assert found.achieved.linear_energy == pytest.approx(found.asked.linear_energy, rel=0.05)
    assert found.achieved.rotational_energy == pytest.approx(found.asked.rotational_energy, rel=0.05)
    assert abs(found.achieved.variety - found.asked.variety) <= reachable.variety_tolerance


def test_a_goal_that_no_chain_meets_is_refused_after_patience(library, reachable, monkeypatch) -> None:
    monkeypatch.setattr(DANCING, "require_reachable", lambda *_, **__: None)
    tried = []
    run = chain.Search.run
    monkeypatch.setattr(chain.Search, "run", lambda search, rng: tried.append(rng) or run(search, rng))
    far = replace(
        reachable, blocks=tuple(replace(b, linear_energy=100.0 * b.linear_energy) for b in reachable.blocks)
    )
    sentence = (
        r"^made-up, light-easy-on: no dance of 16 s was found in 24 segments "
        r"\(linear energy off by 9\d%.*\); add takes, or ask for a longer or less extreme dance\.$"
    )
    with pytest.raises(InputError, match=sentence):
        dance(far, library)
    assert len(tried) == PATIENCE * reachable.preset.chains


def test_a_hand_that_no_animation_holds_is_refused_by_name(library, within_reach, monkeypatch) -> None:
    mask = spare("right_hand", speed_limits_rad_s=float(np.quantile(library.peak_speeds[:, HAND], 0.6)))
    asked = within_reach(requested(library, duration_s=16.0, spare=mask), library)

    def flailing(motions, **_):
        motion = joined(motions)
        rotations = np.array(motion.rotations)
        rotations[100, HAND] = [0.0, 1.0, 0.0, 0.0]
        return replace(motion, rotations=rotations)

    monkeypatch.setattr(DANCING, "animate", flailing)
    with pytest.raises(InputError, match=r"^made-up: right_hand turn faster or further than allowed"):
        dance(asked, library)


def test_a_dance_whose_joins_change_its_energy_gives_way_to_another(library, reachable, monkeypatch) -> None:
    # The first of the dances found gains energy where it is joined; the next does not.
    shown = []

    def animated(motions, **_):
        motion = joined(motions)
        shown.append(motion)
        if len(shown) > 1:
            return motion
        rotations = np.array(motion.rotations)
        rotations[::2, 5] = [0.0, 1.0, 0.0, 0.0]
        return replace(motion, rotations=rotations)

    monkeypatch.setattr(DANCING, "animate", animated)
    found = dance(reachable, library, seed=2)
    assert len(shown) == 2
    assert np.array_equal(found.motion.rotations, shown[1].rotations)


# --- terms of one's own ----------------------------------------------------------------------------------


class Late:
    """How late in the library segments stand, 0 to 1: a term that adds up over segments."""

    name, weight, target, tolerance = "late", 2.0, 0.8, 0.03

    def values(self, library):
        return np.linspace(0.0, 1.0, len(library))


class Alternating:
    """Even and odd segments take turns: nothing that adds up over segments."""

    name, weight = "alternating", 3.0

    def cost(self, measures, *, width=1.0):
        row = [segment for block in measures.segments for segment in block]
        same = sum(a % 2 == b % 2 for a, b in pairwise(row))
        return gaussian(same, 0.5 * width)


def lateness(found) -> float:
    return float(np.mean([segment.id for segment in found.segments])) / 23.0


def test_a_term_over_segments_steers_the_compiled_search(library, reachable) -> None:
    assert isinstance(Late(), SegmentTerm)
    steered = replace(reachable, terms=(Late(),))
    known = chain.Repertoire(library, steered.preset, terms=steered.terms)
    assert chain.Search(goal=steered, repertoire=known, annealing=steered.preset.annealing).is_compiled
    for seed in (1, 2):
        found = dance(steered, library, seed=seed, is_preview=True)
        assert lateness(found) == pytest.approx(0.8, abs=2 * Late.tolerance)
        assert found.cost_terms["late"] == pytest.approx(gaussian(lateness(found) - 0.8, 0.03), abs=1e-9)
        assert found.weights["late"] == 2.0
        assert "late" in found.trace[0].terms
    # Without it, or without a weight, dances are not late.
    free = np.mean([lateness(dance(reachable, library, seed=s, is_preview=True)) for s in range(4)])
    assert abs(free - 0.8) > 4 * Late.tolerance


def test_a_term_of_any_other_kind_is_searched_for_plainly(library, reachable) -> None:
    taking_turns = replace(reachable, terms=(Alternating(),), preset=tiny(reachable.preset, 400))
    known = chain.Repertoire(library, taking_turns.preset, terms=taking_turns.terms)
    search = chain.Search(goal=taking_turns, repertoire=known, annealing=taking_turns.preset.preview)
    assert not search.is_compiled
    found = dance(taking_turns, library, seed=1, is_preview=True)
    assert found.cost_terms["alternating"] == 0.0
    assert found.weights["alternating"] == 3.0
    costs = [row.best_cost for row in found.trace]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] < costs[0]
    assert found.trace[-1].iteration == 400
    # Without it, some dance has two alike in a row.
    free = [dance(reachable, library, seed=seed, is_preview=True) for seed in range(4)]
    assert not all(np.diff([segment.id % 2 for segment in one.segments]).all() for one in free)


def test_a_term_with_values_that_are_no_numbers_is_refused(library, reachable) -> None:
    class Broken(Late):
        def values(self, library):
            return np.full(len(library), np.nan)

    with pytest.raises(
        InputError, match=r"^the term late: .*; give one number for each of the 24 segments\.$"
    ):
        dance(replace(reachable, terms=(Broken(),)), library)


# --- what stops it ---------------------------------------------------------------------------------------


@pytest.fixture
def listening():
    """Hear Ctrl-C, which processes in the background do not."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("listening")
def test_ctrl_c_keeps_the_best_dance_so_far_and_says_so(library, reachable, monkeypatch) -> None:
    run = chain.Search.run
    asked = replace(reachable, preset=tiny(reachable.preset, 20, preview_chains=6, descent=0.0))
    done = []

    def interrupted(search, rng):
        found = run(search, rng)
        if search.annealing.iterations == 20:  # not the probe of what is in reach
            done.append(found)
            if len(done) == 2:
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(0.2)
        return found

    monkeypatch.setattr(chain.Search, "run", interrupted)
    found = dance(asked, library, seed=1, workers=1, is_preview=True)
    assert found.is_interrupted
    assert found.chain_costs == tuple(one.cost for one in done)
    assert len(done) in (2, 3)  # what had begun is finished, the rest never is
    assert min(abs(found.cost_total - cost) for cost in found.chain_costs) < 1e-5
    assert found.to_dict()["is_interrupted"]
    assert len(found.motion) == 120 * len(found.segments)


@pytest.mark.usefixtures("listening")
def test_ctrl_c_stops_a_plain_search_where_it_is(library, reachable) -> None:
    class Watched(Alternating):
        asked = 0

        def cost(self, measures, *, width=1.0):
            self.asked += 1
            if self.asked == 500:
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(0.2)
            return super().cost(measures, width=width)

    term = Watched()
    # Left alone, it would take minutes.
    endless = replace(reachable, terms=(term,), preset=tiny(reachable.preset, 200_000, preview_chains=1))
    found = dance(endless, library, seed=1, is_preview=True)
    assert found.is_interrupted
    assert term.asked < 5000
    assert len(found.chain_costs) == 1
    assert found.cost_total == pytest.approx(found.chain_costs[0], rel=1e-5)


def test_ctrl_c_before_any_dance_is_passed_on(library, reachable, monkeypatch) -> None:
    def stopped(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(DANCING, "require_reachable", stopped)
    with pytest.raises(KeyboardInterrupt):
        dance(reachable, library)


def test_nothing_is_shown_of_a_goal_out_of_reach_even_at_a_first_look(library, reachable) -> None:
    far = replace(reachable, blocks=tuple(replace(b, variety=1000.0) for b in reachable.blocks))
    with pytest.raises(OutOfReachError):
        dance(far, library, is_preview=True)


@pytest.mark.usefixtures("listening")
def test_ctrl_c_calls_off_the_dances_of_a_study(library, monkeypatch) -> None:
    begun, stops = [], []

    def waited(goal, within, *, stop, **_):
        begun.append(goal.condition)
        stops.append(stop)
        if len(begun) == 1:
            os.kill(os.getpid(), signal.SIGINT)
        assert stop.wait(10.0)  # a plain search of minutes ends when this is set

    monkeypatch.setattr(DANCING, "require_reachable", lambda *_: None)
    monkeypatch.setattr(DANCING, "_danced", waited)
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    with pytest.raises(KeyboardInterrupt):
        choreograph(PROTOCOL, library)
    assert len(set(map(id, stops))) == 1
    assert len(begun) <= 2
