"""Seconds at or above 100 ... 170 bpm of real recordings, by the rule written in hr_expected.json."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from studykit.analysis.heart_rate import ZoneTime, held, seconds_at_or_above, zones

Rule = Callable[[np.ndarray, np.ndarray, float, float], ZoneTime]
PEOPLE = tuple(str(number) for number in range(1, 16))


def check(expected: dict[str, Any], times_s: np.ndarray, bpm: np.ndarray, gap_s: float, rule: Rule) -> None:
    assert len(bpm) == expected["n"]
    assert (bpm.min(), bpm.max()) == (expected["hr_min"], expected["hr_max"])
    # The file prints milliseconds.
    for threshold, seconds in expected["seconds_at_or_above"].items():
        found = rule(times_s, bpm, float(threshold), gap_s)
        assert round(found.seconds, 3) == seconds
        assert round(found.counted_s, 3) == expected["counted_s"]


def effort_test(person: str, shared_data: Callable[[str], Path]) -> tuple[Any, np.ndarray, np.ndarray]:
    table = pd.read_csv(shared_data("heart_rate/effort_tests.csv"), dtype={"id": str})
    expected = json.loads(shared_data("heart_rate/hr_expected.json").read_text())["files"]
    rows = table[table["id"] == person]
    return expected["effort_tests.csv"][person], rows["time"].to_numpy(), rows["hr"].to_numpy()


@pytest.mark.parametrize("person", PEOPLE)
def test_zone_seconds_of_the_effort_tests(person: str, shared_data: Callable[[str], Path]) -> None:
    check(*effort_test(person, shared_data), math.inf, seconds_at_or_above)


@pytest.mark.parametrize("person", PEOPLE)
def test_zones_lie_between_the_thresholds_of_the_effort_tests(
    person: str, shared_data: Callable[[str], Path]
) -> None:
    expected, times, bpm = effort_test(person, shared_data)
    above = expected["seconds_at_or_above"]
    found = zones(times, bpm, [float(bound) for bound in above], math.inf)
    seconds = [expected["counted_s"], *above.values(), 0.0]
    assert [round(zone.seconds, 3) for zone in found] == pytest.approx(-np.diff(seconds))


def test_zone_seconds_of_the_chest_strap_at_rest(shared_data: Callable[[str], Path]) -> None:
    table = pd.read_csv(shared_data("heart_rate/h10_rest_hr_rr.csv"))
    readings = table.dropna(subset="hr_bpm")
    expected = json.loads(shared_data("heart_rate/hr_expected.json").read_text())["files"]
    times, bpm = readings["t_s"].to_numpy(), readings["hr_bpm"].to_numpy()
    check(expected["h10_rest_hr_rr.csv"], times, bpm, 10.0, seconds_at_or_above)
    part = held(times, bpm, longest_gap_s=10.0)
    assert part.seconds.sum() == pytest.approx(expected["h10_rest_hr_rr.csv"]["first_to_last_s"], abs=5e-4)
    assert bpm.mean() == pytest.approx(expected["h10_rest_hr_rr.csv"]["hr_mean_of_samples"], abs=5e-4)


def test_a_recording_worked_out_by_hand() -> None:
    # 100 for 5 s, 140 for 2 s, 150 for a silence of 20 s, 160 for 3 s, then the last reading.
    times, bpm = np.array([0.0, 5.0, 7.0, 27.0, 30.0]), np.array([100.0, 140.0, 150.0, 160.0, 90.0])
    assert seconds_at_or_above(times, bpm, 140.0, 10.0) == ZoneTime(seconds=5.0, counted_s=10.0)
    assert seconds_at_or_above(times, bpm, 140.0, math.inf) == ZoneTime(seconds=25.0, counted_s=30.0)


# What follows is wrong on purpose: the check above must notice.


def seconds_by_count(times_s: np.ndarray, bpm: np.ndarray, threshold: float, _gap_s: float) -> ZoneTime:
    length = float(times_s[-1] - times_s[0])
    return ZoneTime(seconds=float(np.mean(bpm >= threshold)) * length, counted_s=length)


def test_counting_samples_instead_of_seconds_is_caught(shared_data: Callable[[str], Path]) -> None:
    for person in PEOPLE:
        with pytest.raises(AssertionError):
            check(*effort_test(person, shared_data), math.inf, seconds_by_count)
