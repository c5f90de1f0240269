"""Dances: what was asked for, what was found, and the movement itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from studykit.choreography.rjmcmc.run import TraceRow
from studykit.core.provenance import sha256_of_value
from studykit.motion import energy, kinematics
from studykit.motion.motion import Motion

VERSION = 1


TargetsFrom = Literal["percentiles", "raters", "paper"]


@dataclass(frozen=True, kw_only=True, slots=True)
class DanceSegment:
    """One segment of a dance and where it comes from."""

    id: int
    take: str
    start_s: float
    mirrored: bool
    licence: str


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
        phi of Eq. 5, in the metric of the preset.
    """

    duration_s: float
    linear_energy: float
    rotational_energy: float
    variety: float

    def to_dict(self) -> dict[str, float]:
        """Give the measures by name."""
        return {name: getattr(self, name) for name in self.__slots__}


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
    cost_total : float
        Eq. 1.
    cost_terms : dict of str to float
        Every term, unweighted.
    displacements_m : tuple of float
        Eq. 3 at each join, before blending.
    trace : tuple of TraceRow
        How the search went.
    library_sha256 : str
        The library's digest.
    is_synthetic : bool
        Whether any segment was made up rather than danced by a person.
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
    cost_total: float
    cost_terms: dict[str, float]
    displacements_m: tuple[float, ...]
    trace: tuple[TraceRow, ...]
    library_sha256: str
    is_synthetic: bool

    @property
    def distinct_segments(self) -> int:
        """How many different segments the dance has."""
        return len({segment.id for segment in self.segments})

    @property
    def sha256(self) -> str:
        """Digest of what determines the movement: the library and the segments chosen."""
        return sha256_of_value(
            {
                "version": VERSION,
                "condition": self.condition,
                "library_sha256": self.library_sha256,
                "segments": [segment.id for segment in self.segments],
            }
        )

    def to_dict(self) -> dict[str, Any]:
        """Give all but the movement as plain values, ready for JSON."""
        speeds = kinematics.angular_speeds(self.motion.rotations, self.motion.frame_rate_hz)
        return {
            "version": VERSION,
            "condition": self.condition,
            "seed": self.seed,
            "preset": self.preset,
            "targets_from": self.targets_from,
            "is_synthetic": self.is_synthetic,
            "asked": self.asked.to_dict(),
            "achieved": self.achieved.to_dict(),
            "achieved_blended": self.achieved_blended.to_dict(),
            "cost": {"total": self.cost_total, "terms": self.cost_terms},
            "segments": [{name: getattr(s, name) for name in DanceSegment.__slots__} for s in self.segments],
            "joins": [{"displacement_m": jump} for jump in self.displacements_m],
            "joints": {
                name: {
                    "peak_rad_s": float(speeds[:, joint].max()),
                    "mean_rad_s": float(speeds[:, joint].mean()),
                }
                for joint, name in enumerate(self.motion.skeleton.joint_names)
            },
            "trace": [{name: getattr(row, name) for name in TraceRow.__slots__} for row in self.trace],
            "library_sha256": self.library_sha256,
            "sha256": self.sha256,
        }

    @classmethod
    def from_dict(cls, values: dict[str, Any], motion: Motion) -> Dance:
        """Undo `to_dict`."""
        return cls(
            condition=values["condition"],
            seed=values["seed"],
            preset=values["preset"],
            # Dances written before raters could be asked do not say.
            targets_from=values.get(
                "targets_from", "paper" if values["preset"] == "paper" else "percentiles"
            ),
            segments=tuple(DanceSegment(**segment) for segment in values["segments"]),
            motion=motion,
            asked=DanceMeasures(**values["asked"]),
            achieved=DanceMeasures(**values["achieved"]),
            achieved_blended=DanceMeasures(**values["achieved_blended"]),
            cost_total=values["cost"]["total"],
            cost_terms=values["cost"]["terms"],
            displacements_m=tuple(join["displacement_m"] for join in values["joins"]),
            trace=tuple(TraceRow(**row) for row in values["trace"]),
            library_sha256=values["library_sha256"],
            is_synthetic=values["is_synthetic"],
        )


def blended_measures(motion: Motion, variety: float) -> DanceMeasures:
    """Measure a movement as shown, joins included."""
    positions = kinematics.centred_positions(motion.skeleton, motion.rotations)
    return DanceMeasures(
        duration_s=motion.duration_s,
        linear_energy=float(energy.linear_energy(positions, motion.frame_rate_hz).sum()),
        rotational_energy=float(energy.rotational_energy(motion.rotations, motion.frame_rate_hz).sum()),
        variety=variety,
    )
