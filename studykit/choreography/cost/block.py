"""Each block of a dance is as long (Eq. 2), as varied (Eq. 6) and as intense (Eq. 9, 12, 14) as asked."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from studykit.choreography.cost.term import Form, together
from studykit.choreography.measures import Measures

Scale = Literal["log", "absolute"]


@dataclass(frozen=True, kw_only=True, slots=True)
class BlockCost:
    """How far one measure is off its target, block by block; most dances have one block.

    Parameters
    ----------
    name : str
        Which measure: "duration", "variety", "linear", "rotational", "mask" or a term of one's own.
    targets : tuple of float
        One a block, in the measure's unit.
    tolerances : tuple of float
        One a block: in the measure's unit ("absolute"), or a share of the target ("log").
    scale : {"absolute", "log"}
        "log" compares logarithms: energies are positive and skewed. "absolute" is as the paper prints it.
    form : {"mean_of_costs", "printed"}
        "mean_of_costs" averages one cost a block, so every block that is mended counts; "printed" is Eq. 14:
        one cost of the sum of squares. With one block they are the same.
    """

    name: str
    targets: tuple[float, ...]
    tolerances: tuple[float, ...]
    scale: Scale = "absolute"
    form: Form = "mean_of_costs"

    def cost(self, measures: Measures, *, width: float = 1.0) -> float:
        """Give the cost of Eq. 2, 6, 9, 12 or 14."""
        triples = zip(measures.blocks[self.name], self.targets, self.tolerances, strict=True)
        return together(
            [self._deviation(value, target) / (tolerance * width) for value, target, tolerance in triples],
            self.form,
        )

    def _deviation(self, value: float, target: float) -> float:
        if self.scale == "absolute":
            return value - target
        return math.log(value / target) if value > 0.0 else math.inf
