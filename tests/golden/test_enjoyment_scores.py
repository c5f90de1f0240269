"""Scores of the enjoyment scale, worked out by hand and against the scoring file of the real data."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pingouin
import pytest

from studykit.analysis.enjoyment import FIVE_ITEMS, cronbach_alpha, keyed, score
from studykit.protocol.questionnaire import PACES

# Eleven of 18 items (two of five) have the pleasant pole on the left: 11 x 7 + 7 x 1 with 1 throughout,
# 11 x 1 + 7 x 7 with 7.
BY_HAND = {1: (84, 17), 4: (72, 20), 7: (60, 23)}


def answers(responses: list[int]) -> dict[str, float | None]:
    return {item.name: float(response) for item, response in zip(PACES, responses, strict=True)}


@pytest.mark.parametrize("everywhere", BY_HAND)
def test_one_answer_throughout(everywhere: int) -> None:
    long, short = (score(answers([everywhere] * 18), items=items) for items in (PACES, FIVE_ITEMS))
    assert long is not None
    assert short is not None
    assert (long.total, short.total) == BY_HAND[everywhere]


def test_scores_equal_the_worked_examples(shared_data: Callable[[str], Path]) -> None:
    scale = json.loads(shared_data("questionnaires/paces_scoring.json").read_text())
    assert [item["reverse"] for item in scale["items"]] == [item.is_reversed for item in PACES]
    for example in scale["examples"]:
        long = score(answers(example["responses"]))
        short = score(answers(example["responses"]), items=FIVE_ITEMS)
        assert long is not None
        assert short is not None
        assert long.total == pytest.approx(example["total_18"], rel=1e-12)
        assert short.total == pytest.approx(example["total_5"], rel=1e-12)
        assert long.item_mean == pytest.approx(example["mean_18"], abs=5e-7)
        for name, found in (
            ("percent_of_maximum_18", long.percent_of_maximum),
            ("percent_of_range_18", long.percent_of_range),
            ("percent_of_maximum_5", short.percent_of_maximum),
            ("percent_of_range_5", short.percent_of_range),
        ):
            assert found == pytest.approx(example[name], abs=5e-5)


def test_cronbachs_alpha_equals_pingouins() -> None:
    rng = np.random.default_rng(3)
    liking = rng.normal(4.0, 1.5, size=(25, 1))
    ticked = np.clip(np.rint(liking + rng.normal(0.0, 1.0, size=(25, 18))), 1, 7)
    turned = np.stack([keyed(answers(row.astype(int).tolist())) for row in ticked])
    items = {item.name: turned[:, place] for place, item in enumerate(PACES)}
    expected, _ = pingouin.cronbach_alpha(data=pd.DataFrame(items))
    assert cronbach_alpha(turned) == pytest.approx(expected, rel=1e-12)
