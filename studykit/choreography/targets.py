"""The words of a protocol become numbers on a library."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import get_args

import numpy as np

from studykit.choreography.cost.term import CostTerm, SegmentTerm
from studykit.choreography.dance import TargetsFrom
from studykit.choreography.dance_library import CHAIN_SEGMENTS, DanceLibrary
from studykit.choreography.goal import Block, Goal
from studykit.choreography.preset import PRESETS, Preset
from studykit.choreography.schedule import BlockPlan, Schedule
from studykit.core.errors import InputError
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.motion.joint_mask import JointMask, spare
from studykit.motion.segmentation import SEGMENT_S
from studykit.protocol.condition import Condition, Intensity, Variety
from studykit.protocol.study_protocol import DancePlan, StudyProtocol

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


LONGEST_S = 1200.0
"""Dances are at most as long as this."""


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
        If the duration is not a multiple of 4 s, or no segment spares the joints that are to be spared.
    """
    blocks = (
        BlockPlan(duration_s=plan.duration_s, intensity=condition.intensity, variety=condition.variety),
    )
    return scheduled(plan, blocks, library, name=str(condition), mask=spared_by(plan, library))


def spared_by(plan: DancePlan, library: DanceLibrary) -> JointMask | None:
    """Give the joints that every dance of a plan spares, if any."""
    if plan.spare is None:
        return None
    mask = spare(plan.spare.joints, weights=plan.spare.weight)
    return limited(mask, library, plan.spare.speed_percentile)


def limited(mask: JointMask, library: DanceLibrary, percentile: float) -> JointMask:
    """Give every spared joint without a limit that of the library: a percentile of its segments' peaks."""
    return mask.limited(library.speed_limits(percentile))


def scheduled(
    plan: DancePlan,
    schedule: Schedule,
    library: DanceLibrary,
    *,
    name: str,
    mask: JointMask | None = None,
    terms: tuple[SegmentTerm | CostTerm, ...] = (),
) -> Goal:
    """Turn blocks of a dance into numbers.

    Parameters
    ----------
    plan : DancePlan
        What the words mean, and how much each goal counts.
    schedule : tuple of BlockPlan
        The blocks.
    library : DanceLibrary
        What percentiles and shares are measured on.
    name : str
        Name of the dance; one that ends in "-off" does not ask for smooth joins.
    mask : JointMask or None
        Joints to be spared.
    terms : tuple of SegmentTerm or CostTerm
        Further terms.

    Raises
    ------
    InputError
        If a block is not a multiple of 4 s long, or a level lies outside its range.
    """
    if not schedule:
        raise InputError("there is no block", where="schedule", remedy="give one or more")
    total_s = sum(block.duration_s for block in schedule)
    if LONGEST_S < total_s < math.inf:
        raise InputError(
            f"{total_s:g} s are longer than dances can be",
            where="duration",
            remedy=f"ask for up to {LONGEST_S:g} s",
        )
    preset = PRESETS[plan.preset]
    if preset.masks_energies and mask is not None:
        mask = JointMask(weights=mask.weights)  # the printed mask has no limits
    blocks = tuple(_block(plan, block, library) for block in schedule)
    calibration = library.calibration
    is_cosine = preset.variety == "cosine"
    hard, easy = (_variety(plan, level, library) for level in ("hard", "easy"))
    if hard <= easy:
        raise InputError(
            f"hard dances have a variety of {hard:g} and easy ones of {easy:g}",
            where=library.name,
            remedy="have the dances rated again, or build the library again",
        )
    is_log = preset.intensity == "log"
    spreads = [spread / DEFAULT_BODY_MASS_KG for spread in _PAPER_SPREADS]
    return Goal(
        condition=name,
        blocks=blocks,
        linear_tolerance=plan.intensity.tolerance if is_log else spreads[0],
        rotational_tolerance=plan.intensity.tolerance if is_log else spreads[1],
        variety_tolerance=(
            float(calibration.chain_cosine_varieties.std())
            if is_cosine
            else plan.variety.tolerance * (hard - easy)
        ),
        transition_tolerance_m=(
            _PAPER_TRANSITION_TOLERANCE_M if preset.form == "printed" else calibration.transition_tolerance_m
        ),
        weights=_weights(plan, blocks, is_smooth=not name.endswith("-off")),
        preset=preset,
        targets_from=_targets_from(preset, library, schedule),
        mask=mask,
        terms=terms,
    )


