"""Dances: what was asked for, what was found, and the movement itself."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any, Literal

from studykit.choreography.rjmcmc.trace import TraceRow
from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_value
from studykit.motion import energy, kinematics
from studykit.motion.blending import Blend
from studykit.motion.joint_mask import JointMask
from studykit.motion.motion import Motion
from studykit.motion.segmentation import SEGMENT_FRAMES, SEGMENT_S

VERSION = 2


TargetsFrom = Literal["percentiles", "raters", "paper"]


@dataclass(frozen=True, kw_only=True, slots=True)
class DanceSegment:
    """One segment of a dance and where it comes from; `spliced_from` names the take of a limb put in."""

    id: int
    take: str
    start_s: float
    mirrored: bool
    licence: str
    spliced_from: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class DanceMeasures:
    """What a dance asks of a dancer.

    Parameters
    ----------
    duration_s : float
        Length.
    linear_energy, rotational_energy : float, J per kg
        Sums of Eq. 8 and 11 over all poses; times the body mass they are in the paper's unit.
    variety : float
        phi of Eq. 5, in the metric of the preset; of several blocks their mean, a longer one counting for
        more.
    """

    duration_s: float
    linear_energy: float
    rotational_energy: float
    variety: float

    def to_dict(self) -> dict[str, float]:
        """Give the measures by name."""
        return {name: getattr(self, name) for name in self.__slots__}


@dataclass(frozen=True, kw_only=True, slots=True)
class Animation:
    """How segments become a movement; see `motion.animation.animate`.

    Parameters
    ----------
    blend : {"offset", "bridge"}
        How they are joined.
    is_cleaned : bool
        Whether joins are smoothed and standing feet held; a first look leaves that out.
    stage_m : (float, float), m, or None
        Width and depth that the dance keeps to.
    """

    blend: Blend
    is_cleaned: bool
    stage_m: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.stage_m is not None and not all(0.0 < side < math.inf for side in self.stage_m):
            raise InputError(
                f"a stage of {self.stage_m[0]:g} x {self.stage_m[1]:g} m",
                where="stage_m",
                remedy="give its width and depth, both above 0",
            )

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Animation:
        """Undo `dataclasses.asdict`, also after JSON."""
        stage = values["stage_m"]
        return cls(
            blend=values["blend"],
            is_cleaned=values["is_cleaned"],
            stage_m=None if stage is None else (float(stage[0]), float(stage[1])),
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class DanceBlock:
    """One stretch of a dance: targets; measures within its segments; and of the movement as shown."""

    asked: DanceMeasures
    achieved: DanceMeasures
    achieved_blended: DanceMeasures


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Dance:
    """A dance, ready to be shown, with all that a statistician may ask about it.

    Parameters
    ----------
    condition : str
        Name of the condition.
    seed : int
        Seed of the search.
    preset : str
        Reading of the formulas.
    targets_from : {"percentiles", "raters", "paper"}
        Who says what the words of the condition mean.
    segments : tuple of DanceSegment
        What it is made of.
    motion : Motion
        The blended movement, 30 frames a second.
    asked, achieved, achieved_blended : DanceMeasures
        Targets; exact measures within the segments; measures of the movement as shown (its variety is that of
        the segments).
    blocks : tuple of DanceBlock
        The same by block; most dances have one.
    mask : JointMask or None
        Joints that are spared.
    cost_total : float
        Eq. 1.
    cost_terms, weights : dict of str to float
        Every term, unweighted, and its lambda.
    displacements_m : tuple of float
        Eq. 3 at each join, before blending.
    variety_error : float
        By how much the search was wrong about the variety, where it was guided by reduced features.
    chain_costs : tuple of float
        Cost of the best dance of each chain of the search.
    trace : tuple of TraceRow
        How the best chain went.
    library_sha256 : str
        The library's digest.
    is_synthetic : bool
        Whether any segment was made up rather than danced by a person.
    animation : Animation
        How segments became the movement.
    note : str
        What else a reader must know, such as that what was asked at first was out of reach.
    is_interrupted : bool
        Whether the search was stopped before its end, and this is the best so far.
    version : int
        Of the way in which segments become a movement, and of the dance's file.
    """

    condition: str
    seed: int
    preset: str
    targets_from: TargetsFrom
    segments: tuple[DanceSegment, ...]
    motion: Motion
    asked: DanceMeasures
    achieved: DanceMeasures
    achieved_blended: DanceMeasures
    blocks: tuple[DanceBlock, ...]
    mask: JointMask | None = None
    cost_total: float
    cost_terms: dict[str, float]
    weights: dict[str, float]
    displacements_m: tuple[float, ...]
    variety_error: float = 0.0
    chain_costs: tuple[float, ...]
    trace: tuple[TraceRow, ...]
    library_sha256: str
    is_synthetic: bool
    animation: Animation
    note: str = ""
    is_interrupted: bool = False
    version: int = VERSION

    @property
    def distinct_segments(self) -> int:
        """How many different segments the dance has."""
        return len({segment.id for segment in self.segments})

    @property
    def sha256(self) -> str:
        """Digest of what determines the movement: the library, the segments, how they were joined."""
        joined = {}
        if self.version > 1:
            # Smoothing leaves spared joints alone, so what is spared changes the movement.
            spared = None if self.mask is None else self.mask.to_dict()
            joined = {"animation": asdict(self.animation), "spared": spared}
        return sha256_of_value(
            {
                "version": self.version,
                "condition": self.condition,
                "library_sha256": self.library_sha256,
                "segments": [segment.id for segment in self.segments],
                **joined,
            }
        )

    def joints(self) -> dict[str, dict[str, float | bool | None]]:
        """Tell what the dance as shown asks of each joint.

        Returns
        -------
        dict
            By name: `peak_rad_s` and `mean_rad_s` (angular speed relative to the parent), `angle_rad`
            (furthest from rest), `energy` (rotational, J per kg, summed over the poses), `limit_rad_s` and
            `angle_limit_rad` (None where there is none), and `is_kept` (whether both limits are kept).
        """
        turned, rate = self.motion.rotations, self.motion.frame_rate_hz
        speeds = kinematics.angular_speeds(turned, rate)
        angles = kinematics.rest_angles(turned).max(axis=0)
        energies = energy.rotational_energy(turned, rate)
        mask = JointMask() if self.mask is None else self.mask
        is_kept = mask.keeps(speeds.max(axis=0), angles)

        def limit(value: float) -> float | None:
            return float(value) if math.isfinite(value) else None

        return {
            name: {
                "peak_rad_s": float(speeds[:, joint].max()),
                "mean_rad_s": float(speeds[:, joint].mean()),
                "angle_rad": float(angles[joint]),
                "energy": float(energies[joint]),
                "limit_rad_s": limit(mask.speed_limits_rad_s[joint]),
                "angle_limit_rad": limit(mask.angle_limits_rad[joint]),
                "is_kept": bool(is_kept[joint]),
            }
            for joint, name in enumerate(self.motion.skeleton.joint_names)
        }

    def to_dict(self) -> dict[str, Any]:
        """Give all but the movement as plain values, ready for JSON."""
        return {
            "version": self.version,
            "condition": self.condition,
            "seed": self.seed,
            "preset": self.preset,
            "targets_from": self.targets_from,
            "is_synthetic": self.is_synthetic,
            "note": self.note,
            "is_interrupted": self.is_interrupted,
            "animation": asdict(self.animation),
            "asked": self.asked.to_dict(),
            "achieved": self.achieved.to_dict(),
            "achieved_blended": self.achieved_blended.to_dict(),
            "blocks": [
                {name: getattr(block, name).to_dict() for name in DanceBlock.__slots__}
                for block in self.blocks
            ],
            "spared": None if self.mask is None else self.mask.to_dict(),
            "cost": {"total": self.cost_total, "terms": self.cost_terms, "weights": self.weights},
            "variety_error": self.variety_error,
            "segments": [{name: getattr(s, name) for name in DanceSegment.__slots__} for s in self.segments],
            "joins": [{"displacement_m": jump} for jump in self.displacements_m],
            "joints": self.joints(),
            "chain_costs": list(self.chain_costs),
            "trace": [row.to_dict() for row in self.trace],
            "library_sha256": self.library_sha256,
            "sha256": self.sha256,
        }

    @classmethod
    def from_dict(cls, values: dict[str, Any], motion: Motion) -> Dance:
        """Undo `to_dict`; dances of version 1 had one block, spared nothing and told less of the search."""
        if values["version"] < VERSION:
            measures = {name: values[name] for name in DanceBlock.__slots__}
            older: dict[str, Any] = {
                "targets_from": "paper" if values["preset"] == "paper" else "percentiles",
                "blocks": [measures],
                "spared": None,
                "chain_costs": [],
                "variety_error": 0.0,
                "is_interrupted": False,
                "note": "",
                "animation": {"blend": "offset", "is_cleaned": False, "stage_m": None},
            }
            cost = {"weights": {}, **values["cost"]}
            rows = [{"terms": {}, **row} for row in values["trace"]]
            values = older | values | {"cost": cost, "trace": rows}
        spared = values["spared"]
        return cls(
            condition=values["condition"],
            seed=values["seed"],
            preset=values["preset"],
            targets_from=values["targets_from"],
            segments=tuple(DanceSegment(**segment) for segment in values["segments"]),
            motion=motion,
            asked=DanceMeasures(**values["asked"]),
            achieved=DanceMeasures(**values["achieved"]),
            achieved_blended=DanceMeasures(**values["achieved_blended"]),
            blocks=tuple(
                DanceBlock(**{name: DanceMeasures(**measures) for name, measures in block.items()})
                for block in values["blocks"]
            ),
            mask=None if spared is None else JointMask.from_dict(spared),
            cost_total=values["cost"]["total"],
            cost_terms=values["cost"]["terms"],
            weights=values["cost"]["weights"],
            displacements_m=tuple(join["displacement_m"] for join in values["joins"]),
            variety_error=values["variety_error"],
            chain_costs=tuple(values["chain_costs"]),
            trace=tuple(TraceRow.from_dict(row) for row in values["trace"]),
            library_sha256=values["library_sha256"],
            is_synthetic=values["is_synthetic"],
            animation=Animation.from_dict(values["animation"]),
            note=values["note"],
            is_interrupted=values["is_interrupted"],
            version=values["version"],
        )


def measured(
    motion: Motion,
    varieties: tuple[float, ...],
    segments: tuple[int, ...],
    *,
    joint_weights: Floats | None = None,
) -> tuple[DanceMeasures, ...]:
    """Measure a movement as shown, joins included, block by block.

    Parameters
    ----------
    motion : Motion
        The whole dance.
    varieties : tuple of float
        Of the segments of each block.
    segments : tuple of int
        How many segments each block has. A step between two blocks belongs to the later one.
    joint_weights : ndarray, shape (24,), optional
        a_j of Eq. 11, where that is to be left out; all 1 if not given.
    """
    positions = kinematics.centred_positions(motion.skeleton, motion.rotations)
    linear = energy.linear_energy_steps(positions, motion.frame_rate_hz).sum(axis=-1)
    turning = energy.rotational_energy_steps(motion.rotations, motion.frame_rate_hz)
    rotational = turning.sum(axis=-1) if joint_weights is None else turning @ joint_weights
    found, start = [], 0
    for variety, count in zip(varieties, segments, strict=True):
        frames = count * SEGMENT_FRAMES
        steps = slice(max(start - 1, 0), start + frames - 1)
        found.append(
            DanceMeasures(
                duration_s=count * SEGMENT_S,
                linear_energy=float(linear[steps].sum()),
                rotational_energy=float(rotational[steps].sum()),
                variety=variety,
            )
        )
        start += frames
    return tuple(found)
