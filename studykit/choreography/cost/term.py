"""What every cost term is."""

from __future__ import annotations

import math
from typing import Protocol

from studykit.choreography.measures import Measures


class CostTerm(Protocol):
    """Something about a dance that can be right (0) or wrong (up to 1)."""

    @property
    def name(self) -> str:
        """The term's name in tables and traces."""
        ...

    def cost(self, measures: Measures, *, width: float = 1.0) -> float:
        """Give the cost, 0 to 1; `width` multiplies the tolerance while the search is still hot."""
        ...


def gaussian(deviation: float, tolerance: float) -> float:
    """Give 1 - exp(-deviation^2 / (2 tolerance^2)), the form of all terms of the paper.

    Examples
    --------
    >>> round(gaussian(1.0, 1.0), 4), gaussian(0.0, 1.0)
    (0.3935, 0.0)
    """
    return -math.expm1(-0.5 * (deviation / tolerance) ** 2)
