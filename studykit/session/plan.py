"""The plan of a visit: which steps follow each other and how long they last."""

from __future__ import annotations

from dataclasses import dataclass

from studykit.protocol.latin_square import Sequence
from studykit.protocol.study_protocol import StudyProtocol

PHASES = ("calibrate", "baseline", "train", "watch", "perform", "smoothness", "rest", "paces", "demographics")
"""The kinds of steps, in the order of their first appearance."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PlannedStep:
    """One step of a visit, before it happens.

    Parameters
    ----------
    phase : str
        One of `PHASES`.
    condition : str or None
        The condition, where the phase belongs to one.
    period : int or None
        Which condition of the visit it is, from 1.
    duration_s : float or None
        How long it lasts, s; None for a questionnaire, which lasts until it is filled in.
    """

    phase: str
    condition: str | None = None
    period: int | None = None
    duration_s: float | None = None


def plan(protocol: StudyProtocol, sequence: Sequence) -> tuple[PlannedStep, ...]:
    """Lay out the visit of one participant.

    Parameters
    ----------
    protocol : StudyProtocol
        Gives the length of each phase and how often a dance is watched and danced.
    sequence : Sequence
        The order in which this participant gets the conditions.

    Returns
    -------
    tuple of PlannedStep
        Calibration, baseline and training; for each condition watching, dancing, its question and a rest;
        at the end enjoyment and demographics.
    """
    times = protocol.session
    steps = [
        PlannedStep(phase="calibrate", duration_s=times.calibrate_s),
        PlannedStep(phase="baseline", duration_s=times.baseline_s),
        PlannedStep(phase="train", duration_s=times.train_s),
    ]
    for period, condition in enumerate(sequence.conditions, start=1):
        phases: list[tuple[str, float | None]] = [
            *[("watch", protocol.dance.duration_s)] * times.watch_repetitions,
            *[("perform", protocol.dance.duration_s)] * times.perform_repetitions,
            ("smoothness", None),
            ("rest", times.rest_s),
        ]
        steps += [
            PlannedStep(phase=phase, condition=condition, period=period, duration_s=duration_s)
            for phase, duration_s in phases
        ]
    return (*steps, PlannedStep(phase="paces"), PlannedStep(phase="demographics"))
