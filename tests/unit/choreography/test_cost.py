"""Each cost term by numbers worked out by hand, and their sum."""

from __future__ import annotations

from math import exp, log

import pytest

from studykit.choreography.cost.duration import DurationCost
from studykit.choreography.cost.intensity import IntensityCost
from studykit.choreography.cost.total import TotalCost
from studykit.choreography.cost.transition import TransitionCost
from studykit.choreography.cost.variety import VarietyCost
from studykit.choreography.measures import Measures


def measures(**changes) -> Measures:
    values = {
        "duration_s": 32.0,
        "linear_energy": 1.2,
        "rotational_energy": 0.5,
        "variety": 100.0,
        "displacements_m": (0.03, 0.04),
    }
    return Measures(**(values | changes))


DURATION = DurationCost(target_s=32.0, tolerance_s=1.0)
MEAN = TransitionCost(tolerance_m=0.05)
PRINTED = TransitionCost(tolerance_m=0.05, form="printed")
VARIETY = VarietyCost(target=110.0, tolerance=5.0)


@pytest.mark.parametrize(
    ("term", "changes", "expected"),
    [
        # Eq. 2
        (DURATION, {}, 0.0),
        (DURATION, {"duration_s": 33.0}, 1.0 - exp(-0.5)),
        (DURATION, {"duration_s": 28.0}, 1.0 - exp(-8.0)),
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
        (VARIETY, {"variety": 110.0}, 0.0),
        # Eq. 9 and 12, as printed and on the logarithm
        (IntensityCost(name="linear", target=1.0, tolerance=0.4, scale="absolute"), {}, 1.0 - exp(-0.125)),
        (IntensityCost(name="rotational", target=1.0, tolerance=0.25, scale="absolute"), {}, 1.0 - exp(-2.0)),
        (IntensityCost(name="linear", target=1.0, tolerance=0.1), {}, 1.0 - exp(-50.0 * log(1.2) ** 2)),
        (IntensityCost(name="rotational", target=1.0, tolerance=0.1), {}, 1.0 - exp(-50.0 * log(2.0) ** 2)),
        (IntensityCost(name="linear", target=1.2, tolerance=0.1), {}, 0.0),
        (IntensityCost(name="linear", target=1.0, tolerance=0.1), {"linear_energy": 0.0}, 1.0),
    ],
)
def test_terms_by_hand(term, changes, expected) -> None:
    assert term.cost(measures(**changes)) == pytest.approx(expected, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("term", [DURATION, MEAN, PRINTED, VARIETY])
def test_a_wide_tolerance_forgives_more(term) -> None:
    off = measures(duration_s=36.0)
    assert term.cost(off, width=6.0) < term.cost(off)
    assert term.cost(off, width=1e6) == pytest.approx(0.0, abs=1e-9)


def test_the_printed_transition_cost_falls_when_a_join_is_added() -> None:
    # Why it is not the form in use.
    bad, worse = (measures(displacements_m=(0.5,) * joins) for joins in (5, 6))
    assert PRINTED.cost(worse) < PRINTED.cost(bad)
    assert MEAN.cost(worse) == MEAN.cost(bad)


def test_half_and_twice_the_energy_are_equally_wrong_on_the_logarithm() -> None:
    term = IntensityCost(name="linear", target=1.2, tolerance=0.5)
    assert term.cost(measures(linear_energy=0.6)) == pytest.approx(term.cost(measures(linear_energy=2.4)))


def test_the_total_is_the_weighted_sum_and_keeps_the_terms() -> None:
    total = TotalCost(((DURATION, 2.0), (MEAN, 0.0), (VARIETY, 0.5)))
    off = measures(duration_s=33.0)
    assert total.cost(off) == pytest.approx(2.0 * (1.0 - exp(-0.5)) + 0.5 * (1.0 - exp(-2.0)))
    assert total.terms(off) == pytest.approx(
        {
            "duration": 1.0 - exp(-0.5),
            "transition": MEAN.cost(off),  # switched off, and still reported
            "variety": 1.0 - exp(-2.0),
        }
    )
    assert total.cost(off, width=2.0) < total.cost(off)
