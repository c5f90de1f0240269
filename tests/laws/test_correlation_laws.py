"""What must hold of correlations whatever the data."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studykit.analysis.correlation import pearson, repeated_measures


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 8), st.integers(3, 6), st.floats(-1e3, 1e3))
def test_levels_of_people_units_and_order_do_not_matter(
    seed: int, people: int, trials: int, shift: float
) -> None:
    rng = np.random.default_rng(seed)
    who = np.repeat([f"{number:02d}" for number in range(people)], trials)
    x, y = rng.normal(size=(2, people * trials))
    result = repeated_measures(who.tolist(), x, y)
    levels = np.repeat(shift * rng.normal(size=people), trials)
    order = rng.permutation(len(x))
    moved = repeated_measures(who[order].tolist(), 3.0 * x[order] - 1.0, (y + levels)[order])
    assert moved.r == pytest.approx(result.r, abs=1e-9)
    assert repeated_measures(who.tolist(), x, -y).r == pytest.approx(-result.r)
    assert -1.0 <= result.r <= 1.0
    assert result.interval is None or result.interval[0] <= result.r <= result.interval[1]


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(4, 20))
def test_the_pooled_correlation_ignores_units(seed: int, trials: int) -> None:
    x, y = np.random.default_rng(seed).normal(size=(2, trials))
    assert pearson(2.0 * x + 5.0, y).r == pytest.approx(pearson(x, y).r)
    assert pearson(x, x).r == pytest.approx(1.0)
    assert pearson(x, x).p < 1e-9
