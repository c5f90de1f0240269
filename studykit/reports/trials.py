"""The tables of a study: one row a trial, one row a participant, one row a dance."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.analysis.tables import PACES, TRIALS, check
from studykit.choreography.dance import Dance
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.core.provenance import sha256_of_value
from studykit.io.protocol_file import read_protocol
from studykit.library.dance_file import read_dances
from studykit.protocol.condition import Condition
from studykit.protocol.study_protocol import StudyProtocol
from studykit.recording.session_record import SessionRecord, StepRecord
from studykit.reports import readable, verdicts
from studykit.reports.place import AnyStudy, folder_of
from studykit.reports.trial import heart_measures, movement_measures

if TYPE_CHECKING:
    import pandas as pd


def trials(study: AnyStudy, *, progress: Progress = silent) -> pd.DataFrame:
    """Measure every trial of a study.

    Parameters
    ----------
    study : Study, StudyFolder, Path or str
        Where it was recorded.
    progress : Progress
        Told of each visit.

    Returns
    -------
    DataFrame
        One row a trial in the columns of `analysis.tables.TRIALS`. A trial that was interrupted, or danced
        again later, is there with the reason why it is not analysed. What hangs on a dance or a recording
        that cannot be read, or is not what was shown, is missing; `checks.problems` says why.

    Raises
    ------
    InputError
        If nothing was recorded, or nothing of it can be read.
    """
    import pandas as pd

    folder = folder_of(study)
    protocol = read_protocol(folder.protocol)
    shown = readable.dances(folder)
    records = readable.visits(folder).records
    rows: list[dict[str, Any]] = []
    for record in progress(records, label="Measuring visits", total=len(records)):
        rows.extend(_rows(record, shown, protocol))
    if not rows:
        raise InputError("no dance was danced yet", where=folder.path, remedy="run a visit to its end")
    table = pd.DataFrame(rows, columns=list(TRIALS.column_names)).astype(TRIALS.dtypes)
    return check(verdicts.across_visits(table, protocol.sha256), TRIALS)


def paces(study: AnyStudy) -> pd.DataFrame:
    """Give everybody's answers to the Physical Activity Enjoyment Scale, in the columns of `tables.PACES`."""
    import pandas as pd

    rows: dict[str, dict[str, Any]] = {}  # somebody who came twice is asked once
    for record in readable.visits(folder_of(study)).records:
        answers = record.answers_to("paces")
        if answers is not None:
            name = f"sub-{record.participant}"
            rows.setdefault(name, {"participant_id": name, **answers})
    return check(pd.DataFrame(rows.values(), columns=list(PACES.column_names)).astype(PACES.dtypes), PACES)


def dances(study: AnyStudy | Mapping[str, Dance]) -> pd.DataFrame:
    """Give one row a dance: what was asked for, found within its segments, and shown.

    Energies in J per kg, summed over the poses; `join_displacement_m` is the mean over the joins.
    """
    import pandas as pd

    found = study if isinstance(study, Mapping) else read_dances(folder_of(study).dances)
    rows = []
    for condition, dance in found.items():
        kinds = {"asked": dance.asked, "achieved": dance.achieved, "shown": dance.achieved_blended}
        rows.append(
            {
                "condition": condition,
                "is_synthetic": dance.is_synthetic,
                "duration_s": dance.achieved_blended.duration_s,
                **{
                    f"{measure}_{kind}": getattr(measures, measure)
                    for measure in ("linear_energy", "rotational_energy", "variety")
                    for kind, measures in kinds.items()
                },
                "distinct_segments": dance.distinct_segments,
                "segments": " ".join(str(segment.id) for segment in dance.segments),
                "join_displacement_m": float(np.mean(dance.displacements_m or [0.0])),
            }
        )
    return pd.DataFrame(rows)


def _rows(record: SessionRecord, shown: readable.Dances, protocol: StudyProtocol) -> list[dict[str, Any]]:
    performed = [step for step in record.steps if step.phase == "perform"]
    last = {
        step.condition: step.step for step in performed if step.is_complete and step.exclusion_reason is None
    }
    return [
        _row(record, step, shown.shown_to(record, step.condition), protocol, verdicts.of_step(step, last))
        for step in performed
    ]


def _row(
    record: SessionRecord,
    step: StepRecord,
    dance: Dance | None,
    protocol: StudyProtocol,
    exclusion: str | None,
) -> dict[str, Any]:
    name = str(step.condition)
    condition = Condition.parse(name)
    demographics = record.answers_to("demographics") or {}
    smoothness = record.answers_to("smoothness", condition=name) or {}
    period = int(step.period or 1)
    heart = heart_measures(record, step, protocol, age=demographics.get("age"))
    measured: dict[str, Any] = {
        "heart_rate_mean_bpm": heart.mean_bpm,
        "heart_rate_peak_bpm": heart.peak_bpm,
        "vigorous_fraction": heart.vigorous_fraction,
    }
    movement = None
    tracks = readable.tracks(record, step) if step.is_complete else None
    if tracks is not None and dance is not None:
        movement = movement_measures(tracks, step.start_s, dance, protocol)
    if movement is not None:
        measured |= {
            "dtw_m": movement.alignment.distance_m,
            "dtw_lag_s": movement.alignment.lag_s,
            "linear_energy_danced": movement.linear_energy,
            "rotational_energy_danced": movement.rotational_energy,
        }
    file = record.frame_files.get(step.step)
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
        "is_valid": exclusion is None,
        "exclusion_reason": exclusion,
        **measured,
        "linear_energy_asked": dance.achieved_blended.linear_energy if dance else np.nan,
        "rotational_energy_asked": dance.achieved_blended.rotational_energy if dance else np.nan,
        "variety_achieved": dance.achieved.variety if dance else np.nan,
        "smoothness_rating": smoothness.get("rating", np.nan),
        "simulated": record.simulated,
        "protocol_sha256": record.protocol_sha256,
        "data_sha256": sha256_of_value([record.sha256, file.sha256 if file else None]),
    }
