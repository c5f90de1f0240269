from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from studykit.protocol.questionnaire import PACES, PACES_REVERSED


def test_eleven_items_have_their_pleasant_pole_on_the_left() -> None:
    assert [item.number for item in PACES] == list(range(1, 19))
    assert PACES_REVERSED == (1, 4, 5, 7, 9, 10, 11, 13, 14, 16, 17)
    assert PACES[0].name == "item_01"


def test_answers_are_turned_round_where_the_pleasant_pole_is_left() -> None:
    assert [PACES[0].keyed(answer) for answer in range(1, 8)] == [7, 6, 5, 4, 3, 2, 1]
    assert [PACES[1].keyed(answer) for answer in range(1, 8)] == [1, 2, 3, 4, 5, 6, 7]
    with pytest.raises(ValueError, match="between 1 and 7"):
        PACES[1].keyed(8)


def test_poles_differ_and_are_short() -> None:
    assert len({pole for item in PACES for pole in (item.left, item.right)}) == 36
    assert all(len(pole) < 30 for item in PACES for pole in (item.left, item.right))


def test_scores_of_published_examples(shared_data: Callable[[str], Path]) -> None:
    scoring = json.loads(shared_data("questionnaires/paces_scoring.json").read_text())
    assert tuple(scoring["reverse_scored_18"]) == PACES_REVERSED
    for example in scoring["examples"]:
        answers = zip(PACES, example["responses"], strict=True)
        assert sum(item.keyed(answer) for item, answer in answers) == example["total_18"], example["name"]


def test_a_happy_person_ticks_the_left_pole_of_reversed_items(shared_data: Callable[[str], Path]) -> None:
    scoring = json.loads(shared_data("questionnaires/paces_scoring.json").read_text())
    best = next(example for example in scoring["examples"] if example["name"] == "most enjoyable")
    assert [7 if item.keyed(7) == 7 else 1 for item in PACES] == best["responses"]
