from __future__ import annotations

import math

import numpy as np
import pytest

from studykit.analysis.enjoyment import FIVE_ITEMS, cronbach_alpha, keyed, score
from studykit.core.errors import InputError
from studykit.protocol.questionnaire import PACES

MIDDLE: dict[str, float | None] = {item.name: 4 for item in PACES}


def test_up_to_two_answers_may_be_left_out() -> None:
    complete = score(MIDDLE | {"item_02": 6})
    assert complete is not None
    assert (complete.total, complete.answered, complete.version) == (74.0, 18, "PACES-18")
    prorated = score(MIDDLE | {"item_02": 6, "item_05": None, "item_18": math.nan})
    assert prorated is not None
    assert prorated.answered == 16
    assert prorated.total == pytest.approx(66.0 * 18 / 16)
    assert score({name: answer for name, answer in MIDDLE.items() if name > "item_03"}) is None


def test_the_short_form_needs_every_answer_and_is_named() -> None:
    short = score(MIDDLE, items=FIVE_ITEMS)
    assert short is not None
    assert (short.total, short.version) == (20.0, "5 items of PACES-18")
    assert score(MIDDLE | {"item_03": None}, items=FIVE_ITEMS) is None


@pytest.mark.parametrize("answer", [0, 8, 3.5])
def test_an_answer_off_the_scale_is_named(answer: float) -> None:
    with pytest.raises(InputError, match=r"item_07: the answer is .*whole number from 1 to 7"):
        score(MIDDLE | {"item_07": answer})


def test_alpha_of_items_that_agree_perfectly_is_one() -> None:
    assert cronbach_alpha(np.tile([[1.0], [4.0], [6.0]], (1, 18))) == pytest.approx(1.0)


@pytest.mark.parametrize(
    "table", [np.full((3, 18), 4.0), np.full((1, 18), 4.0), np.array([[1.0, 2.0], [3.0, np.nan]])]
)
def test_alpha_is_none_where_it_says_nothing(table: np.ndarray) -> None:
    assert cronbach_alpha(table) is None


def test_left_out_answers_are_nan_when_keyed() -> None:
    turned = keyed({"item_01": 2, "item_02": 2})
    assert turned[:2].tolist() == [6.0, 2.0]
    assert np.isnan(turned[2:]).all()
