"""Krippendorff's own worked example, as he printed it."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.analysis.agreement import krippendorff_alpha

# Krippendorff (2011), "Computing Krippendorff's Alpha-Reliability": four observers, twelve units.
_ = np.nan
OBSERVERS = [
    [1, 2, 3, 3, 2, 1, 4, 1, 2, _, _, _],
    [1, 2, 3, 3, 2, 2, 4, 1, 2, 5, _, 3],
    [_, 3, 3, 3, 2, 3, 4, 2, 2, 5, 1, _],
    [1, 2, 3, 3, 2, 4, 4, 1, 2, 5, 1, _],
]


@pytest.mark.parametrize(
    ("level", "printed"), [("nominal", 0.743), ("ordinal", 0.815), ("interval", 0.849), ("ratio", 0.797)]
)
def test_krippendorffs_example_gives_what_he_printed(level, printed) -> None:
    told = krippendorff_alpha(OBSERVERS, level=level, replicates=200)
    assert told.alpha == pytest.approx(printed, abs=5e-4)
    assert told.interval[0] < told.alpha < told.interval[1]
    # The twelfth unit was rated once: 11 units and 40 values remain.
    assert (told.raters, told.units, told.ratings) == (4, 11, 40)
