"""A recording on the skeleton of its own file, before it is carried over to SMPL's."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from studykit.core.arrays import Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SkeletalTake:
    """A take as its file has it: its own skeleton, its own units, its own frame rate.

    Parameters
    ----------
    path : Path
        Where it was read.
    joint_names : tuple of str
        The joints in the order of the file.
    parents : tuple of int
        The parent of each joint, -1 for the root.
    offsets : ndarray, shape (joint, 3)
        Rest offsets in the file's unit.
    rotations : ndarray, shape (frame, joint, 4)
        Parent-relative unit quaternions.
    root_positions : ndarray, shape (frame, 3)
        In the file's unit.
    frame_rate_hz : float
        What the file says (or its format, where files do not say); for some public takes this is wrong.
    shifts : dict of int to ndarray, shape (frame, 3)
        Where joints other than the root lie from their parent, for those that the file moves; they stand in
        the place of the offsets where the travel of a body is kept in them.
    """

    path: Path
    joint_names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Floats
    rotations: Floats
    root_positions: Floats
    frame_rate_hz: float
    shifts: dict[int, Floats] = field(default_factory=dict)
