"""Two one-sided tests against R's t.test and wilcox.test (equivalence.R)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studykit.analysis.equivalence import equivalence

GOLDEN: dict[str, Any] = json.loads(Path(__file__).with_name("equivalence.json").read_text())


@pytest.mark.parametrize("kind", ["by_t", "by_ranks"])
def test_p_and_interval_are_those_of_r(kind: str) -> None:
    found = getattr(
        equivalence(np.array(GOLDEN["a"]), np.array(GOLDEN["b"]), low=GOLDEN["low"], high=GOLDEN["high"]),
        kind,
    )
    expected = GOLDEN[kind]
    assert found.p_low == pytest.approx(expected["p_low"], abs=1e-10)
    assert found.p_high == pytest.approx(expected["p_high"], abs=1e-10)
    assert found.p == max(found.p_low, found.p_high)
    assert found.interval == pytest.approx(expected["interval"], abs=1e-8)
