"""How hard somebody worked, from the heart rate that a chest strap reported."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from studykit.core.arrays import Floats

Formula = Literal["tanaka", "fox"]
Maximum = Literal["tanaka", "fox", "measured"]

VIGOROUS_RESERVE = 0.6
"""Share of the heart-rate reserve from which exercise is vigorous (Garber et al. 2011)."""
SETTLED_S = 60.0
"""The end of a rest that counts for the resting heart rate, s: before, the heart is still falling."""
RECOVERY_S = 60.0
"""When the recovery of the heart rate is read, s after the effort (Cole et al. 1999)."""

# A threshold such as 0.7 x 190 bpm is not exact in binary; a reading equal to it on paper counts.
_ROUNDING_BPM = 1e-9


@dataclass(frozen=True, kw_only=True, slots=True)
class ZoneTime:
    """How long the heart beat at or above a threshold.

    Parameters
    ----------
    seconds : float
        Time at or above the threshold, s.
    counted_s : float
        Time for which a reading stood at all, s.
    """

    seconds: float
    counted_s: float

    @property
    def fraction(self) -> float:
        """Share of the counted time, 0 to 1; NaN if no time counted."""
        return self.seconds / self.counted_s if self.counted_s > 0.0 else math.nan


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Held:
    """Heart-rate readings and how long each of them stood.

    Parameters
    ----------
    heart_rate_bpm : ndarray, shape (reading,), bpm
    seconds : ndarray, shape (reading,), s
    """

    heart_rate_bpm: Floats
    seconds: Floats


def maximum(age: float, formula: Formula) -> float:
    """Predict the highest heart rate that a person of this age can reach.

    Parameters
    ----------
    age : float
        Years.
    formula : {"tanaka", "fox"}
        208 - 0.7 age (Tanaka et al. 2001), or 220 - age (Fox).

    Returns
    -------
    float
        bpm. People differ from it by about 10 bpm (standard deviation).

    Examples
    --------
    >>> maximum(20, "tanaka"), maximum(20, "fox")
    (194.0, 200.0)
    """
    predicted = {"tanaka": 208.0 - 0.7 * age, "fox": 220.0 - age}
    if formula not in predicted:
        raise ValueError(f'formula is "{formula}", expected "tanaka" or "fox"')
    return predicted[formula]


def at_reserve(share: float, *, resting_bpm: float, maximum_bpm: float) -> float:
    """Give the heart rate at a share of the way from rest to the maximum (Karvonen et al. 1957).

    Examples
    --------
    >>> at_reserve(0.6, resting_bpm=60.0, maximum_bpm=190.0)
    138.0
    """
    return resting_bpm + share * (maximum_bpm - resting_bpm)


def held(
    times_s: Floats,
    heart_rate_bpm: Floats,
    *,
    longest_gap_s: float,
    start_s: float = -math.inf,
    stop_s: float = math.inf,
) -> Held:
    """Find how long each heart-rate reading stood within a window of time.

    A reading stands until the next one. A silence longer than `longest_gap_s` counts for nothing, the last
    reading of the recording has no length, and 0 bpm or NaN is no reading.

    Parameters
    ----------
    times_s : array_like, shape (reading,), s
        When each reading arrived, never decreasing.
    heart_rate_bpm : array_like, shape (reading,), bpm
    longest_gap_s : float
        The longest silence, s, over which a reading still stands; ``math.inf`` counts every silence.
    start_s, stop_s : float, optional
        The window, s; the whole recording if not given. A reading from before the window that still stands
        when it starts counts from there.

    Returns
    -------
    Held
        Only readings with some length.

    Raises
    ------
    ValueError
        If the lists differ in length or the times decrease.
    """
    times, readings = np.asarray(times_s, dtype=np.float64), np.asarray(heart_rate_bpm, dtype=np.float64)
    if times.ndim != 1 or times.shape != readings.shape:
        raise ValueError("times_s and heart_rate_bpm must be two lists of the same length")
    if np.any(np.diff(times) < 0.0):
        raise ValueError("times_s must not decrease")
    is_reading = readings > 0.0
    times, readings = times[is_reading], readings[is_reading]
    within = np.clip(times, start_s, stop_s)
    seconds = np.where(np.diff(times) <= longest_gap_s, np.diff(within), 0.0)
    stands = seconds > 0.0
    return Held(heart_rate_bpm=readings[:-1][stands], seconds=seconds[stands])


def mean_bpm(
    times_s: Floats, heart_rate_bpm: Floats, start_s: float, stop_s: float, longest_gap_s: float
) -> float:
    """Give the mean heart rate in a window of time, each reading weighted by how long it stood.

    Parameters
    ----------
    times_s : array_like, shape (reading,), s
    heart_rate_bpm : array_like, shape (reading,), bpm
    start_s, stop_s, longest_gap_s : float
        See `held`.

    Returns
    -------
    float
        bpm; NaN if no reading stood in the window.

    Examples
    --------
    >>> mean_bpm([0.0, 1.0, 4.0], [100.0, 120.0, 90.0], 0.0, 4.0, 10.0)
    115.0
    """
    part = held(times_s, heart_rate_bpm, longest_gap_s=longest_gap_s, start_s=start_s, stop_s=stop_s)
    if not part.seconds.size:
        return math.nan
    return float(np.average(part.heart_rate_bpm, weights=part.seconds))


def peak_bpm(
    times_s: Floats, heart_rate_bpm: Floats, start_s: float, stop_s: float, longest_gap_s: float
) -> float:
    """Give the highest heart rate that stood in a window of time; see `mean_bpm`."""
    part = held(times_s, heart_rate_bpm, longest_gap_s=longest_gap_s, start_s=start_s, stop_s=stop_s)
    return float(part.heart_rate_bpm.max()) if part.seconds.size else math.nan


def seconds_at_or_above(
    times_s: Floats,
    heart_rate_bpm: Floats,
    threshold_bpm: float,
    longest_gap_s: float,
    *,
    start_s: float = -math.inf,
    stop_s: float = math.inf,
) -> ZoneTime:
    """Measure how long the heart rate stood at or above a threshold.

    Parameters
    ----------
    times_s : array_like, shape (reading,), s
    heart_rate_bpm : array_like, shape (reading,), bpm
    threshold_bpm : float
        bpm; for vigorous exercise a share, such as 0.7, of `maximum`.
    longest_gap_s, start_s, stop_s : float
        See `held`.

    Examples
    --------
    >>> seconds_at_or_above([0.0, 1.0, 4.0], [100.0, 140.0, 90.0], 133.0, 10.0)
    ZoneTime(seconds=3.0, counted_s=4.0)
    """
    part = held(times_s, heart_rate_bpm, longest_gap_s=longest_gap_s, start_s=start_s, stop_s=stop_s)
    above = part.heart_rate_bpm >= threshold_bpm - _ROUNDING_BPM
    return ZoneTime(seconds=float(part.seconds[above].sum()), counted_s=float(part.seconds.sum()))


def zones(
    times_s: Floats,
    heart_rate_bpm: Floats,
    bounds_bpm: Sequence[float],
    longest_gap_s: float,
    *,
    start_s: float = -math.inf,
    stop_s: float = math.inf,
) -> tuple[ZoneTime, ...]:
    """Measure how long the heart rate stood in each zone between bounds.

    Parameters
    ----------
    times_s : array_like, shape (reading,), s
    heart_rate_bpm : array_like, shape (reading,), bpm
    bounds_bpm : sequence of float
        Where each zone but the first begins, bpm, rising: shares of `maximum`, or of the reserve by
        `at_reserve`. A reading on a bound belongs to the zone above.
    longest_gap_s, start_s, stop_s : float
        See `held`.

    Returns
    -------
    tuple of ZoneTime
        One more than there are bounds, the easiest zone first.
    """
    if np.any(np.diff(bounds_bpm) <= 0.0):
        raise ValueError("bounds_bpm must rise")
    part = held(times_s, heart_rate_bpm, longest_gap_s=longest_gap_s, start_s=start_s, stop_s=stop_s)
    zone = np.searchsorted(np.asarray(bounds_bpm) - _ROUNDING_BPM, part.heart_rate_bpm, side="right")
    seconds = np.bincount(zone, weights=part.seconds, minlength=len(bounds_bpm) + 1)
    counted_s = float(part.seconds.sum())
    return tuple(ZoneTime(seconds=float(one), counted_s=counted_s) for one in seconds)


def standing(
    times_s: Floats, heart_rate_bpm: Floats, moments_s: Floats | float, longest_gap_s: float
) -> Floats:
    """Give the heart rate that stood at given moments, NaN where the belt had been silent for too long.

    Parameters
    ----------
    times_s : array_like, shape (reading,), s
    heart_rate_bpm : array_like, shape (reading,), bpm
    moments_s : array_like, shape (moment,), s
    longest_gap_s : float
        How old a reading may be, s.

    Returns
    -------
    ndarray, shape (moment,), bpm
    """
    readings, moments = np.asarray(heart_rate_bpm, dtype=np.float64), np.asarray(moments_s, dtype=np.float64)
    is_reading = readings > 0.0
    known_s, known = np.asarray(times_s, dtype=np.float64)[is_reading], readings[is_reading]
    if not known.size:
        return np.full(moments.shape, np.nan)
    latest = np.searchsorted(known_s, moments, side="right") - 1
    stands = (latest >= 0) & (moments - known_s[latest] <= longest_gap_s)
    return np.where(stands, known[latest], np.nan)


def resting_bpm(
    times_s: Floats, heart_rate_bpm: Floats, start_s: float, stop_s: float, longest_gap_s: float
) -> float:
    """Give the resting heart rate: the mean over the last minute of a time of rest; see `mean_bpm`."""
    return mean_bpm(times_s, heart_rate_bpm, max(start_s, stop_s - SETTLED_S), stop_s, longest_gap_s)


def recovery_bpm(times_s: Floats, heart_rate_bpm: Floats, stop_s: float, longest_gap_s: float) -> float:
    """Give by how much the heart rate fell in the minute after an effort.

    Parameters
    ----------
    times_s : array_like, shape (reading,), s
    heart_rate_bpm : array_like, shape (reading,), bpm
    stop_s : float
        When the effort ended, s.
    longest_gap_s : float
        How old a reading may be, s.

    Returns
    -------
    float
        bpm; NaN if nothing is known at either moment. Above 12 bpm is normal after a maximal test with a slow
        walk afterwards (Cole et al. 1999, doi 10.1056/NEJM199910283411804).
    """
    ended, later = standing(times_s, heart_rate_bpm, np.array([stop_s, stop_s + RECOVERY_S]), longest_gap_s)
    return float(ended - later)
