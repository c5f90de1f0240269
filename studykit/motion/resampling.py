"""The same movement at another frame rate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from studykit.motion import rotation
from studykit.motion.motion import Motion


def resampled(motion: Motion, frame_rate_hz: float) -> Motion:
    """Give a motion at another frame rate: frames at exactly k / frame_rate_hz from its first.

    Rotations go along the shortest arc between neighbouring frames (slerp), the root along a straight line.
    Nothing is made up beyond the last frame.
    """
    if frame_rate_hz == motion.frame_rate_hz:
        return motion
    every = motion.frame_rate_hz / frame_rate_hz
    if every == round(every):
        step = round(every)
        return replace(
            motion,
            rotations=motion.rotations[::step],
            root_positions=motion.root_positions[::step],
            frame_rate_hz=frame_rate_hz,
        )
    last_s = (len(motion) - 1) / motion.frame_rate_hz
    # A frame that falls on the last one within rounding belongs to it.
    count = int(np.floor(last_s * frame_rate_hz + 1e-9)) + 1
    place = np.minimum(np.arange(count) * (motion.frame_rate_hz / frame_rate_hz), len(motion) - 1)
    before = np.minimum(place.astype(np.int64), max(len(motion) - 2, 0))
    after = np.minimum(before + 1, len(motion) - 1)
    share = place - before
    root = motion.root_positions
    return Motion(
        skeleton=motion.skeleton,
        rotations=rotation.slerp(motion.rotations[before], motion.rotations[after], share[:, None]),
        root_positions=root[before] + share[:, None] * (root[after] - root[before]),
        frame_rate_hz=frame_rate_hz,
    )
