from __future__ import annotations

from typing import Any

import pytest

from studykit.core.errors import InputError
from studykit.session.steps.question import ITEMS, check

PACES = dict.fromkeys(ITEMS["paces"], 4)
DEMOGRAPHICS: dict[str, Any] = {
    "age": 30,
    "sex": "F",
    "height_m": 1.7,
    "weight_kg": 65.0,
    "dance_experience_years": 0,
}


def test_whole_answers_are_accepted() -> None:
    check("smoothness", {"rating": 7})
    check("paces", PACES)
    check("demographics", DEMOGRAPHICS)


@pytest.mark.parametrize(
    ("questionnaire", "answers", "message"),
    [
        ("smoothness", {}, "smoothness: the item rating is missing; answer rating."),
        ("smoothness", {"rating": 5, "speed": 5}, "the item speed is unknown"),
        ("smoothness", {"rating": 8}, "smoothness: rating is 8; tick 1 to 7."),
        ("smoothness", {"rating": True}, "rating is True"),
        ("paces", PACES | {"item_07": 0}, "item_07 is 0"),
        ("paces", PACES | {"item_07": 4.5}, "item_07 is 4.5"),
        ("demographics", DEMOGRAPHICS | {"sex": "x"}, "sex is 'x'; write F, M, O or n/a."),
        ("demographics", DEMOGRAPHICS | {"age": -1}, "age is -1; write a number."),
        ("demographics", DEMOGRAPHICS | {"age": "thirty"}, "age is 'thirty'"),
    ],
)
def test_other_answers_are_refused(questionnaire: str, answers: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        check(questionnaire, answers)
    assert message in str(caught.value)
