"""Each cost term by numbers worked out by hand, and their sum."""

from __future__ import annotations

from dataclasses import replace
from math import exp, hypot, inf, log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studykit.choreography.cost.block import BlockCost
from studykit.choreography.cost.mask import mask_tolerance, spared_energies
from studykit.choreography.cost.term import gaussian, together
from studykit.choreography.cost.total import TotalCost
from studykit.choreography.cost.transition import TransitionCost
from studykit.choreography.measures import Measures, mean_variety
from studykit.motion.joint_mask import JointMask, spare
from studykit.motion.skeleton import JOINT_NAMES


def measures(*, displacements_m=(0.03, 0.04), **blocks) -> Measures:
    """Give a dance of 32 s in one block, or what else is said of its blocks."""
    said = {"duration": (32.0,), "linear": (1.2,), "rotational": (0.5,), "variety": (100.0,)} | blocks
    counts = [round(duration_s / 4.0) for duration_s in said["duration"]]
    return Measures(
        segments=tuple(tuple(range(count)) for count in counts),
        blocks=said,
        displacements_m=displacements_m,
    )


def one(name: str, target: float, tolerance: float, **how) -> BlockCost:
    return BlockCost(name=name, targets=(target,), tolerances=(tolerance,), **how)


DURATION = one("duration", 32.0, 1.0)
MEAN = TransitionCost(tolerance_m=0.05)
PRINTED = TransitionCost(tolerance_m=0.05, form="printed")
VARIETY = one("variety", 110.0, 5.0)
DEVIATIONS = st.lists(st.floats(-5.0, 5.0), min_size=1, max_size=6)


@pytest.mark.parametrize(
    ("term", "changes", "expected"),
    [
        # Eq. 2
        (DURATION, {}, 0.0),
        (DURATION, {"duration": (33.0,)}, 1.0 - exp(-0.5)),
        (DURATION, {"duration": (28.0,)}, 1.0 - exp(-8.0)),
        # Eq. 4, as printed: one cost of 0.0009 + 0.0016 m2 over the number of joins
        (PRINTED, {}, (1.0 - exp(-0.0025 / 0.005)) / 2.0),
        (PRINTED, {"displacements_m": (0.05,)}, 1.0 - exp(-0.5)),
        (PRINTED, {"displacements_m": (9.0,) * 7}, 1.0 / 7.0),
        # ... and as a mean of one cost a join
        (MEAN, {}, 1.0 - (exp(-0.18) + exp(-0.32)) / 2.0),
        (MEAN, {"displacements_m": (9.0,) * 7}, 1.0),
        (MEAN, {"displacements_m": ()}, 0.0),
        (PRINTED, {"displacements_m": ()}, 0.0),
        # Eq. 6
        (VARIETY, {}, 1.0 - exp(-2.0)),
        (VARIETY, {"variety": (110.0,)}, 0.0),
        # Eq. 9 and 12, as printed and on the logarithm
        (one("linear", 1.0, 0.4), {}, 1.0 - exp(-0.125)),
        (one("rotational", 1.0, 0.25), {}, 1.0 - exp(-2.0)),
        (one("linear", 1.0, 0.1, scale="log"), {}, 1.0 - exp(-50.0 * log(1.2) ** 2)),
        (one("rotational", 1.0, 0.1, scale="log"), {}, 1.0 - exp(-50.0 * log(2.0) ** 2)),
        (one("linear", 1.2, 0.1, scale="log"), {}, 0.0),
        (one("linear", 1.0, 0.1, scale="log"), {"linear": (0.0,)}, 1.0),
    ],
)
def test_terms_by_hand(term, changes, expected) -> None:
    assert term.cost(measures(**changes)) == pytest.approx(expected, rel=1e-12, abs=1e-15)


# Two blocks, one and two tolerances off: 1 and 2 J per kg where 3 and 6 were asked with 2 and 2.
TWO_OFF = {"duration": (16.0, 16.0), "rotational": (1.0, 2.0), "linear": (1.0, 1.0), "variety": (9.0, 9.0)}


@pytest.mark.parametrize(
    ("form", "expected"),
    [
        # Eq. 14 as printed: one Gaussian of the sum of squares, 1 + 4
        ("printed", 1.0 - exp(-0.5 * (1.0 + 4.0))),
        # ... and the mean of a Gaussian a block
        ("mean_of_costs", 1.0 - (exp(-0.5) + exp(-2.0)) / 2.0),
    ],
)
def test_goals_in_time_by_hand(form, expected) -> None:
    term = BlockCost(name="rotational", targets=(3.0, 6.0), tolerances=(2.0, 2.0), form=form)
    assert term.cost(measures(**TWO_OFF)) == pytest.approx(expected, rel=1e-12)
    # Wrong: one target for the whole dance sees that 3 is not 9, but not where.
    whole = one("rotational", 9.0, 2.0, form=form)
    assert whole.cost(measures(rotational=(3.0,))) != pytest.approx(expected, rel=0.01)


def test_every_block_that_is_mended_counts_as_a_mean_but_not_as_printed() -> None:
    # Both of two blocks are hopeless; then one is exactly right.
    both, mended = (measures(**(TWO_OFF | {"linear": values})) for values in ((90.0, 90.0), (1.0, 90.0)))
    mean, printed = (
        BlockCost(name="linear", targets=(1.0, 1.0), tolerances=(0.1, 0.1), form=form)
        for form in ("mean_of_costs", "printed")
    )
    assert (mean.cost(both), mean.cost(mended)) == (1.0, 0.5)
    assert printed.cost(both) == printed.cost(mended) == 1.0


