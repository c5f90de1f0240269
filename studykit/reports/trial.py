"""Measuring one trial: one condition danced once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from studykit.analysis import heart_rate
from studykit.analysis.common_body import COMMON_WEIGHTS, common_space, resampled, same_front
from studykit.analysis.dynamic_time_warping import Alignment, align
from studykit.choreography.dance import Dance
from studykit.core.arrays import Floats
from studykit.motion import energy, kinematics
from studykit.motion.filtering import low_pass, without_gaps
from studykit.motion.inverse_kinematics import rotations_from_positions
from studykit.motion.motion import JointTracks
from studykit.protocol.study_protocol import StudyProtocol
from studykit.recording.session_record import SessionRecord, StepRecord

SHORTEST_BONE_M = 0.08
"""A trembling of 5 mm turns a bone of this length by 4 degrees; what is shorter is not asked how it turns."""
CUTOFF_HZ = 6.0
"""Faster than this a camera trembles rather than a person dances (Winter 2009)."""

_FRONT = ("pelvis", "left_hip", "right_hip", "left_shoulder", "right_shoulder")


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HeartMeasures:
    """The heart in a trial; NaN where the belt said too little."""

    mean_bpm: float
    peak_bpm: float
    vigorous_fraction: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MovementMeasures:
    """The movement in a trial: how far from the guide, and how much energy it had, J per kg."""

    alignment: Alignment
    linear_energy: float
    rotational_energy: float


def heart_measures(
    record: SessionRecord, step: StepRecord, protocol: StudyProtocol, *, age: float | None
) -> HeartMeasures:
    """Measure the heart in the protocol's window around a step.

    Parameters
    ----------
    record : SessionRecord
        The visit.
    step : StepRecord
        The step in which the dance was performed.
    protocol : StudyProtocol
        Gives the window, the maximum's formula, the vigorous threshold and the longest gap.
    age : float or None
        Years; without it nothing can be vigorous.
    """
    plan = protocol.heart_rate
    times, bpm = record.heart_rate_times_s, record.heart_rate_bpm
    start, stop = step.start_s, step.stop_s + (30.0 if plan.window == "perform+30" else 0.0)
    fraction = np.nan
    if age is not None:
        threshold = plan.vigorous_fraction * heart_rate.maximum(age, plan.maximum)
        zone = heart_rate.seconds_at_or_above(
            times, bpm, threshold, plan.longest_gap_s, start_s=start, stop_s=stop
        )
        fraction = zone.fraction
    return HeartMeasures(
        mean_bpm=heart_rate.mean_bpm(times, bpm, start, stop, plan.longest_gap_s),
        peak_bpm=heart_rate.peak_bpm(times, bpm, start, stop, plan.longest_gap_s),
        vigorous_fraction=fraction,
    )


def movement_measures(
    tracks: JointTracks, start_s: float, dance: Dance, protocol: StudyProtocol
) -> MovementMeasures | None:
    """Compare what a camera saw with the dance that was shown; None where it never saw the body's front.

    Parameters
    ----------
    tracks : JointTracks
        What the camera saw, on the session's clock.
    start_s : float
        When the dance began, s.
    dance : Dance
        What was shown.
    protocol : StudyProtocol
        Gives how early or late a dancer may be.
    """
    rate = dance.motion.frame_rate_hz
    grid = start_s + np.arange(len(dance.motion)) / rate
    seen = resampled(tracks, grid, longest_gap_s=protocol.movement.band_s)
    front = [place for place, name in enumerate(tracks.joint_names) if name in _FRONT]
    if not np.isfinite(seen[:, front]).all(axis=(1, 2)).any():
        return None
    guide, danced = _guide(dance), common_space(seen, tracks.joint_names, frame_rate_hz=rate)
    band = round(protocol.movement.band_s * rate)
    alignment = align(guide, same_front(guide, danced, band), band, COMMON_WEIGHTS, frame_rate_hz=rate)
    linear, rotational = _energies(without_gaps(tracks.times_s, tracks.positions, grid), rate)
    return MovementMeasures(alignment=alignment, linear_energy=linear, rotational_energy=rotational)


@lru_cache(maxsize=8)
def _guide(dance: Dance) -> Floats:
    """Put a dance into the space of the comparison; everybody is compared with the same one."""
    motion = dance.motion
    positions = kinematics.joint_positions(motion)
    return common_space(positions, motion.skeleton.joint_names, frame_rate_hz=motion.frame_rate_hz)


def _energies(positions: Floats, rate: float) -> tuple[float, float]:
    """Energies of a seen movement, without the camera's trembling; NaN where a joint was never seen."""
    if not np.all(np.isfinite(positions)):
        return np.nan, np.nan
    smooth = low_pass(positions, CUTOFF_HZ, rate)
    centred = smooth - smooth[:, :1]
    return (
        float(energy.linear_energy(centred, rate).sum()),
        float(
            energy.rotational_energy(
                rotations_from_positions(smooth, shortest_bone_m=SHORTEST_BONE_M), rate
            ).sum()
        ),
    )
