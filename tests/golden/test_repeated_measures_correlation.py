"""Correlations against the published example of rmcorr and against pingouin and SciPy."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pingouin
import pytest
from scipy import stats

from studykit.analysis.correlation import pearson, repeated_measures


def test_the_published_example() -> None:
    # pH and PaCO2 of 8 people (Bland & Altman 1995, in Bakdash & Marusich 2017); the numbers are those of
    # pingouin's documentation: r(38) = -0.50677, p = 0.000847, 95 % interval -0.71 to -0.23.
    table = pingouin.read_dataset("rm_corr")
    result = repeated_measures(table["Subject"].astype(str).tolist(), table["pH"], table["PacO2"])
    assert (result.n, result.participants, result.degrees_of_freedom) == (47, 8, 38)
    assert round(result.r, 5) == -0.50677
    assert result.p == pytest.approx(0.000847, abs=5e-7)
    assert result.interval == pytest.approx((-0.71, -0.23), abs=5e-3)


def test_it_equals_pingouins_columns() -> None:
    rng = np.random.default_rng(5)
    people = np.repeat([f"{number:02d}" for number in range(1, 11)], 4)
    level = np.repeat(rng.normal(size=10), 4)
    x = np.tile([80.0, 120.0, 180.0, 260.0], 10)
    y = 100.0 + 20.0 * level + 0.1 * x + rng.normal(0.0, 5.0, 40)
    table = pd.DataFrame({"person": people, "x": x, "y": y})
    found = pingouin.rm_corr(table, x="x", y="y", subject="person")
    assert list(found.columns) == ["r", "dof", "pval", "CI95", "power"]
    result = repeated_measures(people.tolist(), x, y)
    assert result.r == pytest.approx(found["r"].iloc[0], rel=1e-10)
    assert result.p == pytest.approx(found["pval"].iloc[0], rel=1e-8)
    assert result.degrees_of_freedom == found["dof"].iloc[0] == 29
    # pingouin prints its interval with two digits.
    assert result.interval is not None
    assert [round(limit, 2) for limit in result.interval] == list(found["CI95"].iloc[0])


def test_the_pooled_correlation_equals_scipys() -> None:
    rng = np.random.default_rng(6)
    x = rng.normal(size=30)
    y = x + rng.normal(size=30)
    expected = stats.pearsonr(x, y)
    limits = expected.confidence_interval(0.9)
    result = pearson(x, y, confidence=0.9)
    assert result.r == pytest.approx(expected.statistic, rel=1e-12)
    assert result.p == pytest.approx(expected.pvalue, rel=1e-9)
    assert result.interval == pytest.approx((limits.low, limits.high), rel=1e-9)
    assert result.warning is not None
