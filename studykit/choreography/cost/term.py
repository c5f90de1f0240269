"""What every cost term is, and how one is added."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, Protocol, runtime_checkable

from studykit.choreography.measures import Measures
from studykit.core.arrays import Floats

if TYPE_CHECKING:
    from studykit.choreography.dance_library import DanceLibrary

Form = Literal["mean_of_costs", "printed"]
"""How several deviations make one cost: the mean of one cost each, or one cost of their squares' sum."""


class CostTerm(Protocol):
    """Something about a dance that can be right (0) or wrong (up to 1).

    Any object like this can be a goal's further term. It is asked at every step, so the search runs in its
    plain implementation, which is some hundred times slower than the compiled one; a `SegmentTerm` is not.
    """

    @property
    def name(self) -> str:
        """The term's name in tables and traces."""
        ...

    @property
    def weight(self) -> float:
        """How much it counts (lambda of Eq. 1)."""
        ...

    def cost(self, measures: Measures, *, width: float = 1.0) -> float:
        """Give the cost, 0 to 1; `width` multiplies the tolerance while the search is still hot."""
        ...


@runtime_checkable
class SegmentTerm(Protocol):
    """Something that every segment has more or less of, and of which a dance shall have a certain amount.

    Parameters
    ----------
    name : str
        The term's name in tables and traces.
    weight : float
        How much it counts (lambda of Eq. 1).
    target, tolerance : float
        The mean over the segments of each block that is wanted, and the deviation from it that still counts
        as small (sigma).
    """

    name: str
    weight: float
    target: float
    tolerance: float

    def values(self, library: DanceLibrary) -> Floats:
        """Give how much each segment has, shape (segment,)."""
        ...


def gaussian(deviation: float, tolerance: float) -> float:
    """Give 1 - exp(-deviation^2 / (2 tolerance^2)), the form of all terms of the paper.

    Examples
    --------
    >>> round(gaussian(1.0, 1.0), 4), gaussian(0.0, 1.0)
    (0.3935, 0.0)
    """
    return -math.expm1(-0.5 * (deviation / tolerance) ** 2)


def together(deviations: list[float], form: Form) -> float:
    """Give one cost of several deviations, each in its tolerance.

    Examples
    --------
    >>> round(together([1.0, 0.0], "mean_of_costs"), 4), round(together([1.0, 0.0], "printed"), 4)
    (0.1967, 0.3935)
    """
    if form == "printed":
        return gaussian(math.hypot(*deviations), 1.0)
    return sum(gaussian(deviation, 1.0) for deviation in deviations) / len(deviations)
