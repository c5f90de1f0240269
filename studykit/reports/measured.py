"""Everything that is measured of the trials of a study, in one pass through its recordings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from studykit.analysis import heart_rate
from studykit.analysis.dynamic_time_warping import Alignment
from studykit.choreography.dance import Dance
from studykit.core.arrays import Floats
from studykit.core.parallel import spread
from studykit.core.progress import Progress, silent
from studykit.core.provenance import sha256_of_value
from studykit.io.protocol_file import read_protocol
from studykit.motion.skeleton import JOINT_NAMES
from studykit.protocol.analysis_plan import Curve
from studykit.protocol.condition import Condition
from studykit.recording.session_record import SessionRecord, StepRecord
from studykit.recording.study_folder import StudyFolder
from studykit.reports import readable, verdicts
from studykit.reports.choices import Choices
from studykit.reports.heart_measures import HeartMeasures, Readings, heart_measures
from studykit.reports.movement_measures import MovementMeasures, Trembling, movement_measures, trembling

CURVE_STEP_S = 0.5
"""The length of the stretches over which curves are averaged, s."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MeasuredTrial:
    """What was measured of one trial.

    Parameters
    ----------
    row : mapping
        Its values in the columns of `analysis.tables.TRIALS`; a column without a value is not there.
    curves : mapping
        Over equal stretches of the dance: ``heart_rate`` in bpm as it stood in their middles, ``distance``
        from the guide in m, ``energy`` of travelling and turning joints in J/kg per s; each of shape
        (stretch,), NaN where nothing is known.
    joint_energies : ndarray, shape (24, 2), J/kg
        Linear and rotational energy of each joint, over all poses.
    """

    row: Mapping[str, Any]
    curves: Mapping[Curve, Floats]
    joint_energies: Floats


def measured(
    folder: StudyFolder,
    choices: Choices | None = None,
    *,
    workers: int | None = None,
    progress: Progress = silent,
) -> tuple[MeasuredTrial, ...]:
    """Measure every trial of a study; asked again, it answers from memory as long as no file changed.

    Parameters
    ----------
    folder : StudyFolder
        Where it was recorded.
    choices : Choices, optional
        How it is measured; as the protocol says if not given.
    workers : int, optional
        Processes; if not given, what joblib's `parallel_config` says. The result is the same.
    progress : Progress
        Told of each visit.
    """
    choices = choices or Choices.of(read_protocol(folder.protocol))
    key = (folder.path, readable.stamp(folder), choices)
    if key not in _REMEMBERED:
        found = tuple(_measured_now(folder, choices, workers, progress))
        while len(_REMEMBERED) >= _MOST_REMEMBERED:
            _REMEMBERED.pop(next(iter(_REMEMBERED)))
        _REMEMBERED[key] = found
    return _REMEMBERED[key]


_MOST_REMEMBERED = 4
_REMEMBERED: dict[tuple[Path, str, Choices], tuple[MeasuredTrial, ...]] = {}


def _measured_now(
    folder: StudyFolder, choices: Choices, workers: int | None, progress: Progress
) -> Iterator[MeasuredTrial]:
    records = readable.visits(folder).records
    stamp = readable.stamp(folder)
    jobs = ((record, folder, stamp, choices) for record in records)
    results = spread(_trials_of, jobs, workers=workers)
    for trials in progress(results, label="Measuring visits", total=len(records)):
        yield from trials


def _trials_of(
    record: SessionRecord, folder: StudyFolder, stamp: str, choices: Choices
) -> list[MeasuredTrial]:
    return _Visit(record, readable.dances(folder, as_of=stamp), choices).trials()


