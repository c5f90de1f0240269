"""The same movement on another body."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY, Skeleton


def leg_length(skeleton: Skeleton) -> float:
    """Give the length of thigh and shank, mean of both sides, m."""
    bones = [f"{side}_{joint}" for side in ("left", "right") for joint in ("knee", "ankle")]
    return float(sum(np.linalg.norm(skeleton.offsets[skeleton.index(bone)]) for bone in bones) / 2.0)


def on_neutral_body(motion: Motion) -> Motion:
    """Let studykit's one body do what another body of the same 24 joints did.

    Every joint turns as it was turned. The way of the root is scaled by the length of the legs, so that feet
    that stood still slide little.
    """
    if motion.skeleton is NEUTRAL_BODY:
        return motion
    scale = leg_length(NEUTRAL_BODY) / leg_length(motion.skeleton)
    return replace(motion, skeleton=NEUTRAL_BODY, root_positions=motion.root_positions * scale)
