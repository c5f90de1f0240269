"""The same movement at another frame rate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from studykit.motion import rotation
from studykit.motion.motion import Motion

NEARLY = 2e-3
"""A rate this close to a multiple of the one wanted is taken for it: 29.97, 59.94 and rounded frame times."""


def every_nth(frame_rate_hz: float, wanted_hz: float) -> int | None:
    """Tell whether every n-th frame gives the rate wanted, and which n; None if frames must be interpolated.

    Examples
    --------
    >>> every_nth(59.94, 30.0), every_nth(1.0 / 0.03333333, 30.0), every_nth(100.0, 30.0)
    (2, 1, None)
    """
    every = round(frame_rate_hz / wanted_hz)
    return every if every and abs(frame_rate_hz / wanted_hz - every) <= NEARLY * every else None


def resampled(motion: Motion, frame_rate_hz: float) -> Motion:
    """Give a motion at another frame rate.

    Where the rate is, within 0.2 %, a multiple of the one wanted, every n-th frame is taken as it is: the
    tempo changes by no more than that, and no detail is lost. Else frames lie at exactly k / frame_rate_hz
    from the first: rotations go along the shortest arc between neighbouring frames (slerp), the root along a
    straight line, which takes some of the trembling out of a measurement. Nothing is made up beyond the last
    frame.
    """
    every = every_nth(motion.frame_rate_hz, frame_rate_hz)
    if every is not None:
        return replace(
            motion,
            rotations=motion.rotations[::every],
            root_positions=motion.root_positions[::every],
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
