"""The dance repeats as much, or as little, as asked (Eq. 6)."""

from __future__ import annotations

from dataclasses import dataclass

from studykit.choreography.cost.term import gaussian
from studykit.choreography.measures import Measures


@dataclass(frozen=True, kw_only=True, slots=True)
class VarietyCost:
    """How far the mean difference between the dance's segments is off its target, in the metric's unit."""

    target: float
    tolerance: float
    name: str = "variety"

    def cost(self, measures: Measures, *, width: float = 1.0) -> float:
        """Give Eq. 6."""
        return gaussian(measures.variety - self.target, self.tolerance * width)
