"""The whole study as one page: what was done, what came out, and how."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.analysis.tables import TRIALS, check
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.protocol.condition import ALL_CONDITIONS
from studykit.protocol.latin_square import assignment, balance
from studykit.protocol.study_protocol import StudyProtocol
from studykit.reports import numbers
from studykit.reports.analyse import analyse, write
from studykit.reports.draw import DRAWINGS, Drawing, Material, save
from studykit.reports.page import embedded, filled, width_mm
from studykit.reports.place import AnyStudy, folder_of
from studykit.reports.trials import dances

if TYPE_CHECKING:
    import pandas as pd

_GOALS = ("linear_energy", "rotational_energy", "variety")
_MEASURED = ("heart_rate_mean_bpm", "dtw_m", "smoothness_rating")


def report(study: AnyStudy, *, progress: Progress = silent) -> Path:
    """Analyse a study, draw its figures and write everything as one page that needs nothing else.

    Writes `report.html` into the study's `derivatives/studykit`, beside the tables and the figures. Every
    number on the page comes from those files, the protocol or the dances; the same recordings give the same
    bytes.

    Parameters
    ----------
    study : Study, StudyFolder, Path or str
        Where it was recorded.
    progress : Progress
        Told of each visit.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    InputError
        If nothing was recorded, or the page cannot be written.
    """
    folder = folder_of(study)
    analyse(folder, progress=progress)
    material = Material(folder=folder, trials=read_trials(folder.derivatives / "trials.csv"))
    results = json.loads((folder.derivatives / "results.json").read_text(encoding="utf-8"))
    page = folder.derivatives / "report.html"
    write(page, html(material, results, [drawn(drawing, material) for drawing in DRAWINGS]))
    return page


def read_trials(path: Path) -> pd.DataFrame:
    """Read a table of trials back, and check it against its schema."""
    import pandas as pd

    return check(pd.read_csv(path, dtype=TRIALS.dtypes), TRIALS)


@dataclass(frozen=True, kw_only=True, slots=True)
class Drawn:
    """A figure of the report, or why it could not be drawn."""

    drawing: Drawing
    image: str = ""
    width_mm: float = 0.0
    marks: tuple[str, ...] = ()
    problem: str = ""


def drawn(drawing: Drawing, material: Material) -> Drawn:
    """Draw a figure and save it beside the report."""
    try:
        figure = drawing.of(material)
    except InputError as error:
        return Drawn(drawing=drawing, problem=str(error))
    svg, _ = save(figure, material.folder.figures / drawing.stem)
    return Drawn(
        drawing=drawing,
        image=embedded(svg.read_bytes()),
        width_mm=width_mm(figure),
        marks=figure.marks,
    )


def html(material: Material, results: dict[str, Any], figures: list[Drawn]) -> str:
    """Fill the page with what was measured.

    Parameters
    ----------
    material : Material
        The study and its trials.
    results : dict
        The content of `results.json`.
    figures : list of Drawn
        In order.
    """
    dances_table = dances({name: material.dances[name] for name in ALL_CONDITIONS if name in material.dances})
    return filled(
        "report.html.jinja",
        protocol=material.protocol,
        results=results,
        figures=figures,
        people=_people(material),
        balance=str(balance(assignment(material.protocol))),
        phases=_phases(material.protocol),
        quality=_quality(material),
        dances=_dances(dances_table),
        is_synthetic=bool(dances_table["is_synthetic"].any()),
        joins=_joins(dances_table),
        hearts=_by_condition(material),
        outcomes={column.name: column for column in TRIALS.columns},
        decimals={test["name"]: _decimals(test) for test in results["tests"]},
        enjoyment=results["enjoyment"],
        body_mass_kg=DEFAULT_BODY_MASS_KG,
        dance_source=_dance_source(material),
    )


def _people(material: Material) -> dict[str, Any]:
    told = [answers for record in material.records if (answers := record.answers_to("demographics"))]
    ages = np.array([answers["age"] for answers in told if answers.get("age") is not None], dtype=float)
    sexes = [answers.get("sex") for answers in told]
    return {
        "planned": material.protocol.study.participants,
        "came": len({record.participant for record in material.records}),
        "completed": len({record.participant for record in material.records if record.completed}),
        "age_mean": float(ages.mean()) if len(ages) else None,
        "age_deviation": float(ages.std(ddof=1)) if len(ages) > 1 else None,
        "age_range": (int(ages.min()), int(ages.max())) if len(ages) else None,
        "sexes": {sex: sexes.count(sex) for sex in sorted({sex for sex in sexes if sex})},
        "devices": sorted({device for record in material.records for device in record.devices.values()}),
    }


def _phases(protocol: StudyProtocol) -> list[dict[str, Any]]:
    """List the phases of a visit as they come, with their lengths in s; None where people take their time."""
    session, dance_s, rounds = protocol.session, protocol.dance.duration_s, len(protocol.conditions_list())
    return [
        {"name": name, "seconds": seconds, "times": times}
        for name, seconds, times in (
            ("calibrate", session.calibrate_s, 1),
            ("baseline", session.baseline_s, 1),
            ("train", session.train_s, 1),
            ("watch", dance_s, rounds * session.watch_repetitions),
            ("perform", dance_s, rounds * session.perform_repetitions),
            ("rate the smoothness", None, rounds),
            ("rest", session.rest_s, rounds),
            ("questions about enjoyment and person", None, 1),
        )
        if times and seconds != 0.0
    ]


def _quality(material: Material) -> dict[str, Any]:
    table, protocol = material.trials, material.protocol
    is_valid = table["is_valid"].astype(bool)
    reasons = table.loc[~is_valid, "exclusion_reason"].value_counts().sort_index()
    return {
        "planned": protocol.study.participants
        * len(protocol.conditions_list())
        * protocol.session.perform_repetitions,
        "recorded": len(table),
        "valid": int(is_valid.sum()),
        "reasons": {str(reason): int(count) for reason, count in reasons.items()},
        "excluded": table[~is_valid].to_dict("records"),
        "without_value": {name: int(table.loc[is_valid, name].isna().sum()) for name in _MEASURED},
    }


def _dances(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Give each dance with its energies in J for the default body mass and how far off its goals it is."""
    rows = []
    for row in table.to_dict("records"):
        named: dict[str, Any] = {str(key): value for key, value in row.items()}
        ids = str(named["segments"]).split()
        goals = []
        for goal in _GOALS:
            factor = 1.0 if goal == "variety" else DEFAULT_BODY_MASS_KG
            values = {kind: factor * named[f"{goal}_{kind}"] for kind in ("asked", "achieved", "shown")}
            goals.append(values | {"off": values["achieved"] / values["asked"] - 1.0})
        rows.append(named | {"ids": ids, "goals": goals})
    return rows


