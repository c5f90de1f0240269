"""What must hold of time in zones whatever the recording."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studykit.analysis.heart_rate import held, mean_bpm, peak_bpm, seconds_at_or_above

recordings = st.lists(
    st.tuples(st.floats(0.01, 20.0), st.one_of(st.just(0), st.integers(40, 200))), min_size=1, max_size=30
).map(lambda pairs: (np.cumsum([gap for gap, _ in pairs]), np.array([float(bpm) for _, bpm in pairs])))


@settings(deadline=None)
@given(recordings, st.floats(40.0, 200.0), st.floats(0.0, 300.0))
def test_two_windows_make_the_whole(
    recording: tuple[np.ndarray, np.ndarray], bpm: float, cut_s: float
) -> None:
    whole = seconds_at_or_above(*recording, bpm, 10.0)
    before = seconds_at_or_above(*recording, bpm, 10.0, stop_s=cut_s)
    after = seconds_at_or_above(*recording, bpm, 10.0, start_s=cut_s)
    assert before.seconds + after.seconds == pytest.approx(whole.seconds, abs=1e-9)
    assert before.counted_s + after.counted_s == pytest.approx(whole.counted_s, abs=1e-9)


@settings(deadline=None)
@given(recordings, st.floats(40.0, 200.0), st.floats(0.0, 50.0))
def test_a_higher_threshold_never_gives_more_time(
    recording: tuple[np.ndarray, np.ndarray], bpm: float, more: float
) -> None:
    low, high = (seconds_at_or_above(*recording, threshold, 10.0) for threshold in (bpm, bpm + more))
    assert 0.0 <= high.seconds <= low.seconds <= low.counted_s + 1e-12
    assert seconds_at_or_above(*recording, 0.0, 10.0).seconds == low.counted_s


@settings(deadline=None)
@given(recordings)
def test_repeating_a_reading_changes_nothing(recording: tuple[np.ndarray, np.ndarray]) -> None:
    times, bpm = recording
    bpm = np.maximum(bpm, 40.0)
    halves = times[:-1] + 0.5 * np.diff(times)
    finer = np.sort(np.concatenate((times, halves)))
    repeated = bpm[np.searchsorted(times, finer, side="right") - 1]
    window = (float(times[0]), float(times[-1]), math.inf)
    expected = mean_bpm(times, bpm, *window)
    assert mean_bpm(finer, repeated, *window) == pytest.approx(expected, rel=1e-9, nan_ok=True)


@settings(deadline=None)
@given(recordings)
def test_the_mean_lies_between_the_readings_that_stood(recording: tuple[np.ndarray, np.ndarray]) -> None:
    window = (-math.inf, math.inf, 10.0)
    part = held(*recording, longest_gap_s=10.0)
    if part.seconds.size:
        mean = mean_bpm(*recording, *window)
        assert part.heart_rate_bpm.min() - 1e-9 <= mean <= peak_bpm(*recording, *window) + 1e-9
    else:
        assert math.isnan(mean_bpm(*recording, *window))


@settings(deadline=None)
@given(recordings, st.floats(40.0, 200.0))
def test_zero_is_as_good_as_silence(recording: tuple[np.ndarray, np.ndarray], bpm: float) -> None:
    times, readings = recording
    real = readings > 0.0
    expected = seconds_at_or_above(times[real], readings[real], bpm, 10.0)
    assert seconds_at_or_above(*recording, bpm, 10.0) == expected
