"""The dance is as intense as asked, in travelling (Eq. 9) and in turning (Eq. 12)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from studykit.choreography.cost.term import gaussian
from studykit.choreography.measures import Measures


@dataclass(frozen=True, kw_only=True, slots=True)
class IntensityCost:
    """How far one of the two kinetic energies is off its target.

    Parameters
    ----------
    name : {"linear", "rotational"}
        Which energy.
    target : float
        J per kg, summed over the poses of the dance.
    tolerance : float
        On the scale in use: a share of the target ("log"), or J per kg ("absolute").
    scale : {"log", "absolute"}
        "log" compares logarithms: energies are positive and skewed. "absolute" is Eq. 9 and 12 as printed.
    """

    name: Literal["linear", "rotational"]
    target: float
    tolerance: float
    scale: Literal["log", "absolute"] = "log"

    def cost(self, measures: Measures, *, width: float = 1.0) -> float:
        """Give Eq. 9 or 12."""
        energy = measures.linear_energy if self.name == "linear" else measures.rotational_energy
        if self.scale == "absolute":
            return gaussian(energy - self.target, self.tolerance * width)
        return gaussian(math.log(energy / self.target), self.tolerance * width) if energy > 0.0 else 1.0
