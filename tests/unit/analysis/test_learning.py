from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from studykit.analysis.learning import learning
from studykit.analysis.tables import DANCED_AGAIN


def repeated(slopes: list[float], *, repetitions: int = 3, seed: int = 0) -> pd.DataFrame:
    rng = np.random.default_rng(seed)
    rows = [
        {
            "participant": f"{person:02d}",
            "session": "01",
            "condition": condition,
            "repetition": number,
            "dtw_m": level + slope * number + 0.001 * rng.normal() * (repetitions > 3),
            "is_valid": number == repetitions,
            "exclusion_reason": None if number == repetitions else DANCED_AGAIN,
        }
        for person, slope in enumerate(slopes)
        for condition, level in (("light-easy-on", 0.05), ("intense-hard-on", 0.1))
        for number in range(1, repetitions + 1)
    ]
    return pd.DataFrame(rows)


def test_the_slope_is_the_mean_over_people_and_conditions_do_not_count() -> None:
    slopes = [-0.01, -0.02, -0.006]
    found = learning(repeated(slopes))
    assert found is not None
    assert found.slope == pytest.approx(np.mean(slopes))
    assert found.n == 3
    expected = stats.ttest_1samp(slopes, 0.0)
    assert found.p == pytest.approx(expected.pvalue)
    assert found.interval == pytest.approx(tuple(expected.confidence_interval(0.95)))


def test_people_slopes_are_those_of_least_squares_with_a_mean_for_each_condition() -> None:
    table = repeated([-0.01, 0.004], repetitions=6, seed=3)
    by_hand = []
    for _, person in table.groupby("participant"):
        design = np.column_stack(
            [person["repetition"], *(person["condition"] == name for name in person["condition"].unique())]
        ).astype(float)
        by_hand.append(np.linalg.lstsq(design, person["dtw_m"].to_numpy(), rcond=None)[0][0])
    found = learning(table)
    assert found is not None
    assert found.slope == pytest.approx(np.mean(by_hand))


def test_a_trial_left_out_for_another_reason_teaches_nothing() -> None:
    table = repeated([-0.01, -0.02])
    table.loc[0, ["exclusion_reason", "dtw_m"]] = ["interrupted", 9.0]
    found = learning(table)
    assert found is not None
    assert found.slope == pytest.approx(-0.015)


def test_without_repetitions_nothing_is_known_of_learning() -> None:
    assert learning(repeated([-0.01, -0.02], repetitions=1)) is None
    assert learning(repeated([-0.01])) is None
