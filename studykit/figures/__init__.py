"""Tables and arrays in, matplotlib figures out."""

from studykit.figures.goals import asked_and_achieved as asked_and_achieved
from studykit.figures.outcomes import heart_rate_by_condition as heart_rate_by_condition
from studykit.figures.outcomes import movement_by_condition as movement_by_condition
from studykit.figures.outcomes import smoothness_by_condition as smoothness_by_condition
from studykit.figures.relations import heart_rate_against_energy as heart_rate_against_energy
from studykit.figures.relations import movement_against_variety as movement_against_variety
from studykit.figures.strips import DanceStrip as DanceStrip
from studykit.figures.strips import four_dances as four_dances
