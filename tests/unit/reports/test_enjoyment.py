from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from studykit.analysis.enjoyment import FIVE_ITEMS, cronbach_alpha, keyed
from studykit.protocol.questionnaire import PACES
from studykit.reports.analyse import enjoyment_of


def answers(people: int, *, seed: int = 0) -> pd.DataFrame:
    rng = np.random.default_rng(seed)
    liking = rng.normal(5.0, 1.0, size=people)
    table = pd.DataFrame({"participant_id": [f"sub-{n:02d}" for n in range(1, people + 1)]})
    for item in PACES:
        liked = np.clip(np.rint(liking + rng.normal(0.0, 0.7, size=people)), 1, 7)
        table[item.name] = [float(item.keyed(int(value))) for value in liked]
    return table


def test_the_five_items_are_scored_beside_all_18_in_both_percentages() -> None:
    table = answers(12)
    found = enjoyment_of(table)
    for scored, items in ((found, PACES), (found["five_items"], FIVE_ITEMS)):
        turned = np.array([keyed(dict(row), items=items) for _, row in table.iterrows()])
        assert scored["participants"] == 12
        assert scored["mean"]["total"] == pytest.approx(turned.sum(axis=1).mean())
        assert scored["mean"]["percent_of_maximum"] == pytest.approx(100.0 * turned.mean() / 7.0)
        assert scored["mean"]["percent_of_range"] == pytest.approx(100.0 * (turned.mean() - 1.0) / 6.0)
        assert scored["cronbach_alpha"] == pytest.approx(cronbach_alpha(turned))
    assert found["five_items"]["version"].startswith("5 items")


def test_who_left_out_one_of_the_five_counts_among_the_18_only() -> None:
    table = answers(6)
    table.loc[2, FIVE_ITEMS[0].name] = np.nan
    found = enjoyment_of(table)
    assert (found["participants"], found["left_out"]) == (6, 0)
    assert (found["five_items"]["participants"], found["five_items"]["left_out"]) == (5, 1)


def test_without_answers_there_is_nobody() -> None:
    found = enjoyment_of(answers(0))
    assert found == {"participants": 0, "five_items": {"participants": 0}}
