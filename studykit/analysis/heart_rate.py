"""How hard somebody worked, from the heart rate that a chest strap reported."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from studykit.core.arrays import Floats

Formula = Literal["tanaka", "fox"]

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
