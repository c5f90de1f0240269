"""What was measured from moment to moment of each dance, for figures and for tests of whole curves."""

from __future__ import annotations

import numpy as np

from studykit.analysis.planned import Course
from studykit.core.arrays import Floats
from studykit.io.protocol_file import read_protocol
from studykit.protocol.analysis_plan import Curve
from studykit.reports import readable
from studykit.reports.choices import Choices
from studykit.reports.measured import measured, power, stretches_s
from studykit.reports.movement_measures import asked_steps
from studykit.reports.place import AnyStudy, folder_of
from studykit.reports.trials import table_of


def curves(
    study: AnyStudy, kind: Curve, *, choices: Choices | None = None, workers: int | None = None
) -> dict[str, Course]:
    """Give the curves of everybody, by condition.

    Parameters
    ----------
    study : Study, StudyFolder, Path or str
        Where it was recorded.
    kind : {"heart_rate", "distance", "energy"}
        Heart rate as it stood, bpm; mean joint distance from the guide, m; or what the body did, J/kg per s,
        in stretches of half a second.
    choices : Choices, optional
        How it is measured; as the protocol says if not given.
    workers : int, optional
        See `trials`.

    Returns
    -------
    dict of str to Course
        In the order of the protocol's conditions; nobody's values where nobody danced one.
    """
    folder = folder_of(study)
    protocol = read_protocol(folder.protocol)
    found = measured(folder, choices, workers=workers)
    is_valid = table_of(found, protocol)["is_valid"] if found else ()
    times_s = stretches_s(protocol.dance.duration_s)
    people: dict[str, dict[str, Floats]] = {name: {} for name in protocol.conditions_list()}
    for trial, counts in zip(found, is_valid, strict=True):
        values = trial.curves[kind]
        if counts and len(values) == len(times_s):
            people.setdefault(trial.row["condition"], {})[trial.row["participant"]] = values
    return {
        name: Course(
            participants=tuple(values),
            times_s=times_s,
            values=np.reshape(list(values.values()), (len(values), len(times_s))),
        )
        for name, values in people.items()
    }


def asked_energy(study: AnyStudy) -> dict[str, tuple[Floats, Floats]]:
    """Give the energy of each dance as shown: condition to times, s, and J/kg per s in the same stretches."""
    asked = {}
    for name, dance in readable.dances(folder_of(study)).by_condition.items():
        times_s = stretches_s(dance.motion.duration_s)
        asked[name] = (times_s, power(*asked_steps(dance), dance.motion.frame_rate_hz, len(times_s)))
    return asked
