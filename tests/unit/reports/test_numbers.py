from __future__ import annotations

import math

import pytest

from studykit.reports import numbers


@pytest.mark.parametrize(
    ("p", "words"),
    [
        (0.0009999, "< .001"), (0.001, "= .001"), (0.0496, "= .050"), (0.5, "= .500"), (1.0, "= 1.000"),
        (0.0, "< .001"), (None, "–"), (math.nan, "–"),
    ],
)  # fmt: skip
def test_p_values_are_written_as_journals_want_them(p: float | None, words: str) -> None:
    assert numbers.p_value(p) == words


def test_numbers_keep_their_decimals_and_lose_the_sign_of_nothing() -> None:
    assert numbers.number(2.0, 2) == "2.00"
    assert numbers.number(-0.0001, 2) == "0.00"
    assert numbers.number(-1.25, 1) == "−1.2"
    assert numbers.percent(0.0256, 2) == "2.56 %"
    assert numbers.percent(None) == "–"


def test_what_cannot_exceed_one_has_no_zero_before_the_point() -> None:
    assert numbers.bounded(0.05) == ".05"
    assert numbers.bounded(-0.883) == "−.88"
    assert numbers.bounded(0.999) == "1.00"
    assert numbers.interval((0.0, 1.0)) == "[.00, 1.00]"
    assert numbers.interval(None) == "–"


def test_decimals_follow_the_spread() -> None:
    assert [numbers.decimals_for(s) for s in (0.0, 120.0, 12.0, 1.2, 0.0123, math.nan)] == [2, 0, 0, 1, 3, 2]
