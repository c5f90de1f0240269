"""Joining segments into one movement, without a jump."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from studykit.core.arrays import Floats
from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion

Blend = Literal["offset", "bridge"]
HALF_WINDOW = 5
"""Frames changed on each side of a join; the paper's window of ten."""


def joined(segments: Sequence[Motion], *, blend: Blend = "offset") -> Motion:
    """Play segments one after the other as one movement.

    Each segment begins where the last one ended, facing the same way. No frame is added or lost, so the
    duration is exact.

    Parameters
    ----------
    segments : sequence of Motion
        Same skeleton and frame rate; at least 12 frames each.
    blend : {"offset", "bridge"}
        "offset" spreads the mismatch of positions and velocities at a join over five frames on each side and
        keeps the dancing beneath. "bridge" replaces those ten frames by the straight way between the poses
        around them, as the paper prints it.
    """
    walked = _one_path(segments)
    rotations = np.concatenate([segment.rotations for segment in walked])
    roots = np.concatenate([segment.root_positions for segment in walked])
    frame = 0
    for segment in walked[:-1]:
        frame += len(segment)
        if blend == "offset":
            _spread_mismatch(rotations, roots, frame)
        else:
            _bridge(rotations, roots, frame)
    first = segments[0]
    return Motion(
        skeleton=first.skeleton, rotations=rotations, root_positions=roots, frame_rate_hz=first.frame_rate_hz
    )


def _one_path(segments: Sequence[Motion]) -> list[Motion]:
    """Move and turn each segment to where, and which way, the last one left off."""
    out = [segments[0]]
    for segment in segments[1:]:
        before = out[-1]
        ends = [
            float(kinematics.facing(kinematics.centred_positions(motion.skeleton, motion.rotations[frame])))
            for motion, frame in ((before, -1), (segment, 0))
        ]
        turned = kinematics.turned(segment, ends[0] - ends[1])
        # The first frame comes one frame time after the last: the root goes on as it went.
        step = 0.5 * (
            before.root_positions[-1]
            - before.root_positions[-2]
            + turned.root_positions[1]
            - turned.root_positions[0]
        )
        shift = (before.root_positions[-1] + step - turned.root_positions[0]) * np.array([1.0, 0.0, 1.0])
        out.append(
            Motion(
                skeleton=turned.skeleton,
                rotations=turned.rotations,
                root_positions=turned.root_positions + shift,
                frame_rate_hz=turned.frame_rate_hz,
            )
        )
    return out


def _spread_mismatch(rotations: Floats, roots: Floats, frame: int) -> None:
    """Make both sides of a join meet in position and velocity, half of the way each (in place).

    Half a frame beyond each side both are extrapolated to the same moment; their difference there, and that
    of their velocities, fades to nothing five frames away along a cubic Hermite curve in log space.
    """
    before, after = rotations[frame - 2 : frame], rotations[frame : frame + 2]
    speed_before, speed_after = rotation.between(*before), rotation.between(*after)
    meet_before = rotation.multiply(before[1], rotation.exp(0.5 * speed_before))
    meet_after = rotation.multiply(after[0], rotation.exp(-0.5 * speed_after))
    gap = rotation.between(meet_before, meet_after)
    # Both speeds as seen from the pose halfway, where the sides will meet.
    half = rotation.exp(0.5 * gap)
    speed_gap = rotation.rotate(half, speed_after) - rotation.rotate(rotation.inverse(half), speed_before)

    root_speeds = roots[frame - 1] - roots[frame - 2], roots[frame + 1] - roots[frame]
    root_gap = (roots[frame] - 0.5 * root_speeds[1]) - (roots[frame - 1] + 0.5 * root_speeds[0])
    root_speed_gap = root_speeds[1] - root_speeds[0]

    near = 1.0 - (np.arange(HALF_WINDOW) + 0.5) / HALF_WINDOW  # 1 at the join, 0 five frames away
    value = near**2 * (3.0 - 2.0 * near)
    slope = HALF_WINDOW * near**2 * (near - 1.0)
    for side, frames in ((1.0, frame - 1 - np.arange(HALF_WINDOW)), (-1.0, frame + np.arange(HALF_WINDOW))):
        turn = 0.5 * (side * value[:, None, None] * gap + slope[:, None, None] * speed_gap)
        rotations[frames] = rotation.multiply(rotations[frames], rotation.exp(turn))
        roots[frames] += 0.5 * (side * value[:, None] * root_gap + slope[:, None] * root_speed_gap)


def _bridge(rotations: Floats, roots: Floats, frame: int) -> None:
    """Replace ten frames around a join by the straight way between the frames around them (in place)."""
    start, end = frame - HALF_WINDOW - 1, frame + HALF_WINDOW
    share = np.arange(1, 2 * HALF_WINDOW + 1) / (2 * HALF_WINDOW + 1)
    rotations[start + 1 : end] = rotation.slerp(rotations[start], rotations[end], share[:, None])
    roots[start + 1 : end] = roots[start] + share[:, None] * (roots[end] - roots[start])
