"""From one take to its clean segments with all that is measured on them (section 4 of the paper)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from studykit.core.arrays import Booleans, Floats
from studykit.core.errors import InputError
from studykit.motion import cleaning, energy, features, kinematics
from studykit.motion.mirroring import mirrored
from studykit.motion.motion import Motion
from studykit.motion.resampling import every_nth, resampled
from studykit.motion.segmentation import FRAME_RATE_HZ, SEGMENT_FRAMES, SEGMENT_S, cut, segment_starts
from studykit.motion.skeleton import JOINT_NAMES

LARGE = {
    "rotations": ((SEGMENT_FRAMES, 24, 4), "<f4"),
    "root_positions": ((SEGMENT_FRAMES, 3), "<f4"),
    "features": ((SEGMENT_FRAMES, 97), "<f4"),
}
"""What is looked at a few segments at a time: shape of one segment and type of number."""
SMALL = {
    "linear_energies": ((24,), "<f8"),
    "rotational_energies": ((24,), "<f8"),
    "first_poses": ((24, 3), "<f8"),
    "last_poses": ((24, 3), "<f8"),
    "peak_speeds": ((24,), "<f8"),
    "peak_angles": ((24,), "<f8"),
}
"""What the search looks at all the time."""


class Decision(NamedTuple):
    """A reviewer's word on a stretch of a take: keep what a rule flagged, or cut what none did."""

    start_s: float
    stop_s: float
    decision: Literal["keep", "cut"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Settings:
    """How takes become segments.

    Parameters
    ----------
    noise_rule : {"robust", "paper"}
        Which frames are cut out.
    stride_s : float
        Time from the start of one segment to the next, s; less than 4 lets them overlap.
    mirrored : bool
        Whether every segment is also there with left and right exchanged.
    seed : int
        For the random chains of the calibration; no take depends on it.
    """

    noise_rule: cleaning.NoiseRule = "robust"
    stride_s: float = SEGMENT_S
    mirrored: bool = False
    seed: int = 0

    def __post_init__(self) -> None:
        if self.noise_rule not in get_args(cleaning.NoiseRule):
            raise InputError(
                f"there is no noise rule {self.noise_rule!r}",
                where="noise_rule",
                remedy="say robust or paper",
            )
        if not 1.0 / FRAME_RATE_HZ <= self.stride_s <= SEGMENT_S:
            raise InputError(
                f"a stride of {self.stride_s:g} s", where="stride", remedy="say between 0.04 and 4 s"
            )

    def of_a_take(self) -> dict[str, Any]:
        """Give what a single take's segments depend on."""
        return {name: getattr(self, name) for name in ("noise_rule", "stride_s", "mirrored")}


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Measured:
    """The segments of one take.

    Parameters
    ----------
    starts_s : ndarray, shape (segment,), s
        Where each begins in the take.
    is_mirrored : ndarray, shape (segment,)
        Whether left and right are exchanged.
    arrays : dict of str to ndarray
        What `LARGE` and `SMALL` name, one row a segment.
    outcome : dict
        What became of the take: `duration_s`, `frame_rate_hz`, `segments_possible`, `segments_kept`,
        `segments_paper`, `frames_RULE` for each rule, `frames_kept_by_hand`, `frames_cut_by_hand`.
    findings : list of dict
        Flagged stretches: `start_s`, `stop_s`, `rule` and the `joint` that broke it most.
    """

    starts_s: Floats
    is_mirrored: Booleans
    arrays: dict[str, Any]
    outcome: dict[str, Any]
    findings: list[dict[str, Any]] = field(default_factory=list)


def measured(take: Motion, settings: Settings, decisions: Sequence[Decision] = ()) -> Measured:
    """Clean one take, cut it and measure its segments.

    Parameters
    ----------
    take : Motion
        On studykit's body, at its own rate.
    settings : Settings
        How.
    decisions : sequence of Decision
        A reviewer's words; they go before the rule, and a later one before an earlier one.
    """
    motion = resampled(take, FRAME_RATE_HZ)
    # Where every n-th frame is taken, a frame lasts as long as n of the take's.
    frame_s = (every_nth(take.frame_rate_hz, FRAME_RATE_HZ) or 0) / take.frame_rate_hz or 1.0 / FRAME_RATE_HZ
    positions = kinematics.centred_positions(motion.skeleton, motion.rotations)
    excess = cleaning.excesses(positions, motion.root_positions, FRAME_RATE_HZ)
    flagged = cleaning.flagged(excess, settings.noise_rule)
    bad = _decided(flagged, decisions, frame_s)
    runs = cleaning.clean_runs(bad)
    stride_frames = round(settings.stride_s * FRAME_RATE_HZ)
    starts = np.array(segment_starts(runs, stride_frames=stride_frames), dtype=np.int64)
    parts = [_arrays(motion, positions, runs, starts)]
    if settings.mirrored:
        other = mirrored(motion)
        parts.append(
            _arrays(other, kinematics.centred_positions(other.skeleton, other.rotations), runs, starts)
        )
    copies = len(parts)
    whole = len(motion) // SEGMENT_FRAMES
    outcome = {
        "duration_s": round(take.duration_s, 6),
        "frame_rate_hz": round(take.frame_rate_hz, 6),
        "segments_possible": whole,
        "segments_kept": len(segment_starts(runs)),  # side by side, comparable to the others
        "segments_paper": len(segment_starts(cleaning.clean_runs(cleaning.flagged(excess, "paper")))),
        **{f"frames_{rule}": int(np.any(over > 1.0, axis=1).sum()) for rule, over in excess.items()},
        "frames_kept_by_hand": int((flagged & ~bad).sum()),
        "frames_cut_by_hand": int((bad & ~flagged).sum()),
    }
    return Measured(
        starts_s=np.tile(starts * frame_s, copies),
        is_mirrored=np.repeat(np.arange(copies, dtype=np.bool_), len(starts)),
        arrays={key: np.concatenate([part[key] for part in parts]) for key in parts[0]},
        outcome=outcome,
        findings=_findings(excess, settings.noise_rule, frame_s),
    )


def _decided(flagged: Booleans, decisions: Sequence[Decision], frame_s: float) -> Booleans:
    bad = np.array(flagged)
    for start_s, stop_s, decision in decisions:
        # From the first frame at or after the start to the last before the end; times may be rounded.
        first, last = (int(np.ceil(time / frame_s - 1e-3)) for time in (start_s, stop_s))
        bad[max(first, 0) : max(last, 0)] = decision == "cut"
    return bad


def _findings(excess: Mapping[str, Floats], noise_rule: str, frame_s: float) -> list[dict[str, Any]]:
    found = []
    for rule, over in excess.items():
        if (rule == "paper") != (noise_rule == "paper"):
            continue
        for start, stop in cleaning.clean_runs(~np.any(over > 1.0, axis=1)):
            worst = int(np.argmax(over[start:stop].max(axis=0)))
            found.append(
                {
                    "start_s": start * frame_s,
                    "stop_s": stop * frame_s,
                    "rule": rule,
                    "joint": JOINT_NAMES[worst],
                }
            )
    return sorted(found, key=lambda one: (one["start_s"], one["rule"]))


def _arrays(
    motion: Motion, positions: Floats, runs: Sequence[tuple[int, int]], starts: Any
) -> dict[str, Any]:
    """Measure all segments at once; as if each were alone, but that features know what is around it."""
    pose_features = np.zeros((len(motion), 97))
    for start, stop in runs:
        if stop - start >= SEGMENT_FRAMES:
            pose_features[start:stop] = features.pose_features(positions[start:stop], FRAME_RATE_HZ)
    rotations, root_positions = cut(motion, positions, starts)
    kept = rotations.astype(LARGE["rotations"][1]).astype(np.float64)  # limits hold to the last digit
    frames = starts[:, None] + np.arange(SEGMENT_FRAMES)
    # The 119 steps within each segment; neither energy knows where the body stands or which way it faces.
    within = frames[:, : SEGMENT_FRAMES - 1]
    arrays = {
        "rotations": rotations,
        "root_positions": root_positions,
        "features": pose_features[frames],
        "linear_energies": energy.linear_energy_steps(positions, FRAME_RATE_HZ)[within].sum(axis=1),
        "rotational_energies": energy.rotational_energy_steps(motion.rotations, FRAME_RATE_HZ)[within].sum(
            axis=1
        ),
        "first_poses": kinematics.facing_ahead(positions[starts]),
        "last_poses": kinematics.facing_ahead(positions[starts + SEGMENT_FRAMES - 1]),
        "peak_speeds": kinematics.angular_speeds(np.moveaxis(kept, 1, 0), FRAME_RATE_HZ).max(axis=0),
        "peak_angles": kinematics.rest_angles(kept).max(axis=1),
    }
    return {key: arrays[key].astype(dtype) for key, (_, dtype) in (LARGE | SMALL).items()}
