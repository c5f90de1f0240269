"""Whether a goal can be met is known before any dance is searched for."""

from __future__ import annotations

import pickle
import sys
from dataclasses import replace
from itertools import combinations, combinations_with_replacement, product

import numpy as np
import pytest

from studykit.choreography.choreograph import dance
from studykit.choreography.dance_library import distances
from studykit.choreography.goal import ENERGY_HIT
from studykit.choreography.reach import OutOfReachError, nearest, require_reachable, variety_range
from studykit.choreography.request import requested
from studykit.choreography.rjmcmc.repertoire import Repertoire
from studykit.choreography.schedule import BlockPlan
from studykit.core.errors import InputError
from studykit.motion.joint_mask import spare

DANCING = sys.modules["studykit.choreography.choreograph"]  # the package gives the function of that name


@pytest.fixture(scope="module")
def library(swinging):
    return swinging(24)


@pytest.fixture(scope="module")
def near(library, within_reach):
    return within_reach(requested(library, duration_s=16.0), library)


def far(goal, **changes):
    return replace(goal, blocks=tuple(replace(block, **changes) for block in goal.blocks))


@pytest.fixture
def no_chain(monkeypatch):
    """Let no dance be searched for."""

    def never(*_, **__):
        raise AssertionError("a search was begun")

    monkeypatch.setattr(DANCING, "search", never)


def test_a_goal_within_reach_is_let_pass(library, near) -> None:
    require_reachable(near, Repertoire(library, near.preset))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"linear_energy": 50.0}, "linear energy"),
        ({"rotational_energy": 1e-3}, "rotational energy"),
        ({"variety": 1000.0}, "variety"),
    ],
)
@pytest.mark.usefixtures("no_chain")
def test_what_no_dance_has_is_refused_before_any_search(library, near, changes, words) -> None:
    with pytest.raises(OutOfReachError) as refusal:
        dance(far(near, **changes), library)
    error = refusal.value
    assert isinstance(error, InputError)
    assert str(error).startswith("made-up, light-easy-on: 24 segments cannot reach this: ")
    assert words in error.problem
    assert "nearest is linear energy" in error.problem
    assert str(error).endswith("ask for that, for a less extreme dance, or add takes.")
    assert "\n" not in str(error)


def test_the_nearest_goal_can_be_danced(library, near) -> None:
    # Three segments' energy in four is possible; the most varied dance that has it is not as varied as asked.
    with pytest.raises(OutOfReachError) as refusal:
        dance(far(near, variety=1000.0), library, seed=4)
    closest = refusal.value.nearest
    assert closest.measures.variety < 400.0
    assert replace(closest, blocks=near.blocks, note="") == near  # all else is as it was
    assert closest.note.startswith("What was asked is out of reach: ")
    for seed in range(3):
        found = dance(closest, library, seed=seed)
        rows = (tuple(segment.id for segment in found.segments),)
        assert not closest.misses(Repertoire(library, near.preset).measures(rows, is_exact=True))
        assert found.note == closest.note


@pytest.mark.parametrize("variety", [0.55, 0.68])
def test_goals_are_let_pass_exactly_when_some_dance_meets_them(library, within_reach, variety) -> None:
    # Four segments in any order: all 17,550 dances are looked at.
    asked = within_reach(requested(library, duration_s=16.0, variety=variety), library)
    known = Repertoire(library, asked.preset)
    dances = np.array(list(combinations_with_replacement(range(24), 4)))
    linear, rotational = (known.values[name][dances].sum(axis=1) for name in ("linear", "rotational"))
    between = distances(library, "euclidean_z").table
    varieties = np.mean([between[dances[:, a], dances[:, b]] for a, b in combinations(range(4), 2)], axis=0)
    verdicts = []
    for factor, tilt in product((0.6, 0.8, 1.0, 1.2, 1.5), (0.85, 1.0, 1.1)):
        (block,) = asked.blocks
        block = replace(
            block,
            linear_energy=factor * block.linear_energy,
            rotational_energy=factor * tilt * block.rotational_energy,
        )
        is_hit = np.abs(linear / block.linear_energy - 1.0) <= ENERGY_HIT
        is_hit &= np.abs(rotational / block.rotational_energy - 1.0) <= ENERGY_HIT
        is_hit &= np.abs(varieties - block.variety) <= asked.variety_tolerance
        one = replace(asked, blocks=(block,))
        verdicts.append((not one.misses(nearest(one, known).measures), bool(is_hit.any())))
    assert all(said == true for said, true in verdicts)
    assert {true for _, true in verdicts} == {True, False}


