"""Paired Bayes factors against the R package BayesFactor (bayes_factor.R)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studykit.analysis.bayes import bayes_factor

GOLDEN: dict[str, Any] = json.loads(Path(__file__).with_name("bayes_factor.json").read_text())


@pytest.mark.parametrize("case", GOLDEN["cases"], ids=lambda case: f"n={len(case['a'])}")
def test_factors_are_those_of_bayesfactor(case: dict[str, Any]) -> None:
    assert bayes_factor(np.array(case["a"]), np.array(case["b"])) == pytest.approx(case["factor"], rel=1e-5)
