"""A body put where joints were recorded, or a refusal that says why none fits."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.io.skeleton_map import LEG_LENGTHS_M
from studykit.motion.inverse_kinematics import fit
from studykit.motion.motion import Motion
from studykit.motion.plausibility import RATES_HZ
from studykit.motion.retargeting import leg_length
from studykit.motion.skeleton import JOINT_NAMES, Skeleton


def upright(positions: Floats, up: Literal["Y", "Z"]) -> Floats:
    """Turn what has Z up so that Y is up: (x, y, z) becomes (x, z, -y)."""
    if up == "Y":
        return positions
    return np.stack((positions[..., 0], positions[..., 2], -positions[..., 1]), axis=-1)


def fitted_motion(
    positions: Floats, body: Skeleton, *, rate_hz: float, path: Path, most_error_m: float
) -> Motion:
    """Let a body do what its joints were seen to do.

    Parameters
    ----------
    positions : ndarray, shape (frame, 24, 3), m
        Without gaps, Y up.
    body : Skeleton
        With bones as long as those of the dancer.
    most_error_m : float
        The largest mean distance between the joints of the body and where they were.

    Raises
    ------
    InputError
        If the body is nobody's, or does not fit.
    """
    if not RATES_HZ[0] <= rate_hz <= RATES_HZ[1]:
        problem = f"{rate_hz:g} frames a second are no rate of motion capture"
        raise InputError(problem, where=path, remedy="give the true rate as frame_rate_hz in the recipe")
    length = leg_length(body)
    if not LEG_LENGTHS_M[0] <= length <= LEG_LENGTHS_M[1]:
        raise InputError(
            f"legs of {length:.3g} m (thigh and shank) are nobody's",
            where=path,
            remedy="correct units_m, the file's unit of length in metres",
        )
    found = fit(positions, body, frame_rate_hz=rate_hz)
    mean = float(found.errors.mean())
    if mean > most_error_m:
        worst = JOINT_NAMES[int(np.argmax(found.errors.mean(axis=0)))]
        raise InputError(
            f"no body fits these points: {1000.0 * mean:.0f} mm off on average, most at {worst}",
            where=path,
            remedy="check which joint or marker each column is, and the up axis",
        )
    return Motion(
        skeleton=body, rotations=found.rotations, root_positions=found.root_positions, frame_rate_hz=rate_hz
    )
