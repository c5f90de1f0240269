from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from studykit.core.seeding import stream
from studykit.participant.effects import NONE, PAPER, Effects, Enjoyment
from studykit.participant.person import cohort
from studykit.participant.ratings import paces, smoothness

# Kendzierski and DeCarlo 1991.
REVERSED = (1, 4, 5, 7, 9, 10, 11, 13, 14, 16, 17)
CONDITIONS = ["-".join(levels) for levels in product(("light", "intense"), ("easy", "hard"), ("on", "off"))]


def scores(effects: Effects, *, reversed_items: tuple[int, ...] = REVERSED) -> np.ndarray:
    """The keyed answers of many people, shape (person, item)."""
    people = cohort(600, 2)
    answers = [paces(effects, p, stream(2, p.id), reversed_items=reversed_items) for p in people]
    ticked = np.array([[row[f"item_{item:02d}"] for item in range(1, 19)] for row in answers])
    turned = np.isin(np.arange(1, 19), REVERSED)
    return np.where(turned, 8 - ticked, ticked)


def test_enjoyment_is_85_percent_of_the_maximum_under_the_published_effects() -> None:
    assert scores(PAPER).sum(axis=1).mean() / 126 == pytest.approx(0.85, abs=0.01)
    assert scores(NONE).mean() == pytest.approx(4.0, abs=0.05)


def test_answers_with_the_wrong_items_reversed_are_noticed() -> None:
    assert scores(PAPER, reversed_items=()).sum(axis=1).mean() / 126 < 0.6


def test_people_who_enjoy_it_say_so_throughout() -> None:
    items = scores(PAPER)
    alpha = 18 / 17 * (1 - items.var(axis=0, ddof=1).sum() / items.sum(axis=1).var(ddof=1))
    assert 0.8 < alpha < 0.97


def test_a_mean_at_the_end_of_the_scale_is_reached_as_nearly_as_possible() -> None:
    best = PAPER.model_copy(update={"enjoyment": Enjoyment(item_mean=7.0, person_sd=0.5, item_sd=0.5)})
    assert scores(best).mean() > 6.95
    even = PAPER.model_copy(update={"enjoyment": Enjoyment(item_mean=6.0, person_sd=0.0, item_sd=0.0)})
    assert set(scores(even).ravel()) == {6}


def test_smooth_dances_are_rated_smoother_only_where_that_is_planted() -> None:
    people = cohort(100, 3)

    def mean(effects: Effects, condition: str) -> float:
        return float(np.mean([smoothness(effects, condition, p, stream(1, p.id)) for p in people]))

    assert mean(PAPER, "light-easy-on") - mean(PAPER, "light-easy-off") > 0.7
    assert len({mean(NONE, condition) for condition in CONDITIONS}) == 1
