"""Tables and arrays in, matplotlib figures out."""

from studykit.figures.film import film_strip as film_strip
from studykit.figures.film import film_strips as film_strips
from studykit.figures.goals import asked_and_achieved as asked_and_achieved
from studykit.figures.goals import targets_and_achieved as targets_and_achieved
from studykit.figures.hits import hit_rates as hit_rates
from studykit.figures.joint_map import joint_intensity_map as joint_intensity_map
from studykit.figures.joints import joint_intensity as joint_intensity
from studykit.figures.library import energy_distribution as energy_distribution
from studykit.figures.library import target_space as target_space
from studykit.figures.library import variety_distribution as variety_distribution
from studykit.figures.noise import cleaning as cleaning
from studykit.figures.noise import yield_by_take as yield_by_take
from studykit.figures.outcomes import heart_rate_by_condition as heart_rate_by_condition
from studykit.figures.outcomes import movement_by_condition as movement_by_condition
from studykit.figures.outcomes import smoothness_by_condition as smoothness_by_condition
from studykit.figures.profile import energy_profile as energy_profile
from studykit.figures.relations import heart_rate_against_energy as heart_rate_against_energy
from studykit.figures.relations import movement_against_variety as movement_against_variety
from studykit.figures.search import search_trace as search_trace
from studykit.figures.strips import DanceStrip as DanceStrip
from studykit.figures.strips import four_dances as four_dances
