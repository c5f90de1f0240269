from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from studykit.participant.person import Person, cohort


@pytest.mark.parametrize("seed", [0, 1, 7])
def test_twenty_people_have_the_published_demographics(seed: int) -> None:
    people = cohort(20, seed)
    ages = np.array([person.age for person in people])
    weights = np.array([person.weight_kg for person in people])
    years = np.array([person.dance_experience_years for person in people])
    assert ages.min() == 21
    assert ages.max() == 40
    assert ages.mean() == pytest.approx(25.3, abs=0.2)
    assert ages.std(ddof=1) == pytest.approx(6.3, abs=0.4)
    assert weights.mean() == pytest.approx(73.5, abs=0.1)
    assert weights.std(ddof=1) == pytest.approx(8.9, abs=0.4)
    assert sum(person.sex == "F" for person in people) == 10
    assert ((years > 3).sum(), ((years > 0) & (years < 1)).sum(), (years == 0).sum()) == (1, 2, 17)


def test_a_seed_invents_the_same_people_and_another_seed_others() -> None:
    assert cohort(20, 3) == cohort(20, 3)
    assert cohort(20, 3) != cohort(20, 4)
    assert [person.id for person in cohort(3, 0)] == ["01", "02", "03"]
    assert cohort(120, 0)[0].id == "001"


def test_the_true_maximum_differs_from_the_formula_by_about_ten_beats() -> None:
    people = cohort(400, 1)
    misses = np.array([person.maximum_heart_rate_bpm - (208 - 0.7 * person.age) for person in people])
    assert abs(misses.mean()) < 1.5
    assert 8.0 < misses.std() < 11.0
    assert np.abs(misses).max() <= 20.0 + 1e-9


def test_an_impossible_person_is_refused() -> None:
    person = cohort(1, 0)[0]
    with pytest.raises(ValueError, match="age is 5"):
        replace(person, age=5)
    with pytest.raises(ValueError, match="maximum_heart_rate_bpm"):
        Person(
            id="01",
            age=30,
            sex="F",
            height_m=1.7,
            weight_kg=60.0,
            dance_experience_years=0.0,
            resting_heart_rate_bpm=60.0,
            maximum_heart_rate_bpm=300.0,
        )