def _joins(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Compare each dance made with transition cost with the one made without."""
    jumps = dict(zip(table["condition"], table["join_displacement_m"], strict=True))
    return [
        {"cell": cell, "on": jumps[f"{cell}-on"], "off": jumps[f"{cell}-off"]}
        for cell in dict.fromkeys(str(name).rsplit("-", maxsplit=1)[0] for name in jumps)
        if {f"{cell}-on", f"{cell}-off"} <= jumps.keys()
    ]


def _by_condition(material: Material) -> list[dict[str, Any]]:
    """Give heart rate and time at vigorous intensity over participants, condition by condition."""
    table = material.trials[material.trials["is_valid"].astype(bool)]
    rows = []
    for name in sorted(material.protocol.conditions_list(), key=ALL_CONDITIONS.index):
        some = table[table["condition"] == name]
        mean = some["heart_rate_mean_bpm"]
        rows.append(
            {
                "condition": name,
                "n": int(mean.notna().sum()),
                "mean": float(mean.mean()),
                "deviation": float(mean.std(ddof=1)),
                "peak": float(some["heart_rate_peak_bpm"].mean()),
                "vigorous": float(some["vigorous_fraction"].mean()),
            }
        )
    return rows


def _decimals(test: dict[str, Any]) -> int:
    return numbers.decimals_for(
        min((summary["standard_deviation"] for summary in test["summaries"]), default=0.0)
    )


def _dance_source(material: Material) -> dict[str, Any]:
    shown = material.dances.values()
    return {
        "presets": sorted({dance.preset for dance in shown}),
        "targets_from": sorted({dance.targets_from for dance in shown}),
        "seeds": sorted({dance.seed for dance in shown}),
        "libraries": sorted({dance.library_sha256 for dance in shown}),
        "licences": sorted({segment.licence for dance in shown for segment in dance.segments}),
    }
