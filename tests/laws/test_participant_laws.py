from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from studykit.core.seeding import stream
from studykit.participant.effects import NONE, PAPER
from studykit.participant.heart_rate_kinetics import Heart
from studykit.participant.person import cohort
from studykit.participant.ratings import paces, smoothness

seeds = st.integers(0, 2**31)


@settings(max_examples=40)
@given(count=st.integers(1, 60), seed=seeds)
def test_every_person_lies_inside_the_limits(count: int, seed: int) -> None:
    people = cohort(count, seed)  # a person outside what an adult shows cannot be made
    assert len({person.id for person in people}) == count
    for person in people:
        assert 21 <= person.age <= 40
        assert 25.0 <= person.rise_s <= 35.0
        assert 45.0 <= person.fall_s <= 75.0
        assert person.maximum_heart_rate_bpm - person.resting_heart_rate_bpm > 60.0
    assert abs(sum(person.sex == "F" for person in people) - count / 2) <= 0.5


@settings(max_examples=30, deadline=None)
@given(seed=seeds, demands=st.lists(st.floats(0.0, 1.0), min_size=1, max_size=6))
def test_a_heart_stays_between_rest_and_maximum(seed: int, demands: list[float]) -> None:
    person = cohort(1, seed)[0]
    heart = Heart(person, stream(seed, "heart"))
    low, high = person.resting_heart_rate_bpm, person.maximum_heart_rate_bpm
    for phase, demand in enumerate(demands):
        heart.exert(demand, 30.0 * phase)
        rates = [heart.rate_bpm(30.0 * phase + step) for step in np.linspace(0.0, 30.0, 7)]
        assert low - 1e-9 <= min(rates)
        assert max(rates) <= high + 1e-9
        assert all(np.diff(rates) >= -1e-9) or all(np.diff(rates) <= 1e-9)
        assert all(0.2 < interval < 2.0 for interval in heart.beats_until(30.0 * (phase + 1)))


@settings(max_examples=40)
@given(
    seed=seeds,
    condition=st.sampled_from(["light-easy-off", "intense-hard-on"]),
    planted=st.sampled_from([PAPER, NONE]),
)
def test_every_answer_is_on_the_scale(seed: int, condition: str, planted) -> None:
    person = cohort(1, seed)[0]
    answers = paces(planted, person, stream(seed, "paces"), reversed_items=(1, 4))
    assert list(answers) == [f"item_{item:02d}" for item in range(1, 19)]
    assert all(1 <= answer <= 7 for answer in answers.values())
    assert 1 <= smoothness(planted, condition, person, stream(seed, "smoothness")) <= 7
