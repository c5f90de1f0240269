from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from studykit.core.seeding import stream
from studykit.participant.heart_rate_kinetics import Heart, response_bpm, steady_state_bpm
from studykit.participant.person import cohort

PERSON = replace(
    cohort(1, 0)[0],
    age=25,
    resting_heart_rate_bpm=65.0,
    maximum_heart_rate_bpm=190.0,
    rise_s=30.0,
    fall_s=60.0,
)


def test_effort_is_a_share_of_the_reserve() -> None:
    assert steady_state_bpm(PERSON, 0.0) == 65.0
    assert steady_state_bpm(PERSON, 0.4) == 115.0
    assert steady_state_bpm(PERSON, 1.7) == 190.0
    assert steady_state_bpm(PERSON, -1.0) == 65.0


def test_after_one_time_constant_63_percent_of_the_way_is_made() -> None:
    assert response_bpm(30.0, 60.0, 160.0, 30.0) == pytest.approx(60.0 + 100.0 * (1.0 - np.exp(-1.0)))
    assert response_bpm(np.array([0.0, 1e6]), 60.0, 160.0, 30.0).tolist() == [60.0, 160.0]


def test_the_rate_obeys_its_differential_equation() -> None:
    # dh/dt = (steady - h) / tau, stepped in small steps, through a rise, a further rise and a fall.
    heart = Heart(PERSON, stream(0, "heart"))
    for demand, start_s in ((0.85, 10.0), (0.95, 25.0), (0.0, 42.0)):
        heart.exert(demand, start_s)
    rate, step_s = 65.0, 0.001
    for step in range(100_000):
        time_s = step * step_s
        steady = 65.0 if time_s < 10 else 171.25 if time_s < 25 else 183.75 if time_s < 42 else 65.0
        if step % 1000 == 0:
            assert heart.rate_bpm(time_s) == pytest.approx(rate, abs=0.02)
        rate += step_s * (steady - rate) / (30.0 if steady > rate else 60.0)


def test_a_short_dance_from_rest_cannot_reach_the_published_share_of_vigorous_time() -> None:
    heart = Heart(PERSON, stream(0, "heart"))
    heart.exert(0.85, 0.0)
    rates = np.array([heart.rate_bpm(time_s) for time_s in np.arange(0.0, 32.0, 0.1)])
    vigorous = np.mean(rates >= 0.7 * (208 - 0.7 * 25))
    assert rates.max() == pytest.approx(65 + 106.25 * (1 - np.exp(-32 / 30)), abs=0.3)
    assert 0.0 < vigorous < 0.3  # the published share is 0.66


def test_beats_are_whole_ticks_and_follow_the_rate() -> None:
    heart = Heart(PERSON, stream(1, "heart"), start_s=100.0)
    rest = heart.beats_until(400.0)
    heart.exert(0.85, 400.0)
    heart.beats_until(600.0)
    work = heart.beats_until(700.0)
    assert all((interval * 1024).is_integer() for interval in rest + work)
    assert sum(rest) == pytest.approx(300.0, abs=1.5)
    assert 60 / np.mean(rest) == pytest.approx(65.0, abs=2.0)
    assert 60 / np.mean(work) == pytest.approx(171.0, abs=2.5)


def test_a_resting_heart_varies_more_from_beat_to_beat_than_a_racing_one() -> None:
    def rmssd_s(intervals: list[float]) -> float:
        return float(np.sqrt(np.mean(np.diff(intervals) ** 2)))

    heart = Heart(PERSON, stream(2, "heart"))
    rest = heart.beats_until(300.0)
    heart.exert(0.85, 300.0)
    heart.beats_until(500.0)
    work = heart.beats_until(700.0)
    assert 0.015 < rmssd_s(rest) < 0.06  # as in resting adults
    assert rmssd_s(work) < 0.4 * rmssd_s(rest)


def test_beats_do_not_depend_on_how_often_one_asks() -> None:
    whole = Heart(PERSON, stream(3, "heart")).beats_until(60.0)
    heart = Heart(PERSON, stream(3, "heart"))
    pieces = [beat for time_s in range(1, 61) for beat in heart.beats_until(float(time_s))]
    assert pieces == whole


def test_effort_cannot_be_asked_for_in_the_past() -> None:
    heart = Heart(PERSON, stream(0, "heart"))
    heart.exert(0.5, 10.0)
    with pytest.raises(ValueError, match="cannot begin before"):
        heart.exert(0.5, 9.0)
