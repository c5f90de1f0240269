"""Segments follow one another without a jump (Eq. 4)."""

from __future__ import annotations

from dataclasses import dataclass

from studykit.choreography.cost.term import Form, together
from studykit.choreography.measures import Measures


@dataclass(frozen=True, kw_only=True, slots=True)
class TransitionCost:
    """How far joints jump where segments meet.

    Parameters
    ----------
    tolerance_m : float
        A displacement that counts as smooth.
    form : {"mean_of_costs", "printed"}
        "mean_of_costs" averages one cost a join, so every join that is mended counts. "printed" is Eq. 4 to
        the letter: one cost of the sum of squares, divided by the number of joins.
    """

    tolerance_m: float
    form: Form = "mean_of_costs"
    name: str = "transition"

    def cost(self, measures: Measures, *, width: float = 1.0) -> float:
        """Give the cost; 0 for a dance without a join."""
        jumps = measures.displacements_m
        if not jumps:
            return 0.0
        cost = together([jump / (self.tolerance_m * width) for jump in jumps], self.form)
        return cost / len(jumps) if self.form == "printed" else cost
