"""The tables of a study: one row a trial, one row a participant, one row a dance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.analysis.tables import PACES, TRIALS, check
from studykit.choreography.dance import Dance
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.io.protocol_file import read_protocol
from studykit.library.dance_file import read_dances
from studykit.motion.skeleton import JOINT_NAMES
from studykit.protocol.study_protocol import StudyProtocol
from studykit.reports import readable, verdicts
from studykit.reports.choices import Choices
from studykit.reports.measured import MeasuredTrial, measured
from studykit.reports.movement_measures import asked_steps
from studykit.reports.place import AnyStudy, folder_of

if TYPE_CHECKING:
    import pandas as pd


def trials(
    study: AnyStudy,
    *,
    choices: Choices | None = None,
    workers: int | None = None,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Measure every trial of a study.

    Parameters
    ----------
    study : Study, StudyFolder, Path or str
        Where it was recorded.
    choices : Choices, optional
        How it is measured; as the protocol says if not given.
    workers : int, optional
        Processes that measure; if not given, what joblib's `parallel_config` says. The result is the same.
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
    folder = folder_of(study)
    found = measured(folder, choices, workers=workers, progress=progress)
    if not found:
        raise InputError("no dance was danced yet", where=folder.path, remedy="run a visit to its end")
    return table_of(found, read_protocol(folder.protocol))


def table_of(found: Sequence[MeasuredTrial], protocol: StudyProtocol) -> pd.DataFrame:
    """Put measured trials into a table, with who was blinded and the verdict whether each counts."""
    import pandas as pd

    table = pd.DataFrame([trial.row for trial in found], columns=list(TRIALS.column_names))
    table["blinded"] = [
        protocol.study.blinded if trial.row["protocol_sha256"] == protocol.sha256 else None for trial in found
    ]
    return check(verdicts.across_visits(table.astype(TRIALS.dtypes), protocol.sha256), TRIALS)


def joint_energies(
    study: AnyStudy, *, choices: Choices | None = None, workers: int | None = None
) -> pd.DataFrame:
    """Tell how much each joint did of what was danced, and of what was asked, in every trial.

    Returns
    -------
    DataFrame
        One row a trial and joint: participant, session, condition, repetition, joint; linear and rotational
        energy danced and asked, J/kg over all poses. What was danced is without the camera's trembling, so
        that a joint that hardly moves can come out below zero.
    """
    import pandas as pd

    folder = folder_of(study)
    asked = {
        name: np.stack([steps.sum(axis=0) for steps in asked_steps(dance)], axis=1)
        for name, dance in readable.dances(folder).by_condition.items()
    }
    nothing = np.full((len(JOINT_NAMES), 2), np.nan)
    origin = ("participant", "session", "condition", "repetition")
    return pd.concat(
        [
            pd.DataFrame(
                {
                    **{name: trial.row[name] for name in origin},
                    "joint": JOINT_NAMES,
                    "linear_energy_danced": trial.joint_energies[:, 0],
                    "rotational_energy_danced": trial.joint_energies[:, 1],
                    "linear_energy_asked": asked.get(trial.row["condition"], nothing)[:, 0],
                    "rotational_energy_asked": asked.get(trial.row["condition"], nothing)[:, 1],
                }
            )
            for trial in measured(folder, choices, workers=workers)
        ],
        ignore_index=True,
    )


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
