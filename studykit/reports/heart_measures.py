"""Measuring the heart in a trial: one condition danced once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from studykit.analysis import heart_rate
from studykit.analysis.beats import Beats, corrected, rates
from studykit.core.arrays import Floats
from studykit.recording.session_record import SessionRecord, StepRecord
from studykit.reports.choices import Choices

_EFFORTS = ("train", "watch", "perform")


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HeartMeasures:
    """The heart in a trial; NaN where the belt said too little.

    Parameters
    ----------
    mean_bpm, peak_bpm : float
        bpm, in the window.
    coverage : float
        Share of the window for which a reading stood.
    vigorous_fraction, vigorous_fraction_reserve : float
        Share of the time covered at or above the vigorous share of the maximum, and of the reserve.
    resting_bpm : float
        bpm, at the end of the visit's baseline.
    recovery_bpm : float
        How much the heart rate fell in the minute after dancing, bpm; NaN if that minute was no rest.
    corrected_share : float
        Share of the times between beats in the window that were wrong; NaN if the belt sent none.
    """

    mean_bpm: float
    peak_bpm: float
    coverage: float
    vigorous_fraction: float
    vigorous_fraction_reserve: float
    resting_bpm: float
    recovery_bpm: float
    corrected_share: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Readings:
    """The heart rate of a visit, from the source that is chosen.

    Parameters
    ----------
    times_s, bpm : ndarray, shape (reading,), s and bpm
        The readings.
    beat_times_s : ndarray, shape (beat,), s
        When each time between beats ended.
    beats : Beats
        The times between beats, corrected.
    """

    times_s: Floats
    bpm: Floats
    beat_times_s: Floats
    beats: Beats

    @classmethod
    def of(cls, record: SessionRecord, choices: Choices) -> Readings:
        """Take them from a visit; from the belt's own readings where it sent no times between beats."""
        beats = corrected(record.beat_intervals_s)
        times, bpm = record.heart_rate_times_s, record.heart_rate_bpm
        if choices.heart_source == "beats" and len(record.beat_times_s):
            times, bpm = rates(record.beat_times_s, beats)
        return cls(times_s=times, bpm=bpm, beat_times_s=record.beat_times_s, beats=beats)


def heart_measures(
    record: SessionRecord, step: StepRecord, choices: Choices, *, readings: Readings | None = None
) -> HeartMeasures:
    """Measure the heart in the chosen window around a step.

    Parameters
    ----------
    record : SessionRecord
        The visit. Without an age in it (or a measured maximum, if that is chosen) nothing can be vigorous.
    step : StepRecord
        The step in which the dance was performed.
    choices : Choices
        Gives the window, the maximum, the vigorous threshold and the longest gap.
    readings : Readings, optional
        Those of the visit, if there already.
    """
    readings = readings or Readings.of(record, choices)
    times, bpm, gap_s = readings.times_s, readings.bpm, choices.longest_gap_s
    start, stop = _window(record, step, choices)
    resting = _resting_bpm(record, readings, gap_s)
    maximum = _maximum_bpm(record, choices)
    part = heart_rate.held(times, bpm, longest_gap_s=gap_s, start_s=start, stop_s=stop)

    def fraction(threshold: float) -> float:
        if not np.isfinite(threshold):
            return np.nan
        return heart_rate.seconds_at_or_above(
            times, bpm, threshold, gap_s, start_s=start, stop_s=stop
        ).fraction

    within = (readings.beat_times_s > start) & (readings.beat_times_s <= stop)
    return HeartMeasures(
        mean_bpm=heart_rate.mean_bpm(times, bpm, start, stop, gap_s),
        peak_bpm=heart_rate.peak_bpm(times, bpm, start, stop, gap_s),
        coverage=min(1.0, float(part.seconds.sum()) / (stop - start)) if stop > start else np.nan,
        vigorous_fraction=fraction(choices.vigorous_fraction * maximum),
        vigorous_fraction_reserve=fraction(
            heart_rate.at_reserve(heart_rate.VIGOROUS_RESERVE, resting_bpm=resting, maximum_bpm=maximum)
        ),
        resting_bpm=resting,
        recovery_bpm=_recovery_bpm(record, step, readings, gap_s),
        corrected_share=float(readings.beats.is_corrected[within].mean()) if within.any() else np.nan,
    )


def _window(record: SessionRecord, step: StepRecord, choices: Choices) -> tuple[float, float]:
    start, stop = step.start_s, step.stop_s
    if choices.window == "perform+30":
        stop += 30.0
    elif choices.window == "watch+perform":
        earlier = [
            one.start_s
            for one in record.steps
            if one.phase == "watch" and one.period == step.period and one.start_s < step.start_s
        ]
        start = earlier[-1] if earlier else start
    return start, stop


def _maximum_bpm(record: SessionRecord, choices: Choices) -> float:
    told = record.answers_to("demographics") or {}
    if choices.maximum == "measured":
        return float(told.get("maximum_heart_rate_bpm") or np.nan)
    age = told.get("age")
    return np.nan if age is None else heart_rate.maximum(age, choices.maximum)


def _resting_bpm(record: SessionRecord, readings: Readings, longest_gap_s: float) -> float:
    baseline = [step for step in record.steps if step.phase == "baseline" and step.is_complete]
    if not baseline:
        return np.nan
    start, stop = baseline[-1].start_s, baseline[-1].stop_s
    return heart_rate.resting_bpm(readings.times_s, readings.bpm, start, stop, longest_gap_s)


def _recovery_bpm(record: SessionRecord, step: StepRecord, readings: Readings, longest_gap_s: float) -> float:
    """Give the recovery, unless another effort began within the minute."""
    over_s = step.stop_s + heart_rate.RECOVERY_S
    if any(one.phase in _EFFORTS and step.stop_s <= one.start_s < over_s for one in record.steps):
        return np.nan
    return heart_rate.recovery_bpm(readings.times_s, readings.bpm, step.stop_s, longest_gap_s)
