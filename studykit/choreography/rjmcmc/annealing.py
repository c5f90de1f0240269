"""How hot the search is, and how wide its tolerances, over time."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from studykit.core.arrays import Floats, frozen

STOP_ITERATIONS = 50
STOP_TEMPERATURE = 0.05
"""The rule to stop is asked no earlier: a hot search betters its best so seldom that it would stop."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Annealing:
    """Temperature and width of the tolerances in each stage of a search.

    Parameters
    ----------
    temperatures : array_like, shape (stage,)
        t of Eq. 13; 0 accepts improvements only.
    widths : array_like, shape (stage,)
        What tolerances are multiplied by; ends at 1.
    stage_iterations : int
        Iterations in each stage.
    stop_below : float
        Change of the best cost over 50 iterations below which a cold search (t <= 0.05) stops; 0 never stops.
    """

    temperatures: Floats
    widths: Floats
    stage_iterations: int
    stop_below: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "temperatures", frozen(self.temperatures, shape=(None,), name="temperatures")
        )
        stages = len(self.temperatures)
        object.__setattr__(self, "widths", frozen(self.widths, shape=(stages,), name="widths"))

    @property
    def iterations(self) -> int:
        """Number of iterations in all stages."""
        return len(self.temperatures) * self.stage_iterations

    def longer(self, factor: int) -> Annealing:
        """Give the same temperatures with so many times the iterations."""
        return self if factor == 1 else replace(self, stage_iterations=self.stage_iterations * factor)

    @classmethod
    def geometric(cls, *, iterations: int, start: float, end: float, start_width: float) -> Annealing:
        """Cool by one factor a stage, in 100 stages; tolerances narrow likewise, until two thirds."""
        stages = 100
        progress = np.linspace(0.0, 1.0, stages)
        return cls(
            temperatures=start * (end / start) ** progress,
            widths=start_width ** (1.0 - np.minimum(progress / (2.0 / 3.0), 1.0)),
            stage_iterations=iterations // stages,
        )

    @classmethod
    def paper(cls) -> Annealing:
        """Cool as printed, by 0.01 every 1,000 iterations; stop when cold and 50 change the best by < 3 %."""
        temperatures = np.round(1.0 - 0.01 * np.arange(101), 2)
        return cls(temperatures=temperatures, widths=np.ones(101), stage_iterations=1000, stop_below=0.03)
