"""Cutting takes into segments of four seconds, the building blocks of dances."""

from __future__ import annotations

import numpy as np

from studykit.motion import kinematics
from studykit.motion.motion import Motion

FRAME_RATE_HZ = 30.0
SEGMENT_FRAMES = 120
SEGMENT_S = SEGMENT_FRAMES / FRAME_RATE_HZ
"""Eight beats at 120 beats a minute, a phrase of most dances."""


def segment_starts(runs: list[tuple[int, int]]) -> list[int]:
    """Give the first frames of all whole segments in clean stretches, one after the other without overlap.

    Examples
    --------
    >>> segment_starts([(0, 250), (300, 400), (410, 530)])
    [0, 120, 410]
    """
    return [
        frame for start, stop in runs for frame in range(start, stop - SEGMENT_FRAMES + 1, SEGMENT_FRAMES)
    ]


def segment(motion: Motion, start: int, floor_m: float) -> Motion:
    """Cut one segment, begin it at the origin, facing +Z, and put the floor at height zero.

    One turn is taken for the whole segment, from its first pose, so that the turns within it stay.

    Parameters
    ----------
    motion : Motion
        At 30 frames a second.
    start : int
        First frame.
    floor_m : float
        Height of the floor in the take.
    """
    frames = slice(start, start + SEGMENT_FRAMES)
    root = motion.root_positions[frames] - np.array(
        [*motion.root_positions[start, [0]], floor_m, motion.root_positions[start, 2]]
    )
    cut = Motion(
        skeleton=motion.skeleton,
        rotations=motion.rotations[frames],
        root_positions=root,
        frame_rate_hz=motion.frame_rate_hz,
    )
    first = kinematics.centred_positions(cut.skeleton, cut.rotations[0])
    return kinematics.turned(cut, -float(kinematics.facing(first)))


def floor_height(motion: Motion) -> float:
    """Estimate the height of the floor, m: the lowest joint's height that 5 % of the frames stay below."""
    lowest = kinematics.joint_positions(motion)[..., 1].min(axis=1)
    return float(np.percentile(lowest, 5.0))
