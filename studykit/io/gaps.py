"""Moments in which something recorded was lost from sight."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError

LONGEST_S = 0.5
"""Longer gaps are not filled: nobody knows what a limb did in them."""


def filled(
    positions: Floats, names: tuple[str, ...], frame_rate_hz: float, path: Path
) -> tuple[Floats, dict[str, int]]:
    """Fill short gaps in a straight line, and count the frames filled.

    Parameters
    ----------
    positions : ndarray, shape (frame, point, 3)
        NaN where a point was lost. One lost at the start or end stays where it is first or last seen.
    names : tuple of str
        Of the points.
    path : Path
        For the error.

    Returns
    -------
    tuple of ndarray, shape (frame, point, 3), and dict of str to int
        Without gaps, and how many frames were filled for each point that was ever lost.

    Raises
    ------
    InputError
        If a point is never seen, or lost for more than half a second; names the frames, counted from 1.
    """
    whole = np.array(positions)
    counts: dict[str, int] = {}
    lost = ~np.all(np.isfinite(positions), axis=-1)
    for point in np.flatnonzero(lost.any(axis=0)):
        gone = np.flatnonzero(lost[:, point])
        if len(gone) == len(positions):
            raise InputError(
                f"{names[point]} is never seen",
                where=path,
                remedy="leave it out of the map of markers, or label it in the recording program",
            )
        for run in np.split(gone, np.flatnonzero(np.diff(gone) > 1) + 1):
            if len(run) > LONGEST_S * frame_rate_hz:
                raise InputError(
                    f"{names[point]} is lost in frames {run[0] + 1}-{run[-1] + 1}, more than {LONGEST_S} s",
                    where=path,
                    remedy="fill the gap in the recording program, or cut the take there",
                )
        there = np.flatnonzero(~lost[:, point])
        for axis in range(3):
            whole[gone, point, axis] = np.interp(gone, there, positions[there, point, axis])
        counts[names[point]] = len(gone)
    return whole, counts
