from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studykit.analysis.beats import Beats, corrected, rates


def clean_beats(seed: int, count: int = 400) -> np.ndarray:
    """Rise from rest to exercise with the breathing of a healthy heart."""
    rng = np.random.default_rng(seed)
    level = np.interp(np.arange(count), [0, count], [0.9, 0.45])
    return np.asarray(level * (1.0 + 0.03 * np.sin(np.arange(count) * 1.3) + 0.006 * rng.normal(size=count)))


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_a_clean_series_stays_as_it_is(seed: int) -> None:
    beats = clean_beats(seed)
    found = corrected(beats)
    assert found.intervals_s.tolist() == beats.tolist()
    assert found.corrected_share == 0.0


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32 - 1), st.integers(1, 20))
def test_planted_ectopic_beats_are_found_in_their_share(seed: int, pairs: int) -> None:
    beats = clean_beats(seed)
    planted = 4 + 19 * np.arange(pairs)
    early = beats.copy()
    early[planted] *= 0.6  # comes too early, and the next one pauses for as long
    early[planted + 1] += beats[planted] - early[planted]
    found = corrected(early)
    assert np.flatnonzero(found.is_corrected).tolist() == sorted([*planted, *(planted + 1)])
    assert found.corrected_share == pytest.approx(2 * pairs / 400)
    np.testing.assert_allclose(found.intervals_s, beats, rtol=0.1)


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.7, 1.4))
def test_the_rule_knows_no_tempo(seed: int, faster: float) -> None:
    beats = clean_beats(seed, 60)
    beats[20] *= 1.9
    slow, fast = corrected(beats), corrected(faster * beats)
    assert slow.is_corrected.tolist() == fast.is_corrected.tolist()
    np.testing.assert_allclose(faster * slow.intervals_s, fast.intervals_s)


def test_impossible_times_are_replaced_and_nothing_is_made_of_nothing() -> None:
    found = corrected(np.array([0.1, 0.8, 0.81, 2.5, 0.79, 0.8]))
    assert found.is_corrected.tolist() == [True, False, False, True, False, False]
    assert found.intervals_s[[0, 3]] == pytest.approx(0.8, abs=0.01)
    assert np.isnan(corrected(np.array([0.1, 3.0])).intervals_s).all()
    assert np.isnan(corrected(np.array([])).corrected_share)
    with pytest.raises(ValueError, match="shape"):
        corrected(np.zeros((2, 2)))


def test_one_wrong_beat_does_not_condemn_the_next() -> None:
    # Against the beat before it (Malik's own reading) the good beat after a missed one would be wrong too.
    beats = np.full(9, 0.8)
    beats[4] = 1.6
    against_last = np.abs(np.diff(beats)) > 0.2 * beats[:-1]
    assert against_last.sum() == 2
    assert corrected(beats).is_corrected.sum() == 1


def test_rates_are_those_that_a_belt_shows() -> None:
    intervals = np.array([1.0, 1.0, 0.5, 0.5, 0.5, 0.5, 0.5])
    beats = Beats(intervals_s=intervals, is_corrected=np.zeros(7, dtype=bool))
    times, bpm = rates(np.cumsum(intervals), beats)
    assert times.tolist() == np.cumsum(intervals).tolist()
    assert bpm == pytest.approx([60.0, 60.0, 60 * 3 / 2.5, 60 * 4 / 3, 60 * 5 / 3.5, 60 * 5 / 3, 120.0])
    nothing = rates(np.array([1.0]), Beats(intervals_s=np.array([np.nan]), is_corrected=np.array([True])))
    assert [part.size for part in nothing] == [0, 0]


def test_real_beats_of_a_strap_are_nearly_all_right(shared_data: Callable[[str], Path]) -> None:
    with shared_data("heart_rate/h10_exercise_rr.csv").open(encoding="utf-8") as file:
        beats_s = np.array([float(row["rr"]) / 1000.0 for row in csv.DictReader(file)])
    found = corrected(beats_s)
    assert found.corrected_share < 0.02
    np.testing.assert_allclose(found.intervals_s.sum(), beats_s.sum(), rtol=0.01)
