"""The dance lasts as long as asked (Eq. 2)."""

from __future__ import annotations

from dataclasses import dataclass

from studykit.choreography.cost.term import gaussian
from studykit.choreography.measures import Measures


@dataclass(frozen=True, kw_only=True, slots=True)
class DurationCost:
    """How far the dance's length is off, in seconds."""

    target_s: float
    tolerance_s: float
    name: str = "duration"

    def cost(self, measures: Measures, *, width: float = 1.0) -> float:
        """Give Eq. 2."""
        return gaussian(measures.duration_s - self.target_s, self.tolerance_s * width)
