from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studykit.recording.session_record import SessionRecord, StepRecord, read_session
from studykit.recording.study_folder import StudyFolder
from studykit.reports.choices import Choices
from studykit.reports.heart_measures import heart_measures

CHOICES = Choices(window="perform", maximum="fox", vigorous_fraction=0.7, longest_gap_s=10.0, band_s=1.0)
AGE = 30.0  # so that Fox expects 190 beats a minute


def step(number: int, phase: str, start_s: float, stop_s: float) -> StepRecord:
    condition = "light-easy-on" if phase in ("watch", "perform", "rest") else None
    return StepRecord(
        step=number,
        phase=phase,
        condition=condition,
        period=None if condition is None else 1,
        start_s=start_s,
        stop_s=stop_s,
        is_complete=True,
    )


STEPS = (
    step(1, "baseline", 0.0, 120.0),
    step(2, "watch", 120.0, 150.0),
    step(3, "perform", 150.0, 182.0),
    step(4, "rest", 182.0, 300.0),
)
DANCED = STEPS[2]


@pytest.fixture
def visit(recorded_study: Callable[[], Path]) -> SessionRecord:
    """Give a visit with a known heart: 60 at rest, 90 when watching, 150 when dancing, 110 a minute later."""
    times = np.arange(0.0, 300.0)
    bpm = np.select(
        [times < 120.0, times < 150.0, times < 183.0, times < 240.0], [60.0, 90.0, 150.0, 130.0], 110.0
    )
    record = read_session(StudyFolder(recorded_study()).sessions()[0])
    answers = tuple(
        replace(one, answers={**one.answers, "age": AGE}) if one.questionnaire == "demographics" else one
        for one in record.answers
    )
    return replace(
        record,
        steps=STEPS,
        answers=answers,
        heart_rate_times_s=times,
        heart_rate_bpm=bpm,
        beat_times_s=np.empty(0),
        beat_intervals_s=np.empty(0),
    )


def test_what_is_measured_of_a_known_heart(visit: SessionRecord) -> None:
    found = heart_measures(visit, DANCED, CHOICES)
    assert (found.mean_bpm, found.peak_bpm, found.resting_bpm) == (150.0, 150.0, 60.0)
    assert found.recovery_bpm == 40.0
    assert found.coverage == 1.0
    assert found.vigorous_fraction == 1.0  # 150 >= 0.7 x 190
    assert found.vigorous_fraction_reserve == 1.0  # 150 >= 60 + 0.6 x 130
    assert np.isnan(found.corrected_share)


def test_the_window_is_the_one_that_is_chosen(visit: SessionRecord) -> None:
    longer = heart_measures(visit, DANCED, replace(CHOICES, window="perform+30"))
    assert longer.mean_bpm == pytest.approx((33 * 150 + 29 * 130) / 62)
    watching = heart_measures(visit, DANCED, replace(CHOICES, window="watch+perform"))
    assert watching.mean_bpm == pytest.approx((30 * 90 + 32 * 150) / 62)
    assert watching.vigorous_fraction == pytest.approx(32 / 62)


def test_missing_time_is_told_and_does_not_count(visit: SessionRecord) -> None:
    silent = visit.heart_rate_bpm.copy()
    silent[160:176] = 0.0
    found = heart_measures(replace(visit, heart_rate_bpm=silent), DANCED, CHOICES)
    assert found.coverage == pytest.approx(15 / 32)
    assert found.vigorous_fraction == 1.0


def test_of_a_silent_belt_nothing_is_known(visit: SessionRecord) -> None:
    found = heart_measures(replace(visit, heart_rate_bpm=np.zeros(300)), DANCED, CHOICES)
    assert found.coverage == 0.0
    unknown = (found.mean_bpm, found.peak_bpm, found.vigorous_fraction, found.resting_bpm, found.recovery_bpm)
    assert np.isnan([*unknown, found.vigorous_fraction_reserve]).all()


def test_the_maximum_is_the_one_that_is_chosen_and_none_without_an_age(visit: SessionRecord) -> None:
    below = replace(visit, heart_rate_bpm=np.where(visit.heart_rate_bpm == 150.0, 132.9, 60.0))
    assert heart_measures(below, DANCED, CHOICES).vigorous_fraction == 0.0
    tanaka = heart_measures(below, DANCED, replace(CHOICES, maximum="tanaka"))
    assert tanaka.vigorous_fraction == 1.0  # 132.9 lies between 0.7 x 187 and 0.7 x 190
    measured = replace(CHOICES, maximum="measured")
    assert np.isnan(heart_measures(below, DANCED, measured).vigorous_fraction)
    told = tuple(
        replace(one, answers={**one.answers, "maximum_heart_rate_bpm": 185.0})
        if one.questionnaire == "demographics"
        else one
        for one in below.answers
    )
    assert heart_measures(replace(below, answers=told), DANCED, measured).vigorous_fraction == 1.0
    nameless = heart_measures(replace(visit, answers=()), DANCED, CHOICES)
    assert np.isnan([nameless.vigorous_fraction, nameless.vigorous_fraction_reserve]).all()
    assert nameless.mean_bpm == 150.0


def test_there_is_no_recovery_where_no_minute_of_rest_was_recorded(visit: SessionRecord) -> None:
    again = replace(visit, steps=(*STEPS[:3], step(4, "perform", 182.0, 214.0)))
    assert np.isnan(heart_measures(again, DANCED, CHOICES).recovery_bpm)
    short = replace(
        visit, heart_rate_times_s=visit.heart_rate_times_s[:200], heart_rate_bpm=visit.heart_rate_bpm[:200]
    )
    assert np.isnan(heart_measures(short, DANCED, CHOICES).recovery_bpm)


def test_beats_can_stand_in_for_the_belts_own_readings(visit: SessionRecord) -> None:
    intervals = np.full(700, 0.5)
    intervals[400] = 1.0  # the strap missed one
    with_beats = replace(visit, beat_times_s=np.cumsum(intervals), beat_intervals_s=intervals)
    by_beats = heart_measures(with_beats, DANCED, replace(CHOICES, heart_source="beats"))
    assert by_beats.mean_bpm == pytest.approx(120.0)
    assert by_beats.peak_bpm == pytest.approx(120.0)
    by_belt = heart_measures(with_beats, DANCED, CHOICES)
    assert by_belt.mean_bpm == 150.0
    assert by_belt.corrected_share == 0.0
    later = replace(DANCED, start_s=190.0, stop_s=210.0)
    assert heart_measures(with_beats, later, CHOICES).corrected_share == pytest.approx(1 / 39)
    without = heart_measures(visit, DANCED, replace(CHOICES, heart_source="beats"))
    assert without.mean_bpm == 150.0


def test_the_beats_of_a_journal_end_when_their_message_came(recorded_study: Callable[[], Path]) -> None:
    record = read_session(StudyFolder(recorded_study()).sessions()[0])
    gaps = np.diff(record.beat_times_s) - record.beat_intervals_s[1:]
    assert len(record.beat_times_s) == len(record.beat_intervals_s) > 100
    assert (np.diff(record.beat_times_s) > 0.0).all()
    assert abs(gaps.mean()) < 0.01
    assert np.abs(gaps).max() < 1.5  # a message comes each second, whatever the heart does