def _weights(plan: DancePlan, blocks: tuple[Block, ...], *, is_smooth: bool) -> Mapping[str, float]:
    weights = plan.weights.model_dump()
    weights["mask"] = plan.spare.cost_weight if plan.spare is not None else MASK_WEIGHT
    if PRESETS[plan.preset].masks_energies:
        weights["mask"] = 0.0  # Eq. 11 alone: what spared joints do is left out, and costs nothing
    if not is_smooth:
        weights["transition"] = 0.0
    if all(block.segments < 2 for block in blocks):
        weights["variety"] = 0.0  # one segment has nothing to differ from
    return weights


MASK_WEIGHT = 0.2
"""How much the movement of spared joints counts where nothing else is said: limits protect, this prefers."""


def _block(plan: DancePlan, block: BlockPlan, library: DanceLibrary) -> Block:
    duration_s = block.duration_s
    is_finite = math.isfinite(duration_s)
    if not is_finite or duration_s <= 0.0 or duration_s % SEGMENT_S:
        segments = max(1, round(duration_s / SEGMENT_S)) if is_finite else CHAIN_SEGMENTS
        raise InputError(
            f"{duration_s:g} s is not a multiple of {SEGMENT_S:g} s",
            where="duration",
            remedy=f"ask for {segments * SEGMENT_S:g} s",
        )
    for where, word, known in (
        ("intensity", block.intensity, get_args(Intensity)),
        ("variety", block.variety, get_args(Variety)),
    ):
        if isinstance(word, str) and word not in known:
            raise InputError(f'there is no "{word}"', where=where, remedy=f"choose {' or '.join(known)}")
    linear, rotational = _energies(plan, block, library)
    # Chains are 32 s long; a block of another length asks for as much in each second.
    scale = duration_s / (CHAIN_SEGMENTS * SEGMENT_S)
    is_single = round(duration_s / SEGMENT_S) < 2
    return Block(
        duration_s=duration_s,
        linear_energy=linear * scale,
        rotational_energy=rotational * scale,
        variety=0.0 if is_single else _variety(plan, block.variety, library),
        novelty=_novelty(plan, block.variety, library),
    )


def _targets_from(preset: Preset, library: DanceLibrary, schedule: Schedule) -> TargetsFrom:
    if preset.intensity == "absolute":
        return "paper"
    words = any(isinstance(level, str) for block in schedule for level in (block.intensity, block.variety))
    return "raters" if words and library.calibration.rated is not None else "percentiles"


def _energies(plan: DancePlan, block: BlockPlan, library: DanceLibrary) -> tuple[float, float]:
    level = block.intensity
    if isinstance(level, str):
        if PRESETS[plan.preset].intensity == "absolute":
            linear, rotational = (energy / DEFAULT_BODY_MASS_KG for energy in PAPER_ENERGIES[level])
            return linear, rotational
        return library.calibration.energies_of(level, getattr(plan.intensity, level))
    if not 0.0 <= level <= 100.0:
        raise InputError(
            f"{level:g} is no percentile", where="intensity", remedy="say light, intense, or 0 to 100"
        )
    return library.calibration.energy_targets(level)


def _variety(plan: DancePlan, level: str | float, library: DanceLibrary) -> float:
    if PRESETS[plan.preset].variety == "cosine":
        if not isinstance(level, str):
            raise InputError(
                "the printed formulas know two levels of variety only",
                where="variety",
                remedy='say easy or hard, or use the preset "studykit"',
            )
        return _PAPER_COSINES[level]
    if isinstance(level, str):
        return library.calibration.variety_of(level, getattr(plan.variety, level))
    if not 0.0 < level <= 2.0:
        raise InputError(
            f"{level:g} is no share of the distance of unrelated segments",
            where="variety",
            remedy="say easy, hard, or a number above 0 and up to 2",
        )
    return level * library.calibration.median_distance


def _novelty(plan: DancePlan, level: str | float, library: DanceLibrary) -> float | None:
    """Choose how rarely segments come back, so that repetition alone gives the variety asked for.

    In an urn of concentration c, two segments of a dance are the same with probability 1 / (1 + c). Where
    dances without repetition are as alike as that (the 5th percentile of chains), nothing comes back.
    """
    if not PRESETS[plan.preset].copies:
        return math.inf
    calibration = library.calibration
    share = _variety(plan, level, library) / calibration.median_distance
    usual = float(np.percentile(calibration.chain_varieties, 5.0)) / calibration.median_distance
    if share >= min(1.0, usual):
        return None
    return share / (1.0 - share)