def test_no_other_dance_is_nearer_in_every_way(library, near) -> None:
    # Two segments: all 576 dances are looked at.
    known = Repertoire(library, near.preset)
    small = far(
        near,
        duration_s=8.0,
        linear_energy=2.5 * near.blocks[0].linear_energy,
        rotational_energy=0.1 * near.blocks[0].rotational_energy,
        variety=90.0,
    )
    names = ("linear", "rotational", "variety")
    (block,) = small.blocks
    targets = np.array([block.linear_energy, block.rotational_energy, block.variety])

    def off(measures) -> np.ndarray:
        return np.abs([measures.blocks[name][0] for name in names] - targets)

    closest = nearest(small, known).measures
    assert closest.duration_s == 8.0
    others = np.array([off(known.measures((pair,))) for pair in product(range(24), repeat=2)])
    assert not np.any(np.all(others < off(closest) * (1.0 - 1e-6), axis=1))
    # Wrong: a dance drawn by chance is beaten in every way by some other.
    chance = off(known.measures(((5, 6),)))
    assert np.any(np.all(others < chance, axis=1))


@pytest.mark.parametrize("factor", [2.0, 20.0, 2000.0])
def test_the_nearest_to_the_impossible_is_the_utmost(library, near, factor) -> None:
    # However far: a cost that is flat out there would settle for anything.
    known = Repertoire(library, near.preset)
    most = 2.0 * known.values["linear"].max()
    wild = replace(
        far(near, duration_s=8.0, linear_energy=factor * float(most)),
        weights=near.weights | {"rotational": 0.0, "variety": 0.0},
    )
    found = nearest(wild, known).measures
    assert found.duration_s == 8.0
    assert found.linear_energy == pytest.approx(most)


def test_the_range_of_variety_holds_what_random_dances_have(library, near) -> None:
    known = Repertoire(library, near.preset)
    low, high = variety_range(near, known)
    rng = np.random.default_rng(1)
    varieties = []
    for _ in range(4000):
        found = known.measures((tuple(rng.integers(24, size=4).tolist()),))
        energies = (found.linear_energy, found.rotational_energy)
        asked = (near.measures.linear_energy, near.measures.rotational_energy)
        if np.allclose(energies, asked, rtol=0.05):
            varieties.append(found.variety)
    assert len(varieties) > 50
    slack = 0.02 * high
    assert low - slack <= min(varieties)
    assert max(varieties) <= high + slack
    assert 0.0 <= low < np.median(varieties) < high
    # Calm dances have fewer segments to choose from.
    calm = variety_range(far(near, linear_energy=0.3, rotational_energy=0.15), known)
    assert calm[1] < high


def test_what_is_out_of_reach_with_joints_spared_says_so(library, within_reach) -> None:
    limit = float(np.quantile(library.peak_speeds[:, 23], 0.4))
    asked = requested(library, duration_s=16.0, spare=spare("right_hand", speed_limits_rad_s=limit))
    lively = far(within_reach(asked, library), linear_energy=9.0)
    with pytest.raises(OutOfReachError, match=r"cannot reach this with right_hand spared: linear energy"):
        dance(lively, library)


@pytest.mark.usefixtures("no_chain")
def test_a_mask_that_leaves_no_segment_or_too_few_is_refused_before_any_search(library, within_reach) -> None:
    still = spare("right_hand", speed_limits_rad_s=1e-4)
    with pytest.raises(InputError, match=r"^made-up: right_hand exceed their limits in every segment"):
        dance(requested(library, spare=still), library)
    limit = float(np.sort(library.peak_speeds[:, 23])[2])
    few = requested(library, variety="hard", spare=spare("right_hand", speed_limits_rad_s=limit))
    sentence = (
        r"^made-up: the library has 3 movements in which right_hand stay below their limits, .* needs 8; add"
    )
    with pytest.raises(InputError, match=sentence):
        dance(few, library)


def test_each_block_out_of_reach_is_named(library, within_reach) -> None:
    plans = (BlockPlan(duration_s=16.0), BlockPlan(duration_s=16.0))
    asked = within_reach(requested(library, schedule=plans), library)
    calm, wild = asked.blocks
    with pytest.raises(OutOfReachError) as refusal:
        dance(replace(asked, blocks=(calm, replace(wild, linear_energy=40.0))), library)
    assert "linear energy of block 2" in refusal.value.problem
    assert "energy of block 1" not in refusal.value.problem
    assert len(refusal.value.nearest.blocks) == 2


def test_a_further_term_does_not_put_a_goal_out_of_reach(library, near) -> None:
    class Impossible:
        name, weight, target, tolerance = "impossible", 1.0, 1e6, 1.0

        def values(self, library):
            return np.zeros(len(library))

    asked = replace(near, terms=(Impossible(),))
    require_reachable(asked, Repertoire(library, near.preset, terms=asked.terms))


def test_the_refusal_comes_back_from_another_process_as_it_was(library, near) -> None:
    with pytest.raises(OutOfReachError) as refusal:
        require_reachable(far(near, variety=1000.0), Repertoire(library, near.preset))
    again = pickle.loads(pickle.dumps(refusal.value))
    assert str(again) == str(refusal.value)
    assert again.nearest.measures == refusal.value.nearest.measures