class _Visit:
    """One visit on its way to its trials: what they share is worked out once."""

    def __init__(self, record: SessionRecord, shown: readable.Dances, choices: Choices) -> None:
        self.record, self.shown, self.choices = record, shown, choices
        self.readings = Readings.of(record, choices)
        self.performed = [step for step in record.steps if step.phase == "perform"]
        whole = [step for step in self.performed if step.is_complete and step.exclusion_reason is None]
        if choices.repetition == "first":
            whole.reverse()
        self.counting = {step.condition: step.step for step in whole}
        self.noise: dict[float, Trembling | None] = {}

    def trials(self) -> list[MeasuredTrial]:
        return [self._trial(step) for step in self.performed]

    def _trial(self, step: StepRecord) -> MeasuredTrial:
        dance = self.shown.shown_to(self.record, step.condition)
        heart = heart_measures(self.record, step, self.choices, readings=self.readings)
        tracks = readable.tracks(self.record, step) if step.is_complete else None
        movement = None
        if tracks is not None and dance is not None:
            noise = self._noise(dance.motion.frame_rate_hz)
            movement = movement_measures(tracks, step.start_s, dance, self.choices, noise=noise)
        row = self._origin(step) | columns_of_heart(heart) | _of_movement(movement) | _of_dance(dance)
        return MeasuredTrial(
            row=row | self._verdict(step, heart, movement),
            curves=self._curves(step, dance, movement),
            joint_energies=_joint_energies(movement),
        )

    def _noise(self, rate: float) -> Trembling | None:
        """Tell what the camera's trembling adds in this visit, from where the person stood still."""
        if rate not in self.noise:
            still = [s for s in self.record.steps if s.phase == "calibrate" and s.is_complete]
            tracks = readable.tracks(self.record, still[-1]) if still else None
            self.noise[rate] = None if tracks is None else trembling(tracks, rate)
        return self.noise[rate]

    def _origin(self, step: StepRecord) -> dict[str, Any]:
        record, name, period = self.record, str(step.condition), int(step.period or 1)
        condition = Condition.parse(name)
        file = record.frame_files.get(step.step)
        smoothness = record.answers_to("smoothness", condition=name) or {}
        earlier = [one for one in self.performed if one.condition == name and one.step <= step.step]
        return {
            "participant": record.participant,
            "session": record.session,
            "sequence": record.sequence,
            "period": period,
            "condition": name,
            "intensity": condition.intensity,
            "variety": condition.variety,
            "transition": condition.transition,
            "previous_condition": record.conditions[period - 2] if period > 1 else None,
            "smoothness_rating": smoothness.get("rating", np.nan),
            "simulated": record.simulated,
            "protocol_sha256": record.protocol_sha256,
            "data_sha256": sha256_of_value([record.sha256, file.sha256 if file else None]),
            "repetition": len(earlier),
        }

    def _verdict(
        self, step: StepRecord, heart: HeartMeasures, movement: MovementMeasures | None
    ) -> dict[str, Any]:
        reason = verdicts.of_step(step, self.counting)
        least = self.choices.least_coverage
        if reason is None and least > 0.0:
            seen = movement.coverage if movement is not None else 0.0
            if min(heart.coverage, seen) < least:
                reason = verdicts.TOO_LITTLE_SEEN
        return {"is_valid": reason is None, "exclusion_reason": reason}

    def _curves(
        self, step: StepRecord, dance: Dance | None, movement: MovementMeasures | None
    ) -> dict[Curve, Floats]:
        times_s = stretches_s(dance.motion.duration_s) if dance is not None else np.empty(0)
        heart = heart_rate.standing(
            self.readings.times_s,
            self.readings.bpm,
            step.start_s + times_s,
            self.choices.longest_gap_s,
        )
        unknown = np.full(len(times_s), np.nan)
        body = movement.body if movement is not None else None
        return {
            "heart_rate": heart,
            "distance": unknown
            if movement is None
            else _averaged(movement.alignment.distance_by_frame_m, len(times_s)),
            "energy": unknown
            if body is None or dance is None
            else power(body.linear_steps, body.rotational_steps, dance.motion.frame_rate_hz, len(times_s)),
        }


def stretches_s(duration_s: float) -> Floats:
    """Give the middles of the stretches over which curves are averaged, s."""
    return np.arange(CURVE_STEP_S / 2.0, duration_s, CURVE_STEP_S)


def power(linear: Floats, rotational: Floats, frame_rate_hz: float, stretches: int) -> Floats:
    """Give the energy of a body over time, shape (stretch,), J/kg per s, from that of its joints' steps."""
    return _averaged((linear + rotational).sum(axis=1), stretches) * frame_rate_hz


def _averaged(values: Floats, stretches: int) -> Floats:
    return np.array([part.mean() for part in np.array_split(values, stretches)])


def columns_of_heart(heart: HeartMeasures) -> dict[str, float]:
    """Give what is measured of the heart by the columns of `analysis.tables.TRIALS`."""
    return {
        "heart_rate_mean_bpm": heart.mean_bpm,
        "heart_rate_peak_bpm": heart.peak_bpm,
        "vigorous_fraction": heart.vigorous_fraction,
        "heart_rate_resting_bpm": heart.resting_bpm,
        "heart_rate_recovery_bpm": heart.recovery_bpm,
        "heart_rate_coverage": heart.coverage,
        "rr_corrected_share": heart.corrected_share,
        "vigorous_fraction_reserve": heart.vigorous_fraction_reserve,
    }


def columns_of_alignment(alignment: Alignment) -> dict[str, float]:
    """Give the distance from the guide by the columns of `analysis.tables.TRIALS`."""
    return {
        "dtw_m": alignment.distance_m,
        "dtw_lag_s": alignment.lag_s,
        "dtw_lag_sd_s": alignment.lag_sd_s,
        **{f"dtw_{limb}_m": alignment.limb_m(limb) for limb in ("arms", "legs", "trunk")},
    }


def _of_movement(movement: MovementMeasures | None) -> dict[str, Any]:
    if movement is None:
        return {"skeleton_coverage": 0.0}
    found: dict[str, Any] = {
        "skeleton_coverage": movement.coverage,
        **columns_of_alignment(movement.alignment),
    }
    if movement.body is not None:
        found |= {
            "linear_energy_danced": movement.body.linear_energy,
            "rotational_energy_danced": movement.body.rotational_energy,
            "energy_noise_share": movement.body.noise_share,
            "smoothness_ldlj": movement.body.smoothness,
            "range_of_motion_rad": movement.body.range_of_motion,
        }
    return found


def _of_dance(dance: Dance | None) -> dict[str, Any]:
    if dance is None:
        return {}
    return {
        "linear_energy_asked": dance.achieved_blended.linear_energy,
        "rotational_energy_asked": dance.achieved_blended.rotational_energy,
        "variety_achieved": dance.achieved.variety,
    }


def _joint_energies(movement: MovementMeasures | None) -> Floats:
    if movement is None or movement.body is None:
        return np.full((len(JOINT_NAMES), 2), np.nan)
    body = movement.body
    return np.stack((body.linear_steps.sum(axis=0), body.rotational_steps.sum(axis=0)), axis=1)
