"""What is said of a dance beside its picture: how close it came, what it is made of, what joints do in it."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from studykit.figures.film import letters
from studykit.motion import kinematics
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.motion.joint_mask import JointMask
from studykit.motion.segmentation import SEGMENT_S
from studykit.widgets.player.watch import origin

if TYPE_CHECKING:
    from studykit.choreography.dance import Dance, DanceMeasures

_MEASURES: Final = (
    ("duration_s", "duration", "s", 1.0),
    ("linear_energy", "linear energy", "J", DEFAULT_BODY_MASS_KG),
    ("rotational_energy", "rotational energy", "J", DEFAULT_BODY_MASS_KG),
    ("variety", "variety", "", 1.0),
)
"""Field, words, unit as shown, and its size in the field's unit; energies for a body of 73.5 kg."""


def segment_rows(dance: Dance) -> list[dict[str, Any]]:
    """Tell of each segment its letter, when it begins, where it comes from, and how far joints jump to it."""
    jumps = [None, *dance.displacements_m]
    return [
        {
            "letter": letter,
            "start_s": SEGMENT_S * place,
            "origin": origin(segment),
            "jump_cm": None if jump is None else 100.0 * jump,
        }
        for place, (letter, segment, jump) in enumerate(
            zip(letters(dance), dance.segments, jumps, strict=True)
        )
    ]


def measure_rows(
    asked: DanceMeasures, achieved: DanceMeasures, shown: DanceMeasures | None, tolerances: dict[str, float]
) -> list[dict[str, Any]]:
    """Set beside each target what the dance has, and whether that is close enough.

    Parameters
    ----------
    asked, achieved : DanceMeasures
        The targets and what the segments have.
    shown : DanceMeasures or None
        What the movement has with its joins.
    tolerances : dict of str to float
        How far each measure may be off, in its own unit; what is not named is not asked for.
    """
    rows = []
    for name, words, unit, factor in _MEASURES:
        if name not in tolerances:
            continue
        target, have = getattr(asked, name), getattr(achieved, name)
        is_hit = bool(abs(have - target) <= tolerances[name] + 1e-9)
        rows.append(
            {
                "name": words,
                "unit": unit,
                "asked": factor * target,
                "tolerance": factor * tolerances[name],
                "achieved": factor * have,
                "shown": None if shown is None else factor * getattr(shown, name),
                "is_hit": is_hit,
                "verdict": _verdict(have, target, is_hit=is_hit),
            }
        )
    return rows


def joint_rows(dance: Dance, mask: JointMask | None) -> list[dict[str, Any]]:
    """Tell of each joint how fast it turns at most in the movement as shown, and whether it keeps its limits.

    Returns
    -------
    list of dict
        `joint`, `peak_rad_s`, `limit_rad_s` (None where there is none), `is_within` (of angles too).
    """
    motion = dance.motion
    peaks = kinematics.angular_speeds(motion.rotations, motion.frame_rate_hz).max(axis=0)
    limited = mask or JointMask()
    is_kept = limited.keeps(peaks, kinematics.rest_angles(motion.rotations).max(axis=0))
    return [
        {
            "joint": name,
            "peak_rad_s": float(peak),
            "limit_rad_s": float(limit) if np.isfinite(limit) else None,
            "is_within": bool(is_within),
        }
        for name, peak, limit, is_within in zip(
            motion.skeleton.joint_names, peaks, limited.speed_limits_rad_s, is_kept, strict=True
        )
    ]


def block_starts(durations_s: list[float]) -> list[float]:
    """Give when each block begins, s."""
    return [0.0, *accumulate(durations_s)][:-1]


def _verdict(have: float, target: float, *, is_hit: bool) -> str:
    off = have / target - 1.0 if target else 0.0
    if abs(off) < 5e-4:
        return "as asked"
    words = f"{abs(off):.1%} {'above' if off > 0.0 else 'below'}"
    return words if is_hit else f"{words}, farther than asked"
