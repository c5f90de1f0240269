"""The words of a protocol become numbers on a library."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studykit.choreography.measures import Measures
from studykit.choreography.rjmcmc.repertoire import Repertoire
from studykit.choreography.schedule import BlockPlan, hiit
from studykit.choreography.targets import goal, goals, limited, scheduled
from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_value
from studykit.io.protocol_file import read_protocol
from studykit.motion.joint_mask import JointMask, spare
from studykit.protocol.condition import Condition

PROTOCOL = Path(__file__).parents[3] / "protocols" / "dance-2x2x2.toml"
SPARE = """
[dance.spare]
joints = ["right_elbow"]
weight = 0.25
speed_percentile = 40.0
cost_weight = 0.7
"""
ELBOW = ("right_elbow", "right_wrist", "right_hand")


@pytest.fixture(scope="module")
def protocol():
    return read_protocol(PROTOCOL)


@pytest.fixture(scope="module")
def sparing(tmp_path_factory):
    """Give the same protocol with the right elbow spared, read from a file."""
    path = tmp_path_factory.mktemp("protocol") / "sparing.toml"
    text = PROTOCOL.read_text(encoding="utf-8")
    path.write_text(text.replace("[session]", f"{SPARE.strip()}\n\n[session]"), encoding="utf-8")
    return read_protocol(path)


@pytest.fixture(scope="module")
def library(made_library):
    return made_library(12)


def changed(protocol, **values):
    return protocol.model_copy(update={"dance": protocol.dance.model_copy(update=values)})


def a_dance(*, displacements_m=(9.0,) * 7, **blocks) -> Measures:
    said = {name: values if isinstance(values, tuple) else (values,) for name, values in blocks.items()}
    counts = [round(duration_s / 4.0) for duration_s in said["duration"]]
    return Measures(
        segments=tuple(tuple(range(count)) for count in counts), blocks=said, displacements_m=displacements_m
    )


def test_targets_are_percentiles_and_shares_of_the_library(protocol, library) -> None:
    wanted, measured = goals(protocol, library), library.calibration
    assert list(wanted) == list(protocol.order.labels)
    for label, one in wanted.items():
        percentile = 25.0 if "light" in label else 75.0
        (block,) = one.blocks
        assert one.condition == label
        assert block.linear_energy == pytest.approx(np.percentile(measured.chain_linear_energies, percentile))
        assert block.rotational_energy == pytest.approx(
            np.percentile(measured.chain_rotational_energies, percentile)
        )
        assert block.variety == pytest.approx((0.55 if "easy" in label else 0.94) * 150.0)
        assert one.measures == block.measures
        assert one.variety_tolerance == pytest.approx(0.1 * (0.94 - 0.55) * 150.0)
        assert one.linear_tolerance == one.rotational_tolerance == 0.1
        assert one.transition_tolerance_m == pytest.approx(np.percentile(measured.join_displacements, 3.0))
        assert one.weights["transition"] == (1.0 if label.endswith("on") else 0.0)
        assert (one.segments, one.duration_s, one.mask, one.spared) == (8, 32.0, None, "")


def test_raters_go_before_percentiles_and_shares(protocol, library) -> None:
    rated = {
        "linear_energy": {"light": 1.0, "intense": 2.0},
        "rotational_energy": {"light": 0.5, "intense": 0.9},
        "variety": {"easy": 100.0, "hard": 140.0},
    }
    other = replace(library, calibration=replace(library.calibration, rated=rated))
    one = goals(protocol, other)["intense-easy-on"]
    aim = one.measures
    assert (aim.linear_energy, aim.rotational_energy, aim.variety) == (2.0, 0.9, 100.0)
    assert one.variety_tolerance == pytest.approx(0.1 * 40.0)
    assert one.targets_from == "raters"
    assert goals(protocol, library)["intense-easy-on"].targets_from == "percentiles"
    # Whatever raters say, the printed constants are the paper's; and a percentile is a percentile.
    assert goals(changed(protocol, preset="paper"), other)["light-easy-on"].targets_from == "paper"
    numbers = scheduled(protocol.dance, (BlockPlan(intensity=60.0, variety=0.8),), other, name="numbers-on")
    assert numbers.measures.linear_energy == library.calibration.energy_targets(60.0)[0]
    assert numbers.measures.variety == pytest.approx(0.8 * 150.0)


def test_a_transition_switched_off_costs_nothing_and_is_still_told(protocol, library) -> None:
    jumpy = a_dance(duration=32.0, linear=4.0, rotational=2.0, variety=141.0, displacements_m=(5.0,) * 7)
    smooth = replace(jumpy, displacements_m=(0.0,) * 7)
    wanted = goals(protocol, library)
    on, off = (wanted[f"light-hard-{switch}"].objective(library) for switch in ("on", "off"))
    assert off.cost(jumpy) == off.cost(smooth)
    assert on.cost(jumpy) - on.cost(smooth) == pytest.approx(1.0)
    assert off.terms(jumpy)["transition"] == pytest.approx(1.0)
    assert set(on.terms(jumpy)) == {"duration", "transition", "variety", "linear", "rotational"}
    assert on.weights == dict.fromkeys(on.terms(jumpy), 1.0)
    assert off.weights == on.weights | {"transition": 0.0}


def test_a_dance_that_is_all_that_is_asked_costs_nothing(protocol, library) -> None:
    for plan in (protocol.dance, changed(protocol, preset="paper").dance):
        blocks = (BlockPlan(duration_s=16.0), BlockPlan(duration_s=24.0, intensity="intense", variety="hard"))
        one = scheduled(plan, blocks, library, name="two-on")
        exact = a_dance(
            duration=tuple(block.duration_s for block in one.blocks),
            linear=tuple(block.linear_energy for block in one.blocks),
            rotational=tuple(block.rotational_energy for block in one.blocks),
            variety=tuple(block.variety for block in one.blocks),
            displacements_m=(0.0,) * 9,
        )
        assert one.objective(library).cost(exact) == pytest.approx(0.0, abs=1e-15)
        assert one.misses(exact) == {}
        # Wrong: the blocks the other way round.
        swapped = replace(exact, blocks=exact.blocks | {"linear": exact.blocks["linear"][::-1]})
        assert one.objective(library).cost(swapped) > 0.01
        assert set(one.misses(swapped)) == {"linear energy of block 1", "linear energy of block 2"}


def test_a_dance_twice_as_long_asks_for_twice_the_energy(protocol, library) -> None:
    condition = Condition.parse("intense-easy-on")
    short, long = (goal(changed(protocol, duration_s=s).dance, condition, library) for s in (32.0, 64.0))
    assert long.measures.linear_energy == pytest.approx(2.0 * short.measures.linear_energy)
    assert long.measures.rotational_energy == pytest.approx(2.0 * short.measures.rotational_energy)
    assert long.measures.variety == short.measures.variety
    assert long.segments == 16


def test_printed_tolerances_of_energy_belong_to_32_seconds(protocol, library) -> None:
    # A share of the target needs no scale; J per kg do.
    plans = (protocol.dance, changed(protocol, preset="paper").dance)
    for plan, scale in zip(plans, (1.0, 0.5), strict=True):
        one = scheduled(plan, (BlockPlan(duration_s=16.0), BlockPlan()), library, name="two-on")
        terms = {term.name: term for term, _ in one.objective(library).weighted}
        for name in ("linear", "rotational"):
            half, whole = terms[name].tolerances
            assert half == pytest.approx(scale * whole)
        assert terms["duration"].tolerances == (1.0, 1.0)
        assert len(set(terms["variety"].tolerances)) == 1


def test_easy_dances_repeat_as_an_urn_does_and_hard_ones_never(protocol, library) -> None:
    easy, hard = (
        goal(protocol.dance, Condition.parse(f"light-{level}-on"), library).blocks[0].novelty
        for level in ("easy", "hard")
    )
    # Two segments of an urn of concentration c differ with probability c / (1 + c).
    assert easy is not None
    assert easy / (1.0 + easy) == pytest.approx(0.55)
    assert hard is None


def test_the_paper_s_preset_has_the_printed_numbers(protocol, library) -> None:
    wanted = goals(changed(protocol, preset="paper"), library)
    light, intense = wanted["light-easy-on"], wanted["intense-hard-off"]
    assert light.measures.linear_energy * 73.5 == pytest.approx(56.5)
    assert light.measures.rotational_energy * 73.5 == pytest.approx(31.8)
    assert intense.measures.linear_energy * 73.5 == pytest.approx(147.2)
    assert intense.measures.rotational_energy * 73.5 == pytest.approx(106.5)
    assert light.linear_tolerance * 73.5 == pytest.approx(88.4)
    assert light.rotational_tolerance * 73.5 == pytest.approx(48.0)
    assert light.transition_tolerance_m == 0.03
    assert light.blocks[0].novelty == math.inf
    preset = light.preset
    assert (preset.variety, preset.form, preset.intensity) == ("cosine", "printed", "absolute")
    assert (preset.moves, preset.acceptance, preset.is_reached) == ("at_end", "metropolis", False)
    assert light.measures.variety == pytest.approx(0.195, abs=5e-4)


@pytest.mark.parametrize("duration_s", [0.0, -4.0, 30.0, 33.9, math.nan, math.inf])
def test_a_duration_that_no_segments_fill_is_refused(protocol, library, duration_s) -> None:
    plan = changed(protocol, duration_s=duration_s).dance
    with pytest.raises(InputError, match=r"^duration: .* is not a multiple of 4 s; ask for \d+ s\.$"):
        goal(plan, Condition.parse("light-easy-on"), library)


@pytest.mark.parametrize(
    ("block", "sentence"),
    [
        ({"intensity": "wild"}, r'^intensity: there is no "wild"; choose light or intense\.$'),
        ({"variety": "weird"}, r'^variety: there is no "weird"; choose easy or hard\.$'),
        ({"intensity": 100.5}, r"^intensity: 100.5 is no percentile; say light, intense, or 0 to 100\.$"),
        ({"intensity": -1.0}, r"^intensity: -1 is no percentile; .*\.$"),
        ({"intensity": math.nan}, r"^intensity: nan is no percentile; .*\.$"),
        (
            {"variety": 0.0},
            r"^variety: 0 is no share of .*; say easy, hard, or a number above 0 and up to 2\.$",
        ),
        ({"variety": 2.1}, r"^variety: 2.1 is no share of .*\.$"),
        ({"variety": math.nan}, r"^variety: nan is no share of .*\.$"),
        ({"duration_s": 6.0}, r"^duration: 6 s is not a multiple of 4 s; ask for 8 s\.$"),
    ],
)
def test_levels_of_a_block_that_mean_nothing_are_refused(protocol, library, block, sentence) -> None:
    with pytest.raises(InputError, match=sentence):
        scheduled(protocol.dance, (BlockPlan(), BlockPlan(**block)), library, name="two-on")


def test_the_printed_formulas_know_two_varieties(protocol, library) -> None:
    plan = changed(protocol, preset="paper").dance
    with pytest.raises(InputError, match=r"^variety: the printed formulas know two levels .*\.$"):
        scheduled(plan, (BlockPlan(variety=0.7),), library, name="one-on")
    # A percentile is one of the library at hand; the constants are for the words.
    number = scheduled(plan, (BlockPlan(intensity=50.0),), library, name="one-on")
    assert number.measures.linear_energy == library.calibration.energy_targets(50.0)[0]


def test_a_schedule_without_a_block_is_refused(protocol, library) -> None:
    with pytest.raises(InputError, match=r"^schedule: there is no block; give one or more\.$"):
        scheduled(protocol.dance, (), library, name="none-on")


def test_what_is_missed_is_named_by_how_much(protocol, library) -> None:
    wanted = goals(protocol, library)["light-easy-on"]
    aim = wanted.measures
    hit = a_dance(
        duration=32.0,
        linear=1.049 * aim.linear_energy,
        rotational=0.951 * aim.rotational_energy,
        variety=aim.variety + 0.99 * wanted.variety_tolerance,
    )
    assert wanted.misses(hit) == {}
    assert set(wanted.misses(hit, share=0.4)) == {"linear energy", "rotational energy", "variety"}
    missed = a_dance(
        duration=28.0,
        linear=1.06 * aim.linear_energy,
        rotational=0.94 * aim.rotational_energy,
        variety=aim.variety - 1.01 * wanted.variety_tolerance,
    )
    assert wanted.misses(missed) == pytest.approx(
        {"duration": 0.125, "linear energy": 0.06, "rotational energy": 0.06, "variety": 0.0716}, abs=1e-3
    )


def test_what_has_no_weight_is_not_asked_for(protocol, library) -> None:
    weights = protocol.dance.weights.model_copy(update={"variety": 0.0, "linear": 0.0})
    wanted = goals(changed(protocol, weights=weights), library)["light-easy-on"]
    off = a_dance(duration=32.0, linear=1.0, rotational=wanted.measures.rotational_energy, variety=0.0)
    assert wanted.misses(off) == {}
    # One segment alone has nothing to differ from.
    alone = goals(changed(protocol, duration_s=4.0), library)["light-easy-on"]
    assert (alone.weights["variety"], alone.measures.variety) == (0.0, 0.0)


def test_the_digest_of_a_protocol_that_spares_nothing_is_that_of_before(protocol, sparing) -> None:
    values = protocol.model_dump(mode="json", exclude_none=True)
    assert "spare" not in values["dance"]
    assert protocol.sha256 == sha256_of_value(values)
    assert sparing.sha256 != protocol.sha256
    assert changed(sparing, spare=None).sha256 == protocol.sha256


def test_a_protocol_that_spares_an_elbow_spares_it_in_every_goal(sparing, library) -> None:
    assert sparing.dance.spare.model_dump(mode="json") == tomllib.loads(SPARE)["dance"]["spare"]
    wanted = goals(sparing, library)
    assert list(wanted) == list(sparing.order.labels)
    for one in wanted.values():
        mask = one.mask
        assert mask is not None
        assert (one.spared, mask.spared) == (", ".join(ELBOW), ELBOW)
        spared = mask.weights < 1.0
        assert set(mask.weights[spared]) == {0.25}
        assert one.weights["mask"] == 0.7
        assert np.array_equal(np.isfinite(mask.speed_limits_rad_s), spared)
        assert mask.speed_limits_rad_s[spared] == pytest.approx(
            np.percentile(library.peak_speeds[:, spared], 40.0, axis=0)
        )


def test_limits_that_are_said_stay_and_others_come_from_the_library(library) -> None:
    mask = spare(["right_elbow", "right_wrist"], speed_limits_rad_s=[np.inf, 3.0])
    speeds = limited(mask, library, 25.0).speed_limits_rad_s
    assert speeds[21] == speeds[23] == 3.0  # right wrist and hand
    assert speeds[19] == pytest.approx(np.percentile(library.peak_speeds[:, 19], 25.0))
    assert np.isinf(np.delete(speeds, [19, 21, 23])).all()


@pytest.fixture(scope="module")
def flailing(library):
    """Give the library with an elbow that flails in the upper half of its segments, beyond all else."""
    energies = np.array(library.rotational_energies)
    energies[6:, 19] = 5.0
    return replace(library, rotational_energies=energies)


@pytest.mark.parametrize(("preset", "is_free"), [("paper", True), ("studykit", False)])
def test_a_spared_elbow_that_flails_costs_something_but_as_printed(
    protocol, library, flailing, preset, is_free
) -> None:
    # Eq. 11 leaves spared joints out of the energy: nothing then keeps them still.
    mask = spare("right_elbow")
    plan = changed(protocol, preset=preset).dance
    one = scheduled(plan, (BlockPlan(duration_s=16.0),), library, name="one-on", mask=mask)
    rows = (((6, 8, 10, 11),),)
    calm, wild = (
        one.objective(library).cost(Repertoire(on, one.preset, mask=mask).measures(rows[0]))
        for on in (library, flailing)
    )
    assert (calm == pytest.approx(wild, rel=1e-12)) == is_free
    assert calm <= wild
    # Wrong: without a mask the printed cost sees the elbow.
    free = replace(one, mask=None)
    seen = [
        free.objective(library).cost(Repertoire(on, one.preset).measures(rows[0]))
        for on in (library, flailing)
    ]
    assert seen[0] != pytest.approx(seen[1], rel=1e-6)


def test_the_more_a_spared_joint_does_the_more_it_costs(protocol, library) -> None:
    mask = JointMask(weights=np.where(np.arange(24) == 19, 0.0, 1.0))
    one = scheduled(protocol.dance, hiit(rounds=1, block_s=8.0), library, name="two-on", mask=mask)
    (term,) = (term for term, _ in one.objective(library).weighted if term.name == "mask")
    middling = float(np.median(library.rotational_energies[:, 19]))
    assert term.tolerances == pytest.approx((2 * middling, 2 * middling))  # two segments a block
    # Each block does as much as two middling segments: one tolerance off.
    usual = a_dance(duration=(8.0, 8.0), mask=(2 * middling, 2 * middling))
    assert term.cost(usual) == pytest.approx(1.0 - math.exp(-0.5))
    still = a_dance(duration=(8.0, 8.0), mask=(0.0, 0.0))
    assert term.cost(still) == 0.0
