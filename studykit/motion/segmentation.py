"""Cutting takes into segments of four seconds, the building blocks of dances."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from studykit.core.arrays import Floats, Integers
from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion

FRAME_RATE_HZ = 30.0
SEGMENT_FRAMES = 120
SEGMENT_S = SEGMENT_FRAMES / FRAME_RATE_HZ
"""Eight beats at 120 beats a minute, a phrase of most dances."""


def segment_starts(runs: Sequence[tuple[int, int]], *, stride_frames: int = SEGMENT_FRAMES) -> list[int]:
    """Give the first frames of all whole segments in clean stretches.

    Parameters
    ----------
    runs : sequence of (int, int)
        Clean stretches: first frame, and frame after the last.
    stride_frames : int
        From the start of one segment to the next; fewer than 120 let them overlap.

    Examples
    --------
    >>> segment_starts([(0, 250), (300, 400), (410, 530)])
    [0, 120, 410]
    >>> segment_starts([(0, 250)], stride_frames=60)
    [0, 60, 120]
    """
    return [frame for start, stop in runs for frame in range(start, stop - SEGMENT_FRAMES + 1, stride_frames)]


def cut(motion: Motion, positions: Floats, starts: Integers) -> tuple[Floats, Floats]:
    """Cut segments; each begins at the origin, facing +Z, with the floor at height zero.

    One turn is taken for a whole segment, from its first pose, so that the turns within it stay.

    Parameters
    ----------
    motion : Motion
        At 30 frames a second.
    positions : ndarray, shape (frame, 24, 3), m
        Its pelvis-centred joint positions.
    starts : ndarray, shape (segment,)
        First frames.

    Returns
    -------
    rotations : ndarray, shape (segment, 120, 24, 4)
    root_positions : ndarray, shape (segment, 120, 3), m
    """
    frames = starts[:, None] + np.arange(SEGMENT_FRAMES)
    turn = rotation.yaw(-kinematics.facing(positions[starts]))[:, None]
    rotations = motion.rotations[frames]
    rotations[:, :, 0] = rotation.multiply(turn, rotations[:, :, 0])
    root = motion.root_positions[frames]
    origin = root[:, :1] * np.array([1.0, 0.0, 1.0])
    origin[..., 1] = floor_height(positions, motion.root_positions)
    return rotations, rotation.rotate(turn, root - origin)


def floor_height(positions: Floats, root_positions: Floats) -> float:
    """Estimate the height of the floor, m: the lowest joint's height that 5 % of the frames stay below.

    Parameters
    ----------
    positions : ndarray, shape (frame, 24, 3), m
        Pelvis-centred.
    root_positions : ndarray, shape (frame, 3), m
        Where the pelvis is.
    """
    lowest = positions[..., 1].min(axis=1) + root_positions[:, 1]
    return float(np.percentile(lowest, 5.0))
