"""What a dance shall be like, in numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from studykit.choreography.cost.duration import DurationCost
from studykit.choreography.cost.intensity import IntensityCost
from studykit.choreography.cost.total import TotalCost
from studykit.choreography.cost.transition import TransitionCost
from studykit.choreography.cost.variety import VarietyCost
from studykit.choreography.dance import TargetsFrom
from studykit.choreography.dance_library import CHAIN_SEGMENTS, DanceLibrary
from studykit.choreography.measures import Measures
from studykit.choreography.preset import PRESETS, Preset
from studykit.core.errors import InputError
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.motion.segmentation import SEGMENT_S
from studykit.protocol.condition import Condition, Intensity, Variety
from studykit.protocol.study_protocol import DancePlan, StudyProtocol

DURATION_TOLERANCE_S = 1.0
ENERGY_HIT = 0.05
"""A dance is as intense as asked when both energies are within this share of their targets."""

# Section 5.6 of the paper, in its unit: energies times body mass in kg.
PAPER_ENERGIES = {"light": (56.5, 31.8), "intense": (147.2, 106.5)}
"""Linear and rotational energy of a dance of 32 s that the paper prints as its targets (section 5.6)."""
PAPER_VARIETIES = {"easy": 67.4, "hard": 143.1}
"""Its targets of variety, read as mean distances of standardised features."""

_PAPER_SPREADS = (88.4, 48.0)
# 67.4 and 143.1 cannot be values of Eq. 5; they are read as distances of standardised features, of which
# unrelated vectors are sqrt(2 x 11640) = 152.6 apart: 1 - cos = (d / 152.6)^2.
_PAPER_COSINES = {level: distance**2 / 23280.0 for level, distance in PAPER_VARIETIES.items()}
_PAPER_TRANSITION_TOLERANCE_M = 0.03


@dataclass(frozen=True, kw_only=True, slots=True)
class Goal:
    """Targets, tolerances and weights of one dance.

    Parameters
    ----------
    condition : str
        Name of the condition, such as "light-easy-on".
    duration_s : float
        A multiple of 4 s.
    linear_energy, rotational_energy : float, J per kg
        Targets of the sums over all poses.
    variety : float
        Target of phi, in the metric's unit.
    linear_tolerance, rotational_tolerance : float
        On the preset's scale: shares of the target, or J per kg.
    variety_tolerance : float
        In the metric's unit; how far a dance may be off and still count as hit.
    transition_tolerance_m : float
        Displacement at a join that counts as smooth.
    novelty : float or None
        How rarely segments come back; see `rjmcmc.moves.MoveSet`.
    weights : dict of str to float
        lambda of Eq. 1, by term.
    preset : Preset
        How the formulas are read.
    targets_from : {"percentiles", "raters", "paper"}
        Who says what the words of the condition mean.
    """

    condition: str
    duration_s: float
    linear_energy: float
    rotational_energy: float
    variety: float
    linear_tolerance: float
    rotational_tolerance: float
    variety_tolerance: float
    transition_tolerance_m: float
    novelty: float | None
    weights: dict[str, float] = field(hash=False)
    preset: Preset
    targets_from: TargetsFrom

    @property
    def segments(self) -> int:
        """Number of segments that fill the duration."""
        return round(self.duration_s / SEGMENT_S)

    def objective(self) -> TotalCost:
        """Give the total cost that the search lowers."""
        preset = self.preset
        terms = (
            DurationCost(target_s=self.duration_s, tolerance_s=DURATION_TOLERANCE_S),
            TransitionCost(tolerance_m=self.transition_tolerance_m, form=preset.transition),
            VarietyCost(target=self.variety, tolerance=self.variety_tolerance),
            IntensityCost(
                name="linear",
                target=self.linear_energy,
                tolerance=self.linear_tolerance,
                scale=preset.intensity,
            ),
            IntensityCost(
                name="rotational",
                target=self.rotational_energy,
                tolerance=self.rotational_tolerance,
                scale=preset.intensity,
            ),
        )
        return TotalCost(tuple((term, self.weights[term.name]) for term in terms))

    def misses(self, measures: Measures) -> dict[str, float]:
        """Give what a dance misses, by how much of the target: its length, an energy, its variety.

        A term of weight 0 is not asked for and cannot be missed.
        """
        lambdas, have = self.weights, measures
        asked = (
            ("duration", 1.0, have.duration_s, self.duration_s, 1e-9),
            ("linear energy", lambdas["linear"], have.linear_energy, self.linear_energy, ENERGY_HIT),
            (
                "rotational energy",
                lambdas["rotational"],
                have.rotational_energy,
                self.rotational_energy,
                ENERGY_HIT,
            ),
            (
                "variety",
                lambdas["variety"],
                have.variety,
                self.variety,
                self.variety_tolerance / self.variety,
            ),
        )
        return {
            name: off
            for name, weight, achieved, target, allowed in asked
            if weight > 0.0 and (off := abs(achieved / target - 1.0)) > allowed
        }


def goals(protocol: StudyProtocol, library: DanceLibrary) -> dict[str, Goal]:
    """Turn a protocol's words into numbers on a library: one goal a condition.

    Targets of the preset "studykit" are percentiles and shares measured on the library; those of "paper" are
    the published constants.
    """
    return {label: goal(protocol.dance, Condition.parse(label), library) for label in protocol.order.labels}


def goal(plan: DancePlan, condition: Condition, library: DanceLibrary) -> Goal:
    """Turn one condition into numbers; see `goals`.

    Raises
    ------
    InputError
        If the duration is not a multiple of 4 s.
    """
    is_finite = math.isfinite(plan.duration_s)
    if not is_finite or plan.duration_s <= 0.0 or plan.duration_s % SEGMENT_S:
        segments = max(1, round(plan.duration_s / SEGMENT_S)) if is_finite else CHAIN_SEGMENTS
        raise InputError(
            f"{plan.duration_s:g} s is not a multiple of {SEGMENT_S:g} s",
            where="duration",
            remedy=f"ask for {segments * SEGMENT_S:g} s",
        )
    preset = PRESETS[plan.preset]
    weights = plan.weights.model_dump()
    if condition.transition == "off":
        weights["transition"] = 0.0
    if plan.duration_s < 2 * SEGMENT_S:
        weights["variety"] = 0.0  # one segment has nothing to differ from
    linear, rotational, tolerances = _energies(plan, condition.intensity, library)
    gap = _variety(plan, "hard", library) - _variety(plan, "easy", library)
    cosine = preset.variety == "cosine"
    return Goal(
        condition=str(condition),
        duration_s=plan.duration_s,
        linear_energy=linear,
        rotational_energy=rotational,
        variety=_variety(plan, condition.variety, library),
        linear_tolerance=tolerances[0],
        rotational_tolerance=tolerances[1],
        variety_tolerance=(
            float(library.calibration.chain_cosine_varieties.std())
            if cosine
            else plan.variety.tolerance * gap
        ),
        transition_tolerance_m=(
            _PAPER_TRANSITION_TOLERANCE_M
            if preset.transition == "printed"
            else library.calibration.transition_tolerance_m
        ),
        novelty=_novelty(plan, condition.variety, library),
        weights=weights,
        preset=preset,
        targets_from=_targets_from(preset, library),
    )


def _targets_from(preset: Preset, library: DanceLibrary) -> TargetsFrom:
    if preset.intensity == "absolute":
        return "paper"
    return "raters" if library.calibration.rated is not None else "percentiles"


def _energies(
    plan: DancePlan, level: Intensity, library: DanceLibrary
) -> tuple[float, float, tuple[float, float]]:
    if PRESETS[plan.preset].intensity == "absolute":
        linear, rotational = (energy / DEFAULT_BODY_MASS_KG for energy in PAPER_ENERGIES[level])
        spreads = (_PAPER_SPREADS[0] / DEFAULT_BODY_MASS_KG, _PAPER_SPREADS[1] / DEFAULT_BODY_MASS_KG)
        return linear, rotational, spreads
    percentile: float = getattr(plan.intensity, level)
    linear, rotational = library.calibration.energies_of(level, percentile)
    # Chains are 32 s long; a dance of another length asks for as much in each second.
    scale = plan.duration_s / (CHAIN_SEGMENTS * SEGMENT_S)
    return linear * scale, rotational * scale, (plan.intensity.tolerance, plan.intensity.tolerance)


def _variety(plan: DancePlan, level: Variety, library: DanceLibrary) -> float:
    if PRESETS[plan.preset].variety == "cosine":
        return _PAPER_COSINES[level]
    share: float = getattr(plan.variety, level)
    return library.calibration.variety_of(level, share)


def _novelty(plan: DancePlan, level: Variety, library: DanceLibrary) -> float | None:
    """Choose how rarely segments come back, so that repetition alone gives the variety asked for.

    In an urn of concentration c, two segments of a dance are the same with probability 1 / (1 + c). Where
    dances without repetition are as alike as that (the 5th percentile of chains), nothing comes back.
    """
    if not PRESETS[plan.preset].copies:
        return math.inf
    calibration = library.calibration
    share = _variety(plan, level, library) / calibration.median_distance
    if share >= min(
        1.0, float(np.percentile(calibration.chain_varieties, 5.0)) / calibration.median_distance
    ):
        return None
    return share / (1.0 - share)
