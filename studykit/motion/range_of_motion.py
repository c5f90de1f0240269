"""How far joints turn in a movement."""

from __future__ import annotations

import numpy as np

from studykit.core.arrays import Floats
from studykit.motion import rotation

_MIDDLE_PERCENT = (2.5, 97.5)  # single frames, which a camera may have seen wrong, do not make a range


def range_of_motion(rotations: Floats) -> Floats:
    """Give through what angle each joint turns, along the axis about which it turns most.

    Parameters
    ----------
    rotations : ndarray, shape (frame, joint, 4)
        Parent-relative unit quaternions.

    Returns
    -------
    ndarray, shape (joint,), rad
        The middle 95 % of the frames.

    Notes
    -----
    Turns are told as rotation vectors from the mean pose (Markley et al. 2007); their first principal axis is
    the one about which the joint turns most.
    """
    mean = np.linalg.eigh(np.einsum("fji,fjk->jik", rotations, rotations))[1][..., -1]
    away = rotation.multiply(rotation.inverse(mean), rotations)
    sine = np.linalg.norm(away[..., 1:], axis=-1)
    # The angle over its sine is 2 where there is no turn; the sign takes the shorter way round.
    scale = 2.0 * np.arctan2(sine, np.abs(away[..., 0])) / np.where(sine > 0.0, sine, 1.0)
    turns = away[..., 1:] * (np.sign(away[..., 0]) * scale)[..., None]
    centred = turns - turns.mean(axis=0)
    main = np.linalg.eigh(np.einsum("fji,fjk->jik", centred, centred))[1][..., -1]
    low, high = np.percentile(np.einsum("fji,ji->fj", centred, main), _MIDDLE_PERCENT, axis=0)
    return np.asarray(high - low)
