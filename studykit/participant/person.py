"""Simulated people with the ages, bodies and hearts of a study's participants."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.special import betaincinv, ndtri

from studykit.core.arrays import Booleans, Floats
from studykit.core.seeding import stream

Sex = Literal["F", "M"]

_LIMITS: dict[str, tuple[float, float]] = {
    "age": (18, 100),
    "height_m": (1.2, 2.2),
    "weight_kg": (35.0, 200.0),
    "dance_experience_years": (0.0, 80.0),
    "resting_heart_rate_bpm": (40.0, 100.0),
    "maximum_heart_rate_bpm": (120.0, 230.0),
    "rise_s": (10.0, 90.0),
    "fall_s": (20.0, 180.0),
}


@dataclass(frozen=True, kw_only=True, slots=True)
class Person:
    """Somebody who takes part, simulated.

    The last four fields say how many standard deviations this person differs from the average one; how
    much a standard deviation matters is for the planted effects to say.

    Parameters
    ----------
    id : str
        Number of the participant, such as "07".
    age : int
        Years.
    sex : {"F", "M"}
        Female or male.
    height_m, weight_kg : float
        The body.
    dance_experience_years : float
        Years of dancing.
    resting_heart_rate_bpm, maximum_heart_rate_bpm : float
        The true ones, which a formula for an age only estimates.
    rise_s, fall_s : float
        Time constants with which the heart rate rises under effort and falls in rest, s.
    exertion : float
        How hard the same dance is for the heart of this person.
    skill : float
        How exactly this person copies a movement; positive is better.
    leniency : float
        How kindly this person rates.
    enjoyment : float
        How much this person enjoys it.

    Raises
    ------
    ValueError
        If a value lies outside what a living adult shows.
    """

    id: str
    age: int
    sex: Sex
    height_m: float
    weight_kg: float
    dance_experience_years: float
    resting_heart_rate_bpm: float
    maximum_heart_rate_bpm: float
    rise_s: float = 30.0
    fall_s: float = 60.0
    exertion: float = 0.0
    skill: float = 0.0
    leniency: float = 0.0
    enjoyment: float = 0.0

    def __post_init__(self) -> None:
        for name, (low, high) in _LIMITS.items():
            if not low <= getattr(self, name) <= high:
                raise ValueError(f"{name} is {getattr(self, name)}, expected {low:g} to {high:g}")


def cohort(count: int, seed: int) -> tuple[Person, ...]:
    """Invent the people of a study, with the demographics of a published one.

    Ages of 21 to 40 with mean 25.3 and standard deviation 6.3, half of them women, 73.5 kg on average
    with standard deviation 8.9; of twenty, one has danced for more than three years, two for less than one
    and seventeen never. Ages and weights are spread evenly over their distributions, so that small groups
    have these figures too.

    Parameters
    ----------
    count : int
        How many people, 1 or more.
    seed : int
        The same seed invents the same people.

    Returns
    -------
    tuple of Person
        Numbered "01", "02" and so on.
    """
    rng = stream(seed, "cohort")
    is_female = rng.permutation(np.arange(count) % 2 == 0)
    ages = _ages(count, rng)
    weights_kg = _weights_kg(is_female, rng)
    experience = _experience_years(count, rng)
    width = max(2, len(str(count)))
    people = []
    for number in range(count):
        skill = rng.normal() + (0.5 if experience[number] else 0.0)
        people.append(
            Person(
                id=f"{number + 1:0{width}d}",
                age=int(ages[number]),
                sex="F" if is_female[number] else "M",
                height_m=round(_limited(rng, 1.65 if is_female[number] else 1.78, 0.065), 2),
                weight_kg=round(float(weights_kg[number]), 1),
                dance_experience_years=float(experience[number]),
                resting_heart_rate_bpm=_limited(rng, 70.0 if is_female[number] else 66.0, 7.0),
                # Tanaka et al. 2001: the formula misses a person's own maximum by about 10 bpm.
                maximum_heart_rate_bpm=_limited(rng, 208.0 - 0.7 * float(ages[number]), 10.0),
                rise_s=float(rng.uniform(25.0, 35.0)),
                fall_s=float(rng.uniform(45.0, 75.0)),
                exertion=float(rng.normal()),
                skill=float(skill),
                leniency=float(rng.normal()),
                enjoyment=float(rng.normal()),
            )
        )
    return tuple(people)


def _limited(rng: np.random.Generator, mean: float, spread: float) -> float:
    """Draw from a normal distribution whose tails end at two standard deviations."""
    return float(mean + spread * np.clip(rng.normal(), -2.0, 2.0))


def _strata(count: int, rng: np.random.Generator) -> Floats:
    """Give one share of a distribution to each person: evenly spread, in random order."""
    return np.asarray(rng.permutation((np.arange(count) + 0.5) / count))


def _ages(count: int, rng: np.random.Generator) -> Floats:
    # A mean so near the youngest with so wide a spread means many of 21 and a few near 40: the beta
    # distribution over 21-40 with these two moments.
    mean, variance = (25.3 - 21.0) / 19.0, (6.3 / 19.0) ** 2
    size = mean * (1.0 - mean) / variance - 1.0
    return np.asarray(
        np.round(21.0 + 19.0 * betaincinv(size * mean, size * (1.0 - mean), _strata(count, rng)))
    )


def _weights_kg(is_female: Booleans, rng: np.random.Generator) -> Floats:
    # 5 kg to either side by sex and 7.36 kg within each make 8.9 kg in all: 5^2 + 7.36^2 = 8.9^2.
    weights = np.where(is_female, 68.5, 78.5)
    for members in (is_female, ~is_female):
        weights[members] += 7.36 * ndtri(_strata(int(members.sum()), rng))
    return np.asarray(weights)


def _experience_years(count: int, rng: np.random.Generator) -> Floats:
    long, short = round(count / 20), round(count / 10)
    years = np.zeros(count)
    years[:long] = np.round(rng.uniform(3.5, 8.0, long), 1)
    years[long : long + short] = np.round(rng.uniform(0.2, 0.9, short), 1)
    return np.asarray(rng.permutation(years))
