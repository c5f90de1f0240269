"""How a simulated person answers questions."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from scipy.special import ndtr

from studykit.core.arrays import Floats
from studykit.participant.effects import Effects, Enjoyment
from studykit.participant.person import Person

_LOWEST, _HIGHEST, _ITEMS = 1, 7, 18


def smoothness(effects: Effects, condition: str, person: Person, rng: np.random.Generator) -> int:
    """Rate how smooth a dance was, from 1 (strongly disagree) to 7 (strongly agree).

    Parameters
    ----------
    effects : Effects
        What is planted.
    condition : str
        Name of the condition that was danced.
    person : Person
        Who rates.
    rng : numpy.random.Generator
        Differences between ratings.

    Returns
    -------
    int
    """
    return int(_ticked(np.array(effects.smoothness.draw(condition, person.leniency, rng))))


def paces(
    effects: Effects, person: Person, rng: np.random.Generator, *, reversed_items: Collection[int]
) -> dict[str, int]:
    """Tick the 18 items of the enjoyment scale.

    Parameters
    ----------
    effects : Effects
        What is planted.
    person : Person
        Who answers.
    rng : numpy.random.Generator
        Differences between items.
    reversed_items : collection of int
        Numbers of the items whose pleasant pole is the left one; there a happy person ticks 1.

    Returns
    -------
    dict of str to int
        ``item_01`` to ``item_18`` as ticked, 1 to 7.
    """
    plan = effects.enjoyment
    feelings = _centre(plan) + plan.person_sd * person.enjoyment + plan.item_sd * rng.normal(size=_ITEMS)
    answers = [int(answer) for answer in _ticked(feelings)]
    return {
        f"item_{item:02d}": _LOWEST + _HIGHEST - answer if item in reversed_items else answer
        for item, answer in enumerate(answers, start=1)
    }


def _ticked(feelings: Floats) -> Floats:
    return np.clip(np.round(feelings), _LOWEST, _HIGHEST)


def _centre(plan: Enjoyment) -> float:
    """Find the mean feeling whose ticked answers have the mean asked for.

    Nobody can tick more than 7, so a mean near the end of the scale needs feelings beyond it.
    """
    spread = max(float(np.hypot(plan.person_sd, plan.item_sd)), 1e-6)
    centres = np.linspace(_LOWEST - 4.0 * spread, _HIGHEST + 4.0 * spread, 2001)
    edges = np.arange(_LOWEST, _HIGHEST) + 0.5
    means = _LOWEST + ndtr((centres[:, None] - edges) / spread).sum(axis=1)
    return float(np.interp(plan.item_mean, means, centres))