@given(deviations=DEVIATIONS)
def test_costs_lie_between_0_and_1_and_do_not_look_at_the_order(deviations) -> None:
    for form in ("mean_of_costs", "printed"):
        cost = together(deviations, form)
        assert 0.0 <= cost <= 1.0
        assert together(deviations[::-1], form) == pytest.approx(cost, rel=1e-12, abs=1e-300)
        assert together([*deviations, 9.0], form) >= cost * len(deviations) / (len(deviations) + 1)
    # 1 - exp(-x / 2) of a sum is at least that of each summand, so the printed form is the sterner one.
    assert together(deviations, "printed") >= together(deviations, "mean_of_costs") * (1.0 - 1e-12)
    assert together(deviations, "printed") == pytest.approx(gaussian(hypot(*deviations), 1.0))


@given(deviation=st.floats(-30.0, 30.0), tolerance=st.floats(0.1, 10.0))
def test_with_one_block_both_forms_are_the_same(deviation, tolerance) -> None:
    mean, printed = (
        one("variety", 100.0 - deviation, tolerance, form=form).cost(measures())
        for form in ("mean_of_costs", "printed")
    )
    assert mean == pytest.approx(printed, rel=1e-12, abs=1e-300)


@pytest.mark.parametrize("term", [DURATION, MEAN, PRINTED, VARIETY])
def test_a_wide_tolerance_forgives_more(term) -> None:
    off = measures(duration=(36.0,))
    assert term.cost(off, width=6.0) < term.cost(off)
    assert term.cost(off, width=1e6) == pytest.approx(0.0, abs=1e-9)
    # Twice the width is twice the tolerance.
    wider = (
        replace(term, tolerance_m=0.1)
        if isinstance(term, TransitionCost)
        else replace(term, tolerances=(2.0 * term.tolerances[0],))
    )
    assert term.cost(off, width=2.0) == pytest.approx(wider.cost(off), rel=1e-12)


def test_the_printed_transition_cost_falls_when_a_join_is_added() -> None:
    # Why it is not the form in use.
    bad, worse = (measures(displacements_m=(0.5,) * joins) for joins in (5, 6))
    assert PRINTED.cost(worse) < PRINTED.cost(bad)
    assert MEAN.cost(worse) == MEAN.cost(bad)


def test_half_and_twice_the_energy_are_equally_wrong_on_the_logarithm() -> None:
    half, twice = measures(linear=(0.6,)), measures(linear=(2.4,))
    logarithmic, absolute = one("linear", 1.2, 0.5, scale="log"), one("linear", 1.2, 0.5)
    assert logarithmic.cost(half) == pytest.approx(logarithmic.cost(twice))
    assert absolute.cost(half) < absolute.cost(twice)


def test_the_total_is_the_weighted_sum_and_keeps_the_terms() -> None:
    total = TotalCost(((DURATION, 2.0), (MEAN, 0.0), (VARIETY, 0.5)))
    off = measures(duration=(33.0,))
    assert total.cost(off) == pytest.approx(2.0 * (1.0 - exp(-0.5)) + 0.5 * (1.0 - exp(-2.0)))
    assert total.terms(off) == pytest.approx(
        {
            "duration": 1.0 - exp(-0.5),
            "transition": MEAN.cost(off),  # switched off, and still told
            "variety": 1.0 - exp(-2.0),
        }
    )
    assert total.weights == {"duration": 2.0, "transition": 0.0, "variety": 0.5}
    assert total.cost(off, width=2.0) < total.cost(off)


def test_the_variety_of_a_dance_is_that_within_its_blocks() -> None:
    # A block of a single segment has nothing to differ from; a longer one counts for more.
    whole = measures(duration=(8.0, 4.0, 24.0), variety=(40.0, 0.0, 80.0))
    assert whole.variety == pytest.approx((2 * 40.0 + 6 * 80.0) / 8)
    assert mean_variety((0.0, 0.0), (1, 1)) == 0.0
    summed = measures(**TWO_OFF)
    assert (summed.duration_s, summed.linear_energy, summed.rotational_energy) == (32.0, 2.0, 3.0)


def test_what_spared_joints_do_is_what_eq_11_leaves_out(made_library) -> None:
    library = made_library(9)
    weights = np.linspace(0.0, 1.0, 24)
    mask = JointMask(weights=weights)
    left_in = library.rotational_energies @ weights  # Eq. 11
    spared = spared_energies(library, mask)
    assert left_in + spared == pytest.approx(library.rotational_energies.sum(axis=1))
    assert mask_tolerance(library, mask) == pytest.approx(np.median(spared))
    elbow = [JOINT_NAMES.index(f"right_{name}") for name in ("elbow", "wrist", "hand")]
    assert spared_energies(library, spare("right_elbow")) == pytest.approx(
        library.rotational_energies[:, elbow].sum(axis=1)
    )


def test_nothing_spared_costs_nothing(made_library) -> None:
    library = made_library(9)
    # Only limits: no joint has a weight below 1, and the tolerance must still be no zero to divide by.
    limits = JointMask(speed_limits_rad_s=np.where(np.arange(24) == 19, 3.0, inf))
    assert not spared_energies(library, limits).any()
    assert mask_tolerance(library, limits) > 0.0
