"""From recordings to numbers on disk: the tables and every declared result."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.analysis import Results, enjoyment, run
from studykit.analysis.learning import learning
from studykit.analysis.results import plain
from studykit.analysis.sensitivity import sensitivity, vigorous_times, without_effect
from studykit.core import durable
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.core.provenance import sha256_of_files, sha256_of_value, versions
from studykit.io.protocol_file import read_protocol
from studykit.protocol.questionnaire import PACES, Item
from studykit.reports.alternatives import alternatives
from studykit.reports.checks import problems
from studykit.reports.curves import curves
from studykit.reports.place import AnyStudy, folder_of
from studykit.reports.trials import paces, trials

if TYPE_CHECKING:
    import pandas as pd


def analyse(study: AnyStudy, *, workers: int | None = None, progress: Progress = silent) -> Results:
    """Measure every trial of a study and make every comparison that its protocol declares.

    Writes `trials.csv` and `results.json` into the study's `derivatives/studykit`; what was recorded is only
    read. Beside what was declared stand the declared tests with every other defensible choice, and a warning
    for everything about the study that narrows what its numbers say. The same recordings give the same
    bytes.

    Parameters
    ----------
    study : Study, StudyFolder, Path or str
        Where it was recorded.
    workers : int, optional
        Processes that measure; if not given, what joblib's `parallel_config` says. The result is the same.
    progress : Progress
        Told of each visit.

    Raises
    ------
    InputError
        If nothing was recorded, or the derivatives cannot be written.
    """
    folder = folder_of(study)
    protocol = read_protocol(folder.protocol)
    table = trials(folder, workers=workers, progress=progress)
    results = results_of(folder, workers=workers)
    others = alternatives(folder, table, workers=workers, progress=progress)
    made_again = sensitivity(protocol.analysis, table, others)
    written = results.to_dict() | {
        "sensitivity": plain(made_again),
        "choices_without_effect": plain(without_effect(made_again, others)),
        "vigorous_times": plain(vigorous_times(protocol.conditions_list(), table, others)),
        "warnings": plain(problems(folder, table=table)),
        "enjoyment": enjoyment_of(paces(folder)),
        "learning": plain([found] if (found := learning(table)) is not None else []),
        "provenance": {
            "protocol_sha256": protocol.sha256,
            "data_sha256": sha256_of_value(list(table["data_sha256"])),
            "visits": _visits(table),
            "dances_sha256": sha256_of_files(sorted(folder.dances.glob("*.json"))),
            "versions": versions(),
        },
    }
    write(folder.derivatives / "trials.csv", table.to_csv(index=False, lineterminator="\n"))
    text = json.dumps(written, indent=1, ensure_ascii=False, allow_nan=False)
    write(folder.derivatives / "results.json", text + "\n")
    return results


def results_of(study: AnyStudy, *, workers: int | None = None) -> Results:
    """Make every comparison that the protocol of a study declares; nothing is written.

    Parameters
    ----------
    study : Study, StudyFolder, Path or str
        Where it was recorded. What was measured before is remembered as long as no file changes.
    workers : int, optional
        As for `analyse`.
    """
    folder = folder_of(study)
    plan = read_protocol(folder.protocol).analysis
    kinds = dict.fromkeys(declared.curve for declared in plan.curves or ())
    courses = {kind: curves(folder, kind, workers=workers) for kind in kinds}
    return run(plan, trials(folder, workers=workers), courses=courses)


def read_results(path: Path | str) -> dict[str, Any]:
    """Read results that were written before, of this version or an older one.

    Raises
    ------
    InputError
        If the file cannot be read or holds no results.
    """
    try:
        found = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(
            f"this cannot be read as results ({error})", where=path, remedy="name a results.json"
        ) from error
    if not isinstance(found, dict) or "tests" not in found:
        raise InputError("this holds no results of a study", where=path, remedy="name a results.json")
    return found


def _visits(table: pd.DataFrame) -> dict[str, str]:
    """Give the digest of what was recorded in each visit, in order."""
    visits = table.drop_duplicates(["participant", "session"])
    names = "sub-" + visits["participant"] + "_ses-" + visits["session"]
    return dict(sorted(zip(names, visits["data_sha256"], strict=True)))


def enjoyment_of(answers: pd.DataFrame) -> dict[str, Any]:
    """Score everybody's enjoyment: means over people and how well the items go together.

    Parameters
    ----------
    answers : DataFrame
        The columns of `analysis.tables.PACES`.

    Returns
    -------
    dict
        Of all 18 items; under ``five_items``, the same of the five that other studies asked.
    """
    return _enjoyment_of(answers, PACES) | {"five_items": _enjoyment_of(answers, enjoyment.FIVE_ITEMS)}


def _enjoyment_of(answers: pd.DataFrame, items: tuple[Item, ...]) -> dict[str, Any]:
    import pandas as pd

    asked = answers[[item.name for item in items]]
    people = [{str(name): value for name, value in row.dropna().items()} for _, row in asked.iterrows()]
    scores = [score for person in people if (score := enjoyment.score(person, items=items)) is not None]
    if not scores:
        return {"participants": 0}
    measures = ("total", "percent_of_maximum", "percent_of_range", "item_mean")
    values = pd.DataFrame([{measure: getattr(score, measure) for measure in measures} for score in scores])
    spread = values.std(ddof=1)
    keyed = [enjoyment.keyed(person, items=items) for person in people if len(person) == len(items)]
    return {
        "version": scores[0].version,
        "participants": len(scores),
        "left_out": len(people) - len(scores),
        "answers": sum(score.answered for score in scores),
        "mean": values.mean().to_dict(),
        "standard_deviation": spread.to_dict() if len(scores) > 1 else None,
        "cronbach_alpha": enjoyment.cronbach_alpha(np.array(keyed)) if keyed else None,
    }


def write(path: Path, content: str | bytes) -> None:
    """Write a derived file so that it is there whole or not at all.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    try:
        durable.put(path, content)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"cannot be written ({reason})", where=path, remedy="check its folder") from error
