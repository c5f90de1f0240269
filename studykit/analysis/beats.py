"""Times between heartbeats, freed of beats that were missed, counted twice or came too early."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from studykit.core.arrays import Booleans, Floats

SHORTEST_S, LONGEST_S = 0.3, 2.0
"""No heart beats faster than 200 or slower than 30 a minute in a study such as these, s."""
TOLERANCE = 0.2
"""A time between beats is wrong if it differs from the median around it by more than this share."""
_NEIGHBOURHOOD = 5  # beats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Beats:
    """Times between heartbeats after correction.

    Parameters
    ----------
    intervals_s : ndarray, shape (beat,), s
        Wrong ones replaced by the median of their neighbourhood; NaN where there is none to be trusted.
    is_corrected : ndarray, shape (beat,)
        Which were wrong.
    """

    intervals_s: Floats
    is_corrected: Booleans

    @property
    def corrected_share(self) -> float:
        """Share of beats that were wrong, 0 to 1; NaN without any beat."""
        return float(self.is_corrected.mean()) if self.is_corrected.size else np.nan


def corrected(intervals_s: Floats) -> Beats:
    """Replace times between heartbeats that cannot be right.

    Parameters
    ----------
    intervals_s : array_like, shape (beat,), s
        As a belt sent them, in their order.

    Returns
    -------
    Beats

    Notes
    -----
    A time is wrong outside 0.3 to 2 s, or if it differs by more than 20 % from the median of the five
    possible times around it: Malik's 20 % (Task Force 1996, doi 10.1161/01.CIR.93.5.1043), against a local
    median rather than the beat before, as Kubios does, so that one wrong beat does not condemn the next.

    Examples
    --------
    A beat that the belt missed makes one time twice as long:

    >>> corrected([0.8, 0.8, 0.8, 1.6, 0.8, 0.8]).intervals_s.tolist()
    [0.8, 0.8, 0.8, 0.8, 0.8, 0.8]
    """
    intervals = np.asarray(intervals_s, dtype=np.float64)
    if intervals.ndim != 1:
        raise ValueError(f"intervals_s has the shape {intervals.shape}, expected (beat,)")
    is_possible = (intervals >= SHORTEST_S) & (intervals <= LONGEST_S)
    middle = np.full(len(intervals), np.nan)
    possible = intervals[is_possible]
    if possible.size:
        middle[is_possible] = _local_median(possible)
        # What is impossible takes the median around the possible time before it.
        at = np.maximum(np.cumsum(is_possible) - 1, 0)
        middle = np.where(is_possible, middle, _local_median(possible)[at])
    is_wrong = ~is_possible | (np.abs(intervals - middle) > TOLERANCE * middle)
    return Beats(intervals_s=np.where(is_wrong, middle, intervals), is_corrected=is_wrong)


def _local_median(values: Floats) -> Floats:
    """Give the median of each value's neighbourhood, which is cut off at either end."""
    half = _NEIGHBOURHOOD // 2
    padded = np.concatenate([np.full(half, np.nan), values, np.full(half, np.nan)])
    return np.asarray(np.nanmedian(np.lib.stride_tricks.sliding_window_view(padded, _NEIGHBOURHOOD), axis=1))


def rates(times_s: Floats, beats: Beats) -> tuple[Floats, Floats]:
    """Give heart-rate readings from beats, each the mean of the last five, as belts show them.

    Parameters
    ----------
    times_s : array_like, shape (beat,), s
        When each time between beats ended.
    beats : Beats

    Returns
    -------
    times_s : ndarray, shape (beat,), s
    heart_rate_bpm : ndarray, shape (beat,), bpm
    """
    known = np.isfinite(beats.intervals_s)
    intervals, times = beats.intervals_s[known], np.asarray(times_s, dtype=np.float64)[known]
    sums = np.concatenate([[0.0], np.cumsum(intervals)])
    counts = np.minimum(np.arange(1, len(intervals) + 1), _NEIGHBOURHOOD)
    last = np.arange(1, len(intervals) + 1)
    return times, 60.0 * counts / (sums[last] - sums[last - counts])
