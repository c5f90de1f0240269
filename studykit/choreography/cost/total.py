"""The sum of all terms (Eq. 1)."""

from __future__ import annotations

from dataclasses import dataclass

from studykit.choreography.cost.block import BlockCost
from studykit.choreography.cost.term import CostTerm
from studykit.choreography.cost.transition import TransitionCost
from studykit.choreography.measures import Measures

Weighted = tuple[BlockCost | TransitionCost | CostTerm, float]


@dataclass(frozen=True, slots=True)
class TotalCost:
    """Terms and their weights lambda.

    Parameters
    ----------
    weighted : tuple of (term, float)
        The terms with their weights; a term of weight 0 is told, but costs nothing.
    """

    weighted: tuple[Weighted, ...]

    def cost(self, measures: Measures, *, width: float = 1.0) -> float:
        """Give Eq. 1."""
        return sum(weight * term.cost(measures, width=width) for term, weight in self.weighted if weight)

    def terms(self, measures: Measures) -> dict[str, float]:
        """Give every term by its name, unweighted, at its final tolerance."""
        return {term.name: term.cost(measures) for term, _ in self.weighted}

    @property
    def weights(self) -> dict[str, float]:
        """Every lambda, by the name of its term."""
        return {term.name: weight for term, weight in self.weighted}
