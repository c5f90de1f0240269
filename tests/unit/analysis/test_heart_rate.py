from __future__ import annotations

import math

import numpy as np
import pytest

from studykit.analysis.heart_rate import (
    ZoneTime,
    at_reserve,
    held,
    maximum,
    mean_bpm,
    peak_bpm,
    recovery_bpm,
    resting_bpm,
    seconds_at_or_above,
    standing,
    zones,
)


def test_the_two_formulas_for_the_maximum() -> None:
    assert maximum(25.3, "tanaka") == pytest.approx(190.29)
    assert maximum(25.3, "fox") == pytest.approx(194.7)
    with pytest.raises(ValueError, match="tanaka"):
        maximum(25.3, "karvonen")  # type: ignore[arg-type]


def test_a_reading_from_before_the_window_counts_from_its_start() -> None:
    times, bpm = [0.0, 4.0, 6.0], [100.0, 120.0, 90.0]
    assert mean_bpm(times, bpm, 2.0, 5.0, 10.0) == pytest.approx((2 * 100 + 1 * 120) / 3)
    assert peak_bpm(times, bpm, 2.0, 4.0, 10.0) == 100.0


def test_the_whole_silence_is_judged_even_where_the_window_cuts_it() -> None:
    times, bpm = [0.0, 12.0, 13.0], [100.0, 120.0, 90.0]
    assert seconds_at_or_above(times, bpm, 50.0, 10.0, start_s=5.0) == ZoneTime(seconds=1.0, counted_s=1.0)


def test_zero_and_nan_are_no_readings() -> None:
    part = held([0.0, 1.0, 2.0, 3.0], [100.0, 0.0, math.nan, 120.0], longest_gap_s=10.0)
    assert part.heart_rate_bpm.tolist() == [100.0]
    assert part.seconds.tolist() == [3.0]


@pytest.mark.parametrize("readings", [0, 1])
def test_without_two_readings_nothing_counts(readings: int) -> None:
    times, bpm = np.arange(readings), np.full(readings, 80.0)
    zone = seconds_at_or_above(times, bpm, 60.0, 10.0)
    assert zone == ZoneTime(seconds=0.0, counted_s=0.0)
    assert math.isnan(zone.fraction)
    assert math.isnan(mean_bpm(times, bpm, 0.0, 9.0, 10.0))
    assert math.isnan(peak_bpm(times, bpm, 0.0, 9.0, 10.0))


def test_a_threshold_that_rounds_up_still_takes_in_its_equal() -> None:
    threshold = 0.55 * maximum(40.0, "tanaka")
    assert threshold > 99.0  # by one rounding error
    assert seconds_at_or_above([0.0, 1.0], [99.0, 99.0], threshold, 10.0).fraction == 1.0


def test_lists_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match="same length"):
        held([0.0, 1.0], [80.0], longest_gap_s=10.0)
    with pytest.raises(ValueError, match="decrease"):
        held([1.0, 0.0], [80.0, 80.0], longest_gap_s=10.0)


def test_zones_share_out_the_counted_time_and_a_bound_belongs_above() -> None:
    times, bpm = np.arange(7.0), [90.0, 100.0, 120.0, 133.0, 140.0, 200.0, 80.0]
    found = zones(times, bpm, [100.0, 0.7 * 190.0], 10.0)
    assert [zone.seconds for zone in found] == [1.0, 2.0, 3.0]
    assert sum(zone.fraction for zone in found) == pytest.approx(1.0)
    above = seconds_at_or_above(times, bpm, 0.7 * 190.0, 10.0)
    assert found[-1] == above
    with pytest.raises(ValueError, match="rise"):
        zones(times, bpm, [120.0, 100.0], 10.0)


def test_the_reserve_runs_from_rest_to_the_maximum() -> None:
    assert at_reserve(0.0, resting_bpm=62.0, maximum_bpm=190.0) == 62.0
    assert at_reserve(1.0, resting_bpm=62.0, maximum_bpm=190.0) == 190.0
    assert at_reserve(0.6, resting_bpm=62.0, maximum_bpm=190.0) == pytest.approx(138.8)


def test_what_stands_is_the_latest_reading_that_is_not_too_old() -> None:
    found = standing([1.0, 2.0, 3.0], [80.0, 0.0, 90.0], np.array([0.5, 2.5, 3.0, 12.9, 13.1]), 10.0)
    np.testing.assert_array_equal(found, [np.nan, 80.0, 90.0, 90.0, np.nan])
    assert np.isnan(standing([], [], np.array([1.0]), 10.0)).all()


def test_recovery_is_the_fall_in_one_minute() -> None:
    times = np.arange(0.0, 200.0)
    bpm = 100.0 + 60.0 * np.exp(-np.maximum(times - 50.0, 0.0) / 60.0)
    assert recovery_bpm(times, bpm, 50.0, 10.0) == pytest.approx(60.0 * (1.0 - math.exp(-1.0)))
    assert math.isnan(recovery_bpm(times, bpm, 160.0, 10.0))


def test_only_the_settled_end_of_a_rest_counts() -> None:
    times = np.arange(0.0, 181.0)
    bpm = np.where(times < 120.0, 95.0, 61.0)
    assert resting_bpm(times, bpm, 0.0, 180.0, 10.0) == 61.0
    assert resting_bpm(times, bpm, 100.0, 140.0, 10.0) == pytest.approx(78.0)
    assert math.isnan(resting_bpm(times, np.zeros(181), 0.0, 180.0, 10.0))


def test_a_constant_heart_rate_is_its_own_rest_peak_and_never_recovers() -> None:
    times, bpm = np.arange(0.0, 300.0), np.full(300, 72.0)
    assert resting_bpm(times, bpm, 0.0, 100.0, 10.0) == peak_bpm(times, bpm, 100.0, 200.0, 10.0) == 72.0
    assert recovery_bpm(times, bpm, 150.0, 10.0) == 0.0
