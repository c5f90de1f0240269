"""Movements that no body makes: wrong units, wrong axes, mirrored or transposed rotations."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from studykit.core.arrays import Floats
from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion

RATES_HZ = (5.0, 2000.0)

# The bounds stand well off what 189 real takes do, breakdance on the floor and flips among them.
_BENT_RAD = np.radians(30.0)
_BENT_SINE = np.sin(np.radians(15.0))
_FASTEST_TRAVEL_M_S = 12.0  # runners: 4.3 m/s
_FASTEST_LIMBS_M_S = 15.0  # of the fastest joint, half of the time; running: 5.3 m/s
_HIGHEST_CLIMB_M = 3.0  # between the 5th and the 95th percentile; flips: 0.6 m
_LEAST_UPRIGHT = 0.4  # cosine of trunk and vertical, half of the time; breakdance: 0.47
_SAME_WAY = 0.8  # length of the mean direction of the trunk; lying about in a dance: below 0.77
_FOLD_M = 0.2  # legs that fold by less tell nothing of the way of the pelvis
_FOLLOWS = (0.4, 2.5)  # how far the pelvis sinks when legs fold by a metre; real: 0.8 to 1.2
_FLOOR_M = 0.05  # a body whose lowest joint is no higher over its low percentile stands on something
_LEAST_STANDING = 0.2  # share of the frames that must be so before they are asked alone


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
    positions = kinematics.centred_positions(motion.skeleton, motion.rotations)
    return _knees(motion, positions) or _speeds(motion, positions) or _stance(motion, positions)


def _knees(motion: Motion, positions: Floats) -> Fault | None:
    """Find knees that bend forwards against their own thighs, or seen from the hips."""
    index = motion.skeleton.index
    turns = rotation.log(motion.rotations[:, [index("left_knee"), index("right_knee")]])
    bends = turns[..., 0][np.linalg.norm(turns, axis=-1) > _BENT_RAD]
    left = _unit(positions[:, index("left_hip")] - positions[:, index("right_hip")])
    seen = []
    for side in ("left", "right"):
        hip, knee, ankle = (positions[:, index(f"{side}_{joint}")] for joint in ("hip", "knee", "ankle"))
        seen.append(np.sum(np.cross(_unit(knee - hip), _unit(ankle - knee)) * left, axis=-1))
    sines = np.concatenate(seen)
    for wrong in (bends < 0.0, sines[np.abs(sines) > _BENT_SINE] < 0.0):
        if len(wrong) > 10 and np.mean(wrong) > 0.5:
            problem = f"knees bend forwards in {np.mean(wrong):.0%} of the frames in which they are bent"
            return Fault(problem, "check left and right, the axes and the order of the rotations in the file")
    return None


def _speeds(motion: Motion, positions: Floats) -> Fault | None:
    """Find a body or limbs too fast most of the time, or one that climbs like no dancer."""
    if len(motion) < 2:
        return None
    check = "check the unit of length (units_m) and the frame rate"
    travel = np.median(np.linalg.norm(np.diff(motion.root_positions, axis=0), axis=-1))
    if travel * motion.frame_rate_hz > _FASTEST_TRAVEL_M_S:
        return Fault(f"the body travels at {travel * motion.frame_rate_hz:.3g} m/s most of the time", check)
    fastest = np.linalg.norm(kinematics.linear_velocities(positions, motion.frame_rate_hz), axis=-1)
    limbs = np.median(fastest.max(axis=1))
    if limbs > _FASTEST_LIMBS_M_S:
        return Fault(f"hands and feet move at {limbs:.3g} m/s most of the time", check)
    climb = _spread(motion.root_positions[:, 1])
    if climb > _HIGHEST_CLIMB_M:
        return Fault(f"the pelvis rises and falls by {climb:.3g} m", "check units_m, and which axis is up")
    return None


def _stance(motion: Motion, positions: Floats) -> Fault | None:
    """Find a body that lies or hangs the same way throughout, or folds without the pelvis sinking."""
    trunk = _unit(positions[:, motion.skeleton.index("neck")])
    upright = float(np.median(trunk[:, 1]))
    if upright < _LEAST_UPRIGHT and np.linalg.norm(trunk.mean(axis=0)) > _SAME_WAY:
        how = "upside down" if upright < -_LEAST_UPRIGHT else "on its side"
        return Fault(f"the body is {how} throughout", 'check which axis of the file is up (up = "Z")')
    height = -positions[..., 1].min(axis=1)
    if _spread(height) > _FOLD_M:
        sinks = _sinks(motion.root_positions[:, 1], height)
        if not _FOLLOWS[0] < sinks < _FOLLOWS[1]:
            return Fault(
                f"the pelvis sinks by {sinks:.2g} m for each metre by which the body folds to the floor",
                "check the unit of length of the way (units_m), and which axis is up",
            )
    return None


def _sinks(pelvis: Floats, height: Floats) -> float:
    """Give how far the pelvis sinks (m) for each metre by which the body folds.

    In a jump with drawn-up legs it rises as they fold, so where it does not follow throughout, the frames on
    the floor are asked alone: those of a way in the wrong unit or direction do not follow either.
    """
    lowest = pelvis - height
    standing = lowest < np.percentile(lowest, 5.0) + _FLOOR_M
    sinks = _slope(pelvis, height)
    if _FOLLOWS[0] < sinks < _FOLLOWS[1] or np.mean(standing) < _LEAST_STANDING:
        return sinks
    return _slope(pelvis[standing], height[standing])


def _slope(values: Floats, over: Floats) -> float:
    away = over - over.mean()
    return float(np.mean(away * (values - values.mean())) / max(float(over.var()), 1e-12))


def _spread(values: Floats) -> float:
    return float(np.ptp(np.percentile(values, [5.0, 95.0])))


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12))
