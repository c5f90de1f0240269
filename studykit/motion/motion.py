"""Motions: a body over time, as rotations of its joints or as positions that a camera saw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from studykit.core.arrays import Floats, frozen
from studykit.motion.skeleton import Skeleton


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Motion:
    """A body moving: how every joint is turned, and where the root is, frame by frame.

    Parameters
    ----------
    skeleton : Skeleton
        The body that moves.
    rotations : array_like, shape (frame, joint, 4)
        Unit quaternions, scalar first, each relative to the joint's parent; the root's relative to the world.
    root_positions : array_like, shape (frame, 3), m
        Where the root is: right-handed axes, Y up.
    frame_rate_hz : float
        Frames a second, as recorded, never rounded.

    Raises
    ------
    ValueError
        If shapes differ, a number is not finite, a quaternion is not of unit length (within 1e-3; smaller
        errors are normalised away) or the rate is not positive.
    """

    skeleton: Skeleton
    rotations: Floats
    root_positions: Floats
    frame_rate_hz: float

    def __post_init__(self) -> None:
        joints = len(self.skeleton.joint_names)
        rotations = np.array(self.rotations, dtype=np.float64)
        if rotations.ndim != 3 or rotations.shape[1:] != (joints, 4):
            raise ValueError(f"rotations has the shape {rotations.shape}, expected (frame, {joints}, 4)")
        if not self.frame_rate_hz > 0.0:
            raise ValueError(f"frame_rate_hz is {self.frame_rate_hz}, expected a positive rate")
        lengths = np.linalg.norm(rotations, axis=-1, keepdims=True)
        if not np.all(np.abs(lengths - 1.0) < 1e-3):
            raise ValueError("rotations must be finite quaternions of unit length")
        rotations /= lengths
        rotations.flags.writeable = False
        root = frozen(self.root_positions, shape=(len(rotations), 3), name="root_positions")
        if not np.all(np.isfinite(root)):
            raise ValueError("root_positions must be finite")
        object.__setattr__(self, "rotations", rotations)
        object.__setattr__(self, "root_positions", root)

    def __len__(self) -> int:
        return len(self.rotations)

    @property
    def duration_s(self) -> float:
        """Length in seconds: each frame lasts one frame time."""
        return len(self) / self.frame_rate_hz


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class JointTracks:
    """Joints over time as a camera sees them: positions only, with gaps.

    Parameters
    ----------
    positions : array_like, shape (frame, joint, 3), m
        Right-handed axes, Y up, facing +Z; NaN where a joint was not seen.
    confidence : array_like, shape (frame, joint)
        0 (not seen) to 1 (certain).
    times_s : array_like, shape (frame,), s
        When each frame was taken, strictly increasing.
    joint_names : tuple of str
        One name a joint.

    Raises
    ------
    ValueError
        If shapes differ, times do not increase or a confidence lies outside 0-1.
    """

    positions: Floats
    confidence: Floats
    times_s: Floats
    joint_names: tuple[str, ...]

    def __post_init__(self) -> None:
        joints = len(self.joint_names)
        times = frozen(self.times_s, shape=(None,), name="times_s")
        positions = frozen(self.positions, shape=(len(times), joints, 3), name="positions")
        confidence = frozen(self.confidence, shape=(len(times), joints), name="confidence")
        if not np.all(np.diff(times) > 0.0):
            raise ValueError("times_s must increase strictly")
        if not np.all((confidence >= 0.0) & (confidence <= 1.0)):
            raise ValueError("confidence must lie between 0 and 1")
        object.__setattr__(self, "positions", positions)
        object.__setattr__(self, "confidence", confidence)
        object.__setattr__(self, "times_s", times)

    def __len__(self) -> int:
        return len(self.times_s)
