"""What a dance shall be like, in numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from studykit.choreography.cost.block import BlockCost
from studykit.choreography.cost.mask import mask_tolerance
from studykit.choreography.cost.term import CostTerm, SegmentTerm
from studykit.choreography.cost.total import TotalCost, Weighted
from studykit.choreography.cost.transition import TransitionCost
from studykit.choreography.dance import DanceMeasures, TargetsFrom
from studykit.choreography.dance_library import CHAIN_SEGMENTS, DanceLibrary
from studykit.choreography.measures import Measures, mean_variety
from studykit.choreography.preset import Preset
from studykit.core.arrays import Floats
from studykit.motion.joint_mask import JointMask
from studykit.motion.segmentation import SEGMENT_S

DURATION_TOLERANCE_S = 1.0
ENERGY_HIT = 0.05
"""A dance is as intense as asked when both energies are within this share of their targets."""

CLOSE = 0.4
"""Of dances that are as asked, those are preferred that miss by no more than this share of what they may."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Block:
    """Targets of one stretch of a dance; most dances have one.

    Parameters
    ----------
    duration_s : float
        A multiple of 4 s.
    linear_energy, rotational_energy : float, J per kg
        Targets of the sums over its poses.
    variety : float
        Target of phi, in the metric's unit; 0 where a single segment has nothing to differ from.
    novelty : float or None
        How rarely segments come back; see `rjmcmc.moves.Moves`.
    """

    duration_s: float
    linear_energy: float
    rotational_energy: float
    variety: float
    novelty: float | None

    @property
    def segments(self) -> int:
        """Number of segments that fill the duration."""
        return round(self.duration_s / SEGMENT_S)

    @property
    def measures(self) -> DanceMeasures:
        """The targets as measures of a dance."""
        return DanceMeasures(
            duration_s=self.duration_s,
            linear_energy=self.linear_energy,
            rotational_energy=self.rotational_energy,
            variety=self.variety,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Goal:
    """Targets, tolerances and weights of one dance.

    Parameters
    ----------
    condition : str
        Name of the condition or of the dance, such as "light-easy-on".
    blocks : tuple of Block
        Targets, one block after the other.
    linear_tolerance, rotational_tolerance : float
        On the preset's scale: shares of the target, or J per kg in 32 s.
    variety_tolerance : float
        In the metric's unit; how far a dance may be off and still count as hit.
    transition_tolerance_m : float
        Displacement at a join that counts as smooth.
    weights : mapping of str to float
        lambda of Eq. 1, by term: duration, transition, variety, linear, rotational, mask.
    preset : Preset
        How the formulas are read.
    targets_from : {"percentiles", "raters", "paper"}
        Who says what the words of the condition mean.
    mask : JointMask or None
        Joints that are spared.
    terms : tuple of SegmentTerm or CostTerm
        Further terms.
    note : str
        What else a reader of the dance must know, such as that these are the nearest values to a goal out of
        reach.
    """

    condition: str
    blocks: tuple[Block, ...]
    linear_tolerance: float
    rotational_tolerance: float
    variety_tolerance: float
    transition_tolerance_m: float
    weights: Mapping[str, float] = field(hash=False)
    preset: Preset
    targets_from: TargetsFrom
    mask: JointMask | None = None
    terms: tuple[SegmentTerm | CostTerm, ...] = ()
    note: str = ""

    @property
    def counted(self) -> Floats | None:
        """Share of each joint's turning that counts for the energy, shape (24,); None if all of it."""
        return self.mask.weights if self.mask is not None and self.preset.masks_energies else None

    @property
    def spared(self) -> str:
        """Names of the joints that are spared, for a sentence."""
        return ", ".join(self.mask.spared) if self.mask is not None else ""

    @property
    def segments(self) -> int:
        """Number of segments of the whole dance."""
        return sum(block.segments for block in self.blocks)

    @property
    def duration_s(self) -> float:
        """Length of the whole dance."""
        return sum(block.duration_s for block in self.blocks)

    @property
    def measures(self) -> DanceMeasures:
        """The targets of the whole dance."""
        return DanceMeasures(
            duration_s=self.duration_s,
            linear_energy=sum(block.linear_energy for block in self.blocks),
            rotational_energy=sum(block.rotational_energy for block in self.blocks),
            variety=mean_variety(
                tuple(block.variety for block in self.blocks), tuple(block.segments for block in self.blocks)
            ),
        )

    def objective(self, library: DanceLibrary) -> TotalCost:
        """Give the total cost that the search lowers; all but the transition term are `BlockCost`."""
        blocks, preset = self.blocks, self.preset
        shares = tuple(block.segments / CHAIN_SEGMENTS for block in blocks)
        each = (1.0,) * len(blocks)

        def term(
            name: str, targets: tuple[float, ...], tolerance: float, widths: tuple[float, ...]
        ) -> Weighted:
            # On the logarithm a tolerance is a share; otherwise it belongs to a dance of 32 s.
            scale = preset.intensity if name in ("linear", "rotational") else "absolute"
            tolerances = tuple(tolerance * width for width in (each if scale == "log" else widths))
            cost = BlockCost(name=name, targets=targets, tolerances=tolerances, scale=scale, form=preset.form)
            return cost, self.weights[name]

        weighted: list[Weighted] = [
            term("duration", tuple(block.duration_s for block in blocks), DURATION_TOLERANCE_S, each),
            term("variety", tuple(block.variety for block in blocks), self.variety_tolerance, each),
            term("linear", tuple(b.linear_energy for b in blocks), self.linear_tolerance, shares),
            term("rotational", tuple(b.rotational_energy for b in blocks), self.rotational_tolerance, shares),
        ]
        if self.mask is not None:
            counts = tuple(float(block.segments) for block in blocks)
            weighted.append(term("mask", (0.0,) * len(blocks), mask_tolerance(library, self.mask), counts))
        for own in self.terms:
            if isinstance(own, SegmentTerm):
                cost = BlockCost(
                    name=own.name,
                    targets=tuple(own.target * block.segments for block in blocks),
                    tolerances=tuple(own.tolerance * block.segments for block in blocks),
                    form=preset.form,
                )
                weighted.append((cost, self.weights.get(own.name, own.weight)))
            else:
                weighted.append((own, own.weight))
        transition = TransitionCost(tolerance_m=self.transition_tolerance_m, form=preset.form)
        return TotalCost((*weighted, (transition, self.weights["transition"])))

    def misses(self, measures: Measures, *, share: float = 1.0) -> dict[str, float]:
        """Give what a dance misses, by how much of the target: its length, an energy, its variety.

        A term of weight 0 is not asked for and cannot be missed. `share` narrows what counts as hit.
        """
        allowed = {"duration": 1e-9, "linear": ENERGY_HIT, "rotational": ENERGY_HIT}
        missed = {}
        for number, block in enumerate(self.blocks):
            targets = {
                "duration": block.duration_s,
                "linear": block.linear_energy,
                "rotational": block.rotational_energy,
                "variety": block.variety,
            }
            of_block = f" of block {number + 1}" if len(self.blocks) > 1 else ""
            for name, target in targets.items():
                off = abs(measures.blocks[name][number] - target)
                limit = allowed.get(name, math.nan) * target
                if name == "variety":
                    limit = self.variety_tolerance
                if self.weights[name] > 0.0 and target > 0.0 and off > share * limit:
                    missed[f"{_WORDS[name]}{of_block}"] = off / target
        return missed


_WORDS = {
    "duration": "duration",
    "linear": "linear energy",
    "rotational": "rotational energy",
    "variety": "variety",
}
