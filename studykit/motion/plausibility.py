"""Movements that no body makes: wrong units, wrong axes, mirrored or transposed rotations."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from studykit.motion import rotation
from studykit.motion.motion import Motion

RATES_HZ = (5.0, 2000.0)
_BENT_RAD = np.radians(30.0)
_FASTEST_TRAVEL_M_S = 12.0


class Fault(NamedTuple):
    """What is wrong with a whole take, and what may be done."""

    problem: str
    remedy: str


def implausible(motion: Motion) -> Fault | None:
    """Say what makes a whole take impossible for a person, or None if nothing does.

    Glitches of a few frames are for cleaning; this looks for what is wrong throughout.

    Parameters
    ----------
    motion : Motion
        SMPL's 24 joints, metres, Y up.
    """
    if not RATES_HZ[0] <= motion.frame_rate_hz <= RATES_HZ[1]:
        problem = f"{motion.frame_rate_hz:g} frames a second are no rate of motion capture"
        return Fault(problem, "give the true rate with --fps or frame_rate_hz")
    index = motion.skeleton.index
    knees = rotation.log(motion.rotations[:, [index("left_knee"), index("right_knee")]])
    bends = knees[..., 0][np.linalg.norm(knees, axis=-1) > _BENT_RAD]
    if len(bends) > 10 and np.mean(bends < 0.0) > 0.5:
        problem = f"knees bend forwards in {np.mean(bends < 0.0):.0%} of the frames in which they are bent"
        return Fault(problem, "check the axes and the order of the rotations in the file")
    travel = np.linalg.norm(np.diff(motion.root_positions, axis=0), axis=-1) * motion.frame_rate_hz
    if len(travel) and np.median(travel) > _FASTEST_TRAVEL_M_S:
        problem = f"the body travels at {np.median(travel):.3g} m/s most of the time"
        return Fault(problem, "check the unit of length (units_m) and the frame rate")
    return None
