"""How a heart follows effort: it rises and falls towards what is asked for, beat by beat."""

from __future__ import annotations

from bisect import bisect_right

import numpy as np

from studykit.core.arrays import Floats
from studykit.participant.person import Person

_TICKS_PER_S = 1024
"""Belts count the time between beats in 1/1024 s."""
_BREATH_HZ = 0.25
_DRIFT_S, _DRIFT_BPM = 12.0, 1.5


def steady_state_bpm(person: Person, demand: float) -> float:
    """Give the heart rate that a person reaches if an effort goes on: rest + demand (maximum - rest).

    Parameters
    ----------
    person : Person
        Whose heart.
    demand : float
        Share of the heart-rate reserve, 0 (rest) to 1 (all out); beyond these it is limited.

    Returns
    -------
    float
        bpm (Karvonen's formula).
    """
    reserve_bpm = person.maximum_heart_rate_bpm - person.resting_heart_rate_bpm
    return person.resting_heart_rate_bpm + min(max(demand, 0.0), 1.0) * reserve_bpm


def response_bpm(
    elapsed_s: Floats | float, start_bpm: float, steady_bpm: float, time_constant_s: float
) -> Floats:
    """Give the heart rate some time after an effort began: steady + (start - steady) exp(-t / tau).

    Parameters
    ----------
    elapsed_s : array_like, s
        Time since the effort began.
    start_bpm, steady_bpm : float
        Heart rate at that moment, and the one it tends to.
    time_constant_s : float
        Time after which 63 % of the way is made.

    Returns
    -------
    ndarray, bpm
        Of the shape of `elapsed_s`.
    """
    return np.asarray(
        steady_bpm + (start_bpm - steady_bpm) * np.exp(-np.asarray(elapsed_s) / time_constant_s)
    )


class Heart:
    """The heart of a simulated person, resting until it is told of an effort.

    Parameters
    ----------
    person : Person
        Gives rest, maximum and how fast the heart follows.
    rng : numpy.random.Generator
        Differences between beats.
    start_s : float, optional
        When the heart begins to be watched, s.
    """

    def __init__(self, person: Person, rng: np.random.Generator, *, start_s: float = 0.0) -> None:
        self._person, self._rng = person, rng
        self._starts_s = [start_s]
        self._efforts = [(person.resting_heart_rate_bpm, person.resting_heart_rate_bpm)]
        self._beat_s = start_s
        self._pending_s: float | None = None
        self._drift_bpm = _DRIFT_BPM * float(rng.normal())

    def exert(self, demand: float, time_s: float) -> None:
        """Ask for an effort from now on.

        Parameters
        ----------
        demand : float
            Share of the heart-rate reserve, 0 (rest) to 1 (all out).
        time_s : float
            When it begins, not before the last change.

        Raises
        ------
        ValueError
            If it lies before the last change.
        """
        if time_s < self._starts_s[-1]:
            raise ValueError("an effort cannot begin before the one that it follows")
        effort = (self.rate_bpm(time_s), steady_state_bpm(self._person, demand))
        self._starts_s.append(time_s)
        self._efforts.append(effort)

    def rate_bpm(self, time_s: float) -> float:
        """Give the heart rate at a moment, without the differences between beats."""
        number = max(bisect_right(self._starts_s, time_s) - 1, 0)
        start_bpm, steady_bpm = self._efforts[number]
        time_constant_s = self._person.rise_s if steady_bpm > start_bpm else self._person.fall_s
        return float(response_bpm(time_s - self._starts_s[number], start_bpm, steady_bpm, time_constant_s))

    def beats_until(self, time_s: float) -> list[float]:
        """Give the RR intervals of the beats since the last call.

        Parameters
        ----------
        time_s : float
            Up to when.

        Returns
        -------
        list of float, s
            Oldest first, each a whole number of 1/1024 s.
        """
        intervals_s = []
        while (interval_s := self._interval_s()) + self._beat_s <= time_s:
            self._beat_s += interval_s
            intervals_s.append(interval_s)
            self._pending_s = None
        return intervals_s

    def _interval_s(self) -> float:
        """Draw the time to the next beat, once."""
        if self._pending_s is None:
            rate_bpm = self.rate_bpm(self._beat_s)
            kept = float(np.exp(-60.0 / rate_bpm / _DRIFT_S))
            drift, jitter = self._rng.normal(size=2)
            self._drift_bpm = kept * self._drift_bpm + np.sqrt(1.0 - kept**2) * _DRIFT_BPM * float(drift)
            # Breathing sways a resting heart by some 3 % and a racing one hardly at all.
            calm = (
                1.0 - (rate_bpm - self._person.resting_heart_rate_bpm) / self._person.maximum_heart_rate_bpm
            )
            breath = 0.03 * max(calm, 0.1) ** 3 * np.sin(2.0 * np.pi * _BREATH_HZ * self._beat_s)
            interval_s = 60.0 / max(rate_bpm + self._drift_bpm, 30.0) * (1.0 + breath + 0.006 * float(jitter))
            self._pending_s = round(interval_s * _TICKS_PER_S) / _TICKS_PER_S
        return self._pending_s
