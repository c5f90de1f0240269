"""Measuring the movement in a trial: one condition danced once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from studykit.analysis.common_body import COMMON_WEIGHTS, common_space, resampled, same_front
from studykit.analysis.dynamic_time_warping import Alignment, align
from studykit.analysis.smoothness import log_dimensionless_jerk, squared_jerk
from studykit.choreography.dance import Dance
from studykit.core.arrays import Floats
from studykit.motion import energy, kinematics
from studykit.motion.filtering import low_pass, without_gaps
from studykit.motion.inverse_kinematics import rotations_from_positions
from studykit.motion.motion import JointTracks
from studykit.motion.range_of_motion import range_of_motion
from studykit.motion.skeleton import NEUTRAL_BODY
from studykit.reports.choices import Choices

SHORTEST_BONE_M = 0.08
"""A trembling of 5 mm turns a bone of this length by 4 degrees; what is shorter is not asked how it turns."""
CUTOFF_HZ = 6.0
"""Faster than this a camera trembles rather than a person dances (Winter 2009)."""
SMOOTHNESS_CUTOFF_HZ = 4.0
"""Jerk is the third derivative: up to 6 Hz it would be mostly the camera's."""
ENDS = ("left_wrist", "right_wrist", "left_ankle", "right_ankle")
"""Whose smoothness is measured."""
MAIN_JOINTS = tuple(
    f"{side}_{joint}" for joint in ("shoulder", "elbow", "hip", "knee") for side in ("left", "right")
)
"""Whose range of motion is averaged."""

_FRONT = ("pelvis", "left_hip", "right_hip", "left_shoulder", "right_shoulder")
_FEWEST_FRAMES = 30
_LEAST_STILL_S = 2.0
_LONGEST_GAP_S = 1.0  # without sight of a joint, where any lateness is allowed


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class BodyMeasures:
    """How a body moved that was seen as a whole.

    Parameters
    ----------
    linear_steps, rotational_steps : ndarray, shape (step, 24), J/kg
        The energy of each joint from one frame to the next, without the camera's trembling; single steps can
        therefore be negative.
    noise_share : float
        Share of the seen energy that was trembling and was taken off; NaN where nobody was seen standing
        still, so that nothing could be, of the jerk neither.
    smoothness : float
        Log dimensionless jerk, mean of wrists and ankles.
    ranges_of_motion : ndarray, shape (24,), rad
        How far each joint turned.
    """

    linear_steps: Floats
    rotational_steps: Floats
    noise_share: float
    smoothness: float
    ranges_of_motion: Floats

    @property
    def linear_energy(self) -> float:
        """Energy of travelling joints, J/kg, over all poses."""
        return max(0.0, float(self.linear_steps.sum()))

    @property
    def rotational_energy(self) -> float:
        """Energy of turning joints, J/kg, over all poses."""
        return max(0.0, float(self.rotational_steps.sum()))

    @property
    def range_of_motion(self) -> float:
        """How far shoulders, elbows, hips and knees turned on average, rad."""
        return float(self.ranges_of_motion[[NEUTRAL_BODY.index(name) for name in MAIN_JOINTS]].mean())


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MovementMeasures:
    """The movement in a trial.

    Parameters
    ----------
    alignment : Alignment
        How far from the guide.
    coverage : float
        Share of the dance, joint by joint, in which the joints that are compared were seen.
    body : BodyMeasures or None
        How the body moved; None where a joint was never seen.
    """

    alignment: Alignment
    coverage: float
    body: BodyMeasures | None


class Trembling(NamedTuple):
    """What a camera's trembling adds to a movement.

    Attributes
    ----------
    linear, rotational : ndarray, shape (24,), J/kg
        To the energy of each joint in a step.
    jerk : ndarray, shape (4,), m^2/s^6
        To the squared jerk of `ENDS`.
    """

    linear: Floats
    rotational: Floats
    jerk: Floats


def trembling(still: JointTracks, frame_rate_hz: float) -> Trembling | None:
    """Tell how much a camera sees somebody move who stands still.

    Trembling and movement are independent, so their squared speeds (and jerks) add up: what is seen in
    somebody who stands still can be taken off what is seen in the same person dancing.

    Parameters
    ----------
    still : JointTracks
        What the camera saw of somebody standing still.
    frame_rate_hz : float
        The rate at which dances are measured.

    Returns
    -------
    Trembling or None
        None if it was seen for less than two seconds, or a joint never.
    """
    if len(still) < 2:
        return None
    smooth = _smooth(
        still, np.arange(still.times_s[0], still.times_s[-1], 1.0 / frame_rate_hz), frame_rate_hz
    )
    if smooth is None or len(smooth) < _LEAST_STILL_S * frame_rate_hz:
        return None
    linear, rotational = _steps(smooth, _rotations(smooth), frame_rate_hz)
    jerk = squared_jerk(_ends(smooth, frame_rate_hz), frame_rate_hz)
    return Trembling(linear.mean(axis=0), rotational.mean(axis=0), jerk)


