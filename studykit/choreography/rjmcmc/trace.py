"""How a search went, stage by stage."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any


@dataclass(frozen=True, kw_only=True, slots=True)
class TraceRow:
    """Where a search stood at the end of a stage.

    Parameters
    ----------
    iteration : int
        Iterations done.
    temperature, width : float
        Of the annealing.
    cost, best_cost : float
        Eq. 1 at the present width, and the lowest so far at the final one (infinite while no dance was met
        that keeps what must be kept).
    segments : int
        Of the dance at that time.
    accepted : float
        Share of the iterations that changed the dance.
    inserted, removed, replaced : float or None
        Share of such moves that were accepted; None where none was tried.
    terms : dict of str to float
        Every term of the dance at that time, unweighted, at its final tolerance.
    """

    iteration: int
    temperature: float
    width: float
    cost: float
    best_cost: float
    segments: int
    accepted: float
    inserted: float | None = None
    removed: float | None = None
    replaced: float | None = None
    terms: dict[str, float]

    def to_dict(self) -> dict[str, Any]:
        """Give the row as plain values for JSON, which knows no infinity."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return values | {"best_cost": self.best_cost if math.isfinite(self.best_cost) else None}

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> TraceRow:
        """Undo `to_dict`."""
        best = values["best_cost"]
        return cls(**values | {"best_cost": math.inf if best is None else best})
