"""The sum of all terms (Eq. 1)."""

from __future__ import annotations

from dataclasses import dataclass

from studykit.choreography.cost.term import CostTerm
from studykit.choreography.measures import Measures


@dataclass(frozen=True, slots=True)
class TotalCost:
    """Terms and their weights lambda; a term of your own joins them as one more pair.

    Parameters
    ----------
    weighted : tuple of (CostTerm, float)
        The terms with their weights.
    """

    weighted: tuple[tuple[CostTerm, float], ...]

    def cost(self, measures: Measures, *, width: float = 1.0) -> float:
        """Give Eq. 1."""
        return sum(weight * term.cost(measures, width=width) for term, weight in self.weighted if weight)

    def terms(self, measures: Measures) -> dict[str, float]:
        """Give every term by its name, unweighted, at its final tolerance."""
        return {term.name: term.cost(measures) for term, _ in self.weighted}
