"""The words of a protocol become numbers on a library."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studykit.choreography.goal import goal, goals
from studykit.choreography.measures import Measures
from studykit.core.errors import InputError
from studykit.io.protocol_file import read_protocol
from studykit.protocol.condition import Condition

PROTOCOL = Path(__file__).parents[3] / "protocols" / "dance-2x2x2.toml"


@pytest.fixture(scope="module")
def protocol():
    return read_protocol(PROTOCOL)


@pytest.fixture(scope="module")
def library(made_library):
    return made_library(12)


def changed(protocol, **values):
    return protocol.model_copy(update={"dance": protocol.dance.model_copy(update=values)})


def test_targets_are_percentiles_and_shares_of_the_library(protocol, library) -> None:
    wanted, measured = goals(protocol, library), library.calibration
    assert list(wanted) == list(protocol.order.labels)
    for label, one in wanted.items():
        percentile = 25.0 if "light" in label else 75.0
        assert one.linear_energy == pytest.approx(np.percentile(measured.chain_linear_energies, percentile))
        assert one.rotational_energy == pytest.approx(
            np.percentile(measured.chain_rotational_energies, percentile)
        )
        assert one.variety == pytest.approx((0.55 if "easy" in label else 0.94) * 150.0)
        assert one.variety_tolerance == pytest.approx(0.1 * (0.94 - 0.55) * 150.0)
        assert one.linear_tolerance == one.rotational_tolerance == 0.1
        assert one.transition_tolerance_m == pytest.approx(np.percentile(measured.join_displacements, 3.0))
        assert one.weights["transition"] == (1.0 if label.endswith("on") else 0.0)
        assert one.segments == 8


def test_a_transition_switched_off_costs_nothing_and_is_still_told(protocol, library) -> None:
    jumpy = Measures(
        duration_s=32.0, linear_energy=4.0, rotational_energy=2.0, variety=141.0, displacements_m=(5.0,) * 7
    )
    smooth = replace(jumpy, displacements_m=(0.0,) * 7)
    wanted = goals(protocol, library)
    on, off = (wanted[f"light-hard-{switch}"].objective() for switch in ("on", "off"))
    assert off.cost(jumpy) == off.cost(smooth)
    assert on.cost(jumpy) - on.cost(smooth) == pytest.approx(1.0)
    assert off.terms(jumpy)["transition"] == pytest.approx(1.0)
    assert set(on.terms(jumpy)) == {"duration", "transition", "variety", "linear", "rotational"}


def test_a_dance_twice_as_long_asks_for_twice_the_energy(protocol, library) -> None:
    condition = Condition.parse("intense-easy-on")
    short, long = (goal(changed(protocol, duration_s=s).dance, condition, library) for s in (32.0, 64.0))
    assert long.linear_energy == pytest.approx(2.0 * short.linear_energy)
    assert long.rotational_energy == pytest.approx(2.0 * short.rotational_energy)
    assert long.variety == short.variety
    assert long.segments == 16


def test_easy_dances_repeat_as_an_urn_does_and_hard_ones_never(protocol, library) -> None:
    easy, hard = (
        goal(protocol.dance, Condition.parse(f"light-{level}-on"), library).novelty
        for level in ("easy", "hard")
    )
    # Two segments of an urn of concentration c differ with probability c / (1 + c).
    assert easy is not None
    assert easy / (1.0 + easy) == pytest.approx(0.55)
    assert hard is None


def test_the_paper_s_preset_has_the_printed_numbers(protocol, library) -> None:
    wanted = goals(changed(protocol, preset="paper"), library)
    light, intense = wanted["light-easy-on"], wanted["intense-hard-off"]
    assert light.linear_energy * 73.5 == pytest.approx(56.5)
    assert light.rotational_energy * 73.5 == pytest.approx(31.8)
    assert intense.linear_energy * 73.5 == pytest.approx(147.2)
    assert intense.rotational_energy * 73.5 == pytest.approx(106.5)
    assert light.linear_tolerance * 73.5 == pytest.approx(88.4)
    assert light.rotational_tolerance * 73.5 == pytest.approx(48.0)
    assert light.transition_tolerance_m == 0.03
    assert light.novelty == math.inf
    preset = light.preset
    assert (preset.variety, preset.transition, preset.intensity) == ("cosine", "printed", "absolute")
    assert (preset.moves, preset.acceptance) == ("at_end", "metropolis")
    assert light.variety == pytest.approx(0.195, abs=5e-4)


@pytest.mark.parametrize("duration_s", [0.0, 30.0, 33.9, math.nan, math.inf])
def test_a_duration_that_no_segments_fill_is_refused(protocol, library, duration_s) -> None:
    plan = changed(protocol, duration_s=duration_s).dance
    with pytest.raises(InputError, match=r"^duration: .* is not a multiple of 4 s; ask for \d+ s\.$"):
        goal(plan, Condition.parse("light-easy-on"), library)


def test_what_is_missed_is_named_by_how_much(protocol, library) -> None:
    wanted = goals(protocol, library)["light-easy-on"]
    hit = Measures(
        duration_s=32.0,
        linear_energy=1.049 * wanted.linear_energy,
        rotational_energy=0.951 * wanted.rotational_energy,
        variety=wanted.variety + 0.99 * wanted.variety_tolerance,
        displacements_m=(9.0,) * 7,
    )
    assert wanted.misses(hit) == {}
    missed = Measures(
        duration_s=28.0,
        linear_energy=1.06 * wanted.linear_energy,
        rotational_energy=0.94 * wanted.rotational_energy,
        variety=wanted.variety - 1.01 * wanted.variety_tolerance,
        displacements_m=(),
    )
    assert wanted.misses(missed) == pytest.approx(
        {"duration": 0.125, "linear energy": 0.06, "rotational energy": 0.06, "variety": 0.0716}, abs=1e-3
    )


def test_what_has_no_weight_is_not_asked_for(protocol, library) -> None:
    weights = protocol.dance.weights.model_copy(update={"variety": 0.0, "linear": 0.0})
    wanted = goals(changed(protocol, weights=weights), library)["light-easy-on"]
    off = Measures(
        duration_s=32.0,
        linear_energy=1.0,
        rotational_energy=wanted.rotational_energy,
        variety=0.0,
        displacements_m=(),
    )
    assert wanted.misses(off) == {}
    # One segment alone has nothing to differ from.
    alone = goals(changed(protocol, duration_s=4.0), library)["light-easy-on"]
    assert alone.weights["variety"] == 0.0
