"""From goals to dances on a made-up library: what is given, and what is refused."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studykit.choreography.choreograph import choreograph, dance
from studykit.choreography.dance import blended_measures
from studykit.choreography.goal import goal, goals
from studykit.choreography.preset import PAPER, STUDYKIT
from studykit.choreography.rjmcmc.schedule import Schedule
from studykit.core.errors import InputError
from studykit.io.protocol_file import read_protocol
from studykit.motion import energy, kinematics
from studykit.motion.blending import joined
from studykit.protocol.condition import Condition

PROTOCOL = read_protocol(Path(__file__).parents[3] / "protocols" / "dance-2x2x2.toml")
SHORT = Schedule.geometric(iterations=1000, start=0.3, end=0.002, start_width=6.0)


@pytest.fixture(scope="module")
def library(made_library):
    return made_library(16)


@pytest.fixture
def reachable(library):
    """Give a goal that the library reaches quickly."""
    asked = goal(PROTOCOL.dance, Condition.parse("intense-easy-on"), library)
    return replace(
        asked,
        linear_energy=8.0 * library.linear_energies.sum(axis=1).mean(),
        rotational_energy=8.0 * library.rotational_energies.sum(axis=1).mean(),
        weights=asked.weights | {"variety": 0.0},
        preset=replace(STUDYKIT, schedule=SHORT),
    )


def test_a_dance_is_its_segments_joined(library, reachable) -> None:
    found = dance(reachable, library, seed=2)
    rows = [segment.id for segment in found.segments]
    blended = joined([library.motion(row) for row in rows])
    assert np.array_equal(found.motion.rotations, blended.rotations)
    assert [segment.take for segment in found.segments] == [f"take-{row // 2}" for row in rows]
    assert [segment.start_s for segment in found.segments] == [4.0 * (row % 2) for row in rows]
    assert found.is_synthetic
    assert found.distinct_segments == len(set(rows))
    assert found.cost_total == pytest.approx(
        sum(reachable.weights[name] * cost for name, cost in found.cost_terms.items())
    )


def test_a_dance_says_which_segments_are_mirrored_and_who_set_its_targets(library, reachable) -> None:
    sides = library.segments.assign(mirrored=np.arange(16) % 3 == 0)
    rated = {
        "linear_energy": {"light": 1.0, "intense": reachable.linear_energy},
        "rotational_energy": {"light": 0.5, "intense": reachable.rotational_energy},
        "variety": {"easy": 100.0, "hard": 150.0},
    }
    other = replace(library, segments=sides, calibration=replace(library.calibration, rated=rated))
    asked = goal(PROTOCOL.dance, Condition.parse("intense-easy-on"), other)
    assert (asked.linear_energy, asked.variety) == (reachable.linear_energy, 100.0)
    found = dance(replace(asked, preset=replace(STUDYKIT, schedule=SHORT)), other, seed=2)
    assert [segment.mirrored for segment in found.segments] == [s.id % 3 == 0 for s in found.segments]
    assert (found.targets_from, dance(reachable, library, seed=2).targets_from) == ("raters", "percentiles")
    published = PROTOCOL.dance.model_copy(update={"preset": "paper"})
    assert goal(published, Condition.parse("light-easy-on"), other).targets_from == "paper"


def test_what_is_shown_is_measured_joins_included(library) -> None:
    motion = joined([library.motion(0), library.motion(5)])
    shown = blended_measures(motion, 12.0)
    positions = kinematics.centred_positions(motion.skeleton, motion.rotations)
    assert shown.linear_energy == pytest.approx(energy.linear_energy(positions, 30.0).sum())
    assert shown.rotational_energy == pytest.approx(energy.rotational_energy(motion.rotations, 30.0).sum())
    assert (shown.duration_s, shown.variety) == (8.0, 12.0)


def test_the_digest_tells_dances_apart(library, reachable) -> None:
    first, again = dance(reachable, library, seed=2), dance(reachable, library, seed=2)
    other = dance(reachable, library, seed=3)
    assert first.sha256 == again.sha256 != other.sha256
    assert replace(first, library_sha256="1" * 64).sha256 != first.sha256
    assert replace(first, segments=first.segments[::-1]).sha256 != first.sha256


def test_a_library_too_small_for_the_length_is_refused(made_library, reachable) -> None:
    with pytest.raises(InputError, match=r"^made-up: the library has 7 segments, .* needs 8; add takes or"):
        dance(replace(reachable, novelty=None), made_library(7))


def test_goals_out_of_reach_are_refused_by_name(library, reachable) -> None:
    far = replace(reachable, linear_energy=100.0 * reachable.linear_energy)
    message = (
        r"^made-up: 16 segments hold no dance of 32 s for intense-easy-on \(linear energy off by 9\d%\);"
    )
    with pytest.raises(InputError, match=message):
        dance(far, library)


def test_the_paper_s_preset_gives_the_best_it_met(library, reachable) -> None:
    quick = Schedule(temperatures=np.linspace(1.0, 0.0, 11), widths=np.ones(11), stage_iterations=50)
    far = replace(
        reachable,
        linear_energy=100.0 * reachable.linear_energy,
        preset=replace(PAPER, schedule=quick),
    )
    found = dance(far, library, seed=1)
    assert found.preset == "paper"
    assert 6 <= len(found.segments) <= 10
    assert found.achieved.linear_energy < 0.1 * found.asked.linear_energy
    bridged = joined([library.motion(segment.id) for segment in found.segments], blend="bridge")
    assert np.array_equal(found.motion.rotations, bridged.rotations)


def test_one_dance_a_condition_in_the_order_of_the_protocol(library, monkeypatch) -> None:
    made = []
    monkeypatch.setattr(
        # The package gives the function of the same name; the module is meant.
        sys.modules["studykit.choreography.choreograph"],
        "dance",
        lambda wanted, _library, *, seed: made.append((wanted.condition, seed)) or wanted,
    )
    told = []

    def progress(items, *, label, total):
        told.append((label, total))
        return items

    dances = choreograph(PROTOCOL, library, seed=9, progress=progress)
    assert list(dances) == list(PROTOCOL.order.labels) == list(goals(PROTOCOL, library))
    assert made == [(label, 9) for label in PROTOCOL.order.labels]
    assert told == [("Choreographing", 8)]
