"""Joint positions as a table that every statistics program reads."""

from __future__ import annotations

import numpy as np

from studykit.motion import kinematics
from studykit.motion.motion import Motion


def joint_table_text(motion: Motion) -> str:
    """Write where every joint is as CSV: `time_s`, then `pelvis_x`, `pelvis_y`, `pelvis_z` and so on, in m.

    Numbers have as many digits as it takes to read back the very same number. Y is up.
    """
    times = np.arange(len(motion)) / motion.frame_rate_hz
    rows = np.column_stack((times, kinematics.joint_positions(motion).reshape(len(motion), -1)))
    names = (f"{joint}_{axis}" for joint in motion.skeleton.joint_names for axis in "xyz")
    lines = [",".join(("time_s", *names)), *(",".join(map(repr, row)) for row in rows.tolist())]
    return "\n".join(lines) + "\n"
