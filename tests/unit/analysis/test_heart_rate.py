from __future__ import annotations

import math

import numpy as np
import pytest

from studykit.analysis.heart_rate import ZoneTime, held, maximum, mean_bpm, peak_bpm, seconds_at_or_above


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