def movement_measures(
    tracks: JointTracks,
    start_s: float,
    dance: Dance,
    choices: Choices,
    *,
    noise: Trembling | None = None,
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
    choices : Choices
        Gives how early or late a dancer may be, and what the distance is.
    noise : Trembling, optional
        What the camera's trembling adds to the energy.
    """
    both = side_by_side(tracks, start_s, dance, choices)
    if both is None:
        return None
    rate = dance.motion.frame_rate_hz
    smooth = _smooth(tracks, start_s + np.arange(len(dance.motion)) / rate, rate)
    return MovementMeasures(
        alignment=aligned(both, choices),
        coverage=float(np.isfinite(both.danced).all(axis=-1).mean()),
        body=None if smooth is None else _body_measures(smooth, rate, noise),
    )


class SideBySide(NamedTuple):
    """A dance as shown and as somebody danced it, in one space.

    Attributes
    ----------
    guide, danced : ndarray, shape (frame, 15, 3), m
        See `common_space`; NaN where a joint was not seen.
    frame_rate_hz : float
    """

    guide: Floats
    danced: Floats
    frame_rate_hz: float


def side_by_side(tracks: JointTracks, start_s: float, dance: Dance, choices: Choices) -> SideBySide | None:
    """Put what a camera saw beside the dance that was shown; None where it never saw the body's front.

    Parameters
    ----------
    tracks, start_s, dance, choices
        As for `movement_measures`.
    """
    rate = dance.motion.frame_rate_hz
    grid = start_s + np.arange(len(dance.motion)) / rate
    seen = resampled(tracks, grid, longest_gap_s=choices.band_s or _LONGEST_GAP_S)
    front = [place for place, name in enumerate(tracks.joint_names) if name in _FRONT]
    if not np.isfinite(seen[:, front]).all(axis=(1, 2)).any():
        return None
    danced = common_space(seen, tracks.joint_names, frame_rate_hz=rate)
    return SideBySide(guide=_guide(dance), danced=danced, frame_rate_hz=rate)


def aligned(both: SideBySide, choices: Choices) -> Alignment:
    """Pair the frames of a dance as shown and as danced; `choices` give the band and the distance."""
    rate = both.frame_rate_hz
    band = None if choices.band_s is None else round(choices.band_s * rate)
    turned = same_front(both.guide, both.danced, len(both.guide) if band is None else band)
    weights = COMMON_WEIGHTS if choices.definition == "mean_joint_distance" else None
    return align(both.guide, turned, band, weights, frame_rate_hz=rate, definition=choices.definition)


def _body_measures(smooth: Floats, rate: float, noise: Trembling | None) -> BodyMeasures:
    rotations = _rotations(smooth)
    linear, rotational = _steps(smooth, rotations, rate)
    share = np.nan
    if noise is not None:
        seen = linear.sum() + rotational.sum()
        linear, rotational = linear - noise.linear, rotational - noise.rotational
        share = min(1.0, 1.0 - (linear.sum() + rotational.sum()) / seen) if seen > 0.0 else np.nan
    jerk = 0.0 if noise is None else noise.jerk
    return BodyMeasures(
        linear_steps=linear,
        rotational_steps=rotational,
        noise_share=share,
        smoothness=float(log_dimensionless_jerk(_ends(smooth, rate), rate, trembling=jerk).mean()),
        ranges_of_motion=range_of_motion(rotations),
    )


def asked_steps(dance: Dance) -> tuple[Floats, Floats]:
    """Give the linear and rotational energy that a dance as shown asks for, shape (step, 24), J/kg."""
    motion = dance.motion
    centred = kinematics.centred_positions(motion.skeleton, motion.rotations)
    return (
        energy.linear_energy_steps(centred, motion.frame_rate_hz),
        energy.rotational_energy_steps(motion.rotations, motion.frame_rate_hz),
    )


@lru_cache(maxsize=8)
def _guide(dance: Dance) -> Floats:
    """Put a dance into the space of the comparison; everybody is compared with the same one."""
    motion = dance.motion
    positions = kinematics.joint_positions(motion)
    return common_space(positions, motion.skeleton.joint_names, frame_rate_hz=motion.frame_rate_hz)


def _smooth(tracks: JointTracks, grid_s: Floats, rate: float) -> Floats | None:
    """Take the camera's trembling out of a seen movement as far as smoothing can; None if a joint lacks."""
    positions = without_gaps(tracks.times_s, tracks.positions, grid_s)
    if len(positions) < _FEWEST_FRAMES or not np.all(np.isfinite(positions)):
        return None
    return low_pass(positions, CUTOFF_HZ, rate)


def _ends(smooth: Floats, rate: float) -> Floats:
    ends = smooth[:, [NEUTRAL_BODY.index(name) for name in ENDS]] - smooth[:, :1]
    return low_pass(ends, SMOOTHNESS_CUTOFF_HZ, rate)


def _rotations(smooth: Floats) -> Floats:
    return rotations_from_positions(smooth, shortest_bone_m=SHORTEST_BONE_M)


def _steps(smooth: Floats, rotations: Floats, rate: float) -> tuple[Floats, Floats]:
    linear = energy.linear_energy_steps(smooth - smooth[:, :1], rate)
    return linear, energy.rotational_energy_steps(rotations, rate)
