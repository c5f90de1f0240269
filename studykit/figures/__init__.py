"""Tables and arrays in, matplotlib figures out."""

from studykit.figures.goals import asked_and_achieved, heart_rate_against_energy, movement_against_variety
from studykit.figures.outcomes import (
    heart_rate_by_condition,
    movement_by_condition,
    smoothness_by_condition,
)
from studykit.figures.strips import DanceStrip, four_dances

__all__ = [
    "DanceStrip",
    "asked_and_achieved",
    "four_dances",
    "heart_rate_against_energy",
    "heart_rate_by_condition",
    "movement_against_variety",
    "movement_by_condition",
    "smoothness_by_condition",
]
