"""Tables of the paper that describe people: who took part, what they answered, how hard they worked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.analysis import enjoyment
from studykit.core.errors import InputError
from studykit.protocol.questionnaire import PACES, PACES_NAME
from studykit.reports.material import Material
from studykit.reports.paper_table import Cell, Heading, PaperTable
from studykit.reports.trials import paces

if TYPE_CHECKING:
    import pandas as pd

PUBLISHED_VIGOROUS = {"light-easy": 0.0, "light-hard": 0.0256, "intense-easy": 0.6617, "intense-hard": 0.7367}
"""Share of time at vigorous intensity that the paper prints (section 6.1)."""
PUBLISHED_ENJOYMENT: tuple[tuple[str, float, str, str], ...] = (
    ("Wii Fit, yoga", 67.0, "five items", "Graves et al. 2010"),
    ("Wii Fit, muscle conditioning", 74.0, "five items", "Graves et al. 2010"),
    ("Wii Fit, aerobics", 85.0, "five items", "Graves et al. 2010"),
    ("Pose-guided level design", 79.0, "not told", "Zhang et al. 2019"),
    ("Personalised dance synthesis", 85.0, "18 items", "the paper"),
)
"""Enjoyment in per cent as the paper compares it (section 6.1), with the version of the scale."""
_PUBLISHED_PEOPLE = {
    "participants": "20 (10 women, 10 men)",
    "age": "25.3 (SD 6.3), 21 to 40",
    "weight_kg": "73.5 (SD 8.9)",
    "height_m": "not told",
    "dance_experience_years": "1 above three, 2 below one, 17 none",
}


def survey_items(material: Material) -> PaperTable:
    """Give every item that was asked, with its anchors."""
    smoothness = material.protocol.questionnaires.smoothness
    rows: list[dict[str, Cell]] = [
        {
            "questionnaire": PACES_NAME,
            "item": item.number,
            "low": item.left,
            "high": item.right,
            "scored": "reversed" if item.is_reversed else "as ticked",
        }
        for item in PACES
    ]
    rows.append(
        {
            "questionnaire": f"Smoothness: “{smoothness.text}”",
            "item": 1,
            "low": "strongly disagree",
            "high": "strongly agree",
            "scored": "as ticked",
        }
    )
    return PaperTable(
        name="survey-items",
        caption="Items of the questionnaires and what their lowest and highest answers mean.",
        headings=(
            Heading(key="questionnaire", words="Questionnaire"),
            Heading(key="item", words="Item", decimals=0),
            Heading(key="low", words="Lowest"),
            Heading(key="high", words="Highest"),
            Heading(key="scored", words="Scored"),
        ),
        rows=tuple(rows),
        note="The enjoyment scale (Kendzierski and DeCarlo 1991) in words of our own; studies use the "
        "original.",
    )


def enjoyment_items(material: Material) -> PaperTable:
    """Give the mean answer to each item of the enjoyment scale."""
    people = _people(material)
    keyed = np.array([enjoyment.keyed(person) for person in people])
    rows: list[dict[str, Cell]] = []
    for place, item in enumerate(PACES):
        answers = keyed[:, place][np.isfinite(keyed[:, place])]
        rows.append(
            {
                "item": item.number,
                "unpleasant": item.right if item.is_reversed else item.left,
                "pleasant": item.left if item.is_reversed else item.right,
                "n": len(answers),
                "mean": float(answers.mean()) if len(answers) else None,
                "standard_deviation": float(answers.std(ddof=1)) if len(answers) > 1 else None,
            }
        )
    return PaperTable(
        name="enjoyment-items",
        caption=f"Answers to the enjoyment scale ({PACES_NAME}), turned so that 7 is the pleasant pole.",
        headings=(
            Heading(key="item", words="Item", decimals=0),
            Heading(key="unpleasant", words="1"),
            Heading(key="pleasant", words="7"),
            Heading(key="n", words="n", decimals=0),
            Heading(key="mean", words="Mean", decimals=2),
            Heading(key="standard_deviation", words="SD", decimals=2),
        ),
        rows=tuple(rows),
        note=_mark(material),
    )


def enjoyment_comparison(material: Material) -> PaperTable:
    """Give the enjoyment of this study beside that of the systems that the paper names."""
    scores = [score for person in _people(material) if (score := enjoyment.score(person)) is not None]
    if not scores:
        raise InputError("nobody answered enough items", where="paces", remedy="ask the enjoyment scale")
    rows: list[dict[str, Cell]] = [
        {"system": system, "percent": percent, "percent_of_range": None, "version": version, "source": source}
        for system, percent, version, source in PUBLISHED_ENJOYMENT
    ]
    rows.append(
        {
            "system": "This study",
            "percent": float(np.mean([score.percent_of_maximum for score in scores])),
            "percent_of_range": float(np.mean([score.percent_of_range for score in scores])),
            "version": scores[0].version,
            "source": f"n = {len(scores)}{', simulated' if material.is_simulated else ''}",
        }
    )
    return PaperTable(
        name="enjoyment",
        caption="Enjoyment beside that of other exergames.",
        headings=(
            Heading(key="system", words="System"),
            Heading(key="percent", words="Score (%)", decimals=1),
            Heading(key="percent_of_range", words="Of the range (%)", decimals=1),
            Heading(key="version", words="Version of the scale"),
            Heading(key="source", words="Source"),
        ),
        rows=tuple(rows),
        note="Score: per cent of the highest total; of the range: 0 is the lowest total possible. Published "
        "studies do not say which of the two they print, and versions of the scale are not comparable.",
    )


def vigorous_shares(material: Material) -> PaperTable:
    """Give the share of time at vigorous intensity of each condition, beside the paper's."""
    trials = material.trials
    valid = trials[trials["is_valid"].astype(bool) & trials["vigorous_fraction"].notna()]
    rows: list[dict[str, Cell]] = []
    for cell, published in PUBLISHED_VIGOROUS.items():
        values = valid.loc[valid["condition"] == f"{cell}-on", "vigorous_fraction"].to_numpy(float)
        rows.append(
            {
                "condition": f"{cell}-on",
                "n": len(values),
                "mean": 100.0 * float(values.mean()) if len(values) else None,
                "standard_deviation": 100.0 * float(values.std(ddof=1)) if len(values) > 1 else None,
                "paper": 100.0 * published,
            }
        )
    plan = material.protocol.heart_rate
    return PaperTable(
        name="vigorous",
        caption="Time at vigorous intensity, per cent of the window, mean over participants.",
        headings=(
            Heading(key="condition", words="Condition"),
            Heading(key="n", words="n", decimals=0),
            Heading(key="mean", words="Here (%)", decimals=2),
            Heading(key="standard_deviation", words="SD", decimals=2),
            Heading(key="paper", words="Paper (%)", decimals=2),
        ),
        rows=tuple(rows),
        note=f"Vigorous: {100.0 * plan.vigorous_fraction:g} % of the maximum for the age or more; window "
        f"“{plan.window}” here, not told in the paper. {_mark(material)}".strip(),
    )


def participants(material: Material) -> PaperTable:
    """Describe who took part, beside the participants of the paper."""
    people = {
        record.participant: answers
        for record in material.records
        if (answers := record.answers_to("demographics")) is not None
    }
    if not people:
        raise InputError(
            "nobody told about themselves", where="participants", remedy="ask the demographic questions"
        )
    sexes = [str(one.get("sex") or "not told") for one in people.values()]
    names = {"F": "women", "M": "men", "O": "other", "not told": "not told"}
    counts = ", ".join(f"{sexes.count(sex)} {names.get(sex, sex)}" for sex in names if sex in sexes)
    rows: list[dict[str, Cell]] = [
        {
            "what": "Participants",
            "here": f"{len(people)} ({counts})",
            "paper": _PUBLISHED_PEOPLE["participants"],
        }
    ]
    for key, words in (
        ("age", "Age (years)"),
        ("weight_kg", "Body mass (kg)"),
        ("height_m", "Height (m)"),
        ("dance_experience_years", "Dance experience (years)"),
    ):
        values = np.array([float(one[key]) for one in people.values() if one.get(key) is not None])
        rows.append({"what": words, "here": _described(values), "paper": _PUBLISHED_PEOPLE[key]})
    return PaperTable(
        name="participants",
        caption="Participants: mean (standard deviation), lowest to highest.",
        headings=(
            Heading(key="what", words=""),
            Heading(key="here", words="Here"),
            Heading(key="paper", words="Paper"),
        ),
        rows=tuple(rows),
        note=_mark(material),
    )


def _mark(material: Material) -> str:
    return "SIMULATED DATA: no person took part." if material.is_simulated else ""


def _people(material: Material) -> list[dict[str, float]]:
    answers: pd.DataFrame = paces(material.folder).drop(columns="participant_id")
    if answers.empty:
        raise InputError(
            "nobody has answered the enjoyment scale yet", where="paces", remedy="run a visit to its end"
        )
    return [{str(name): value for name, value in row.dropna().items()} for _, row in answers.iterrows()]


def _described(values: Any) -> str:
    if not len(values):
        return "not told"
    spread = f" (SD {values.std(ddof=1):.2g})" if len(values) > 1 else ""
    return f"{values.mean():.3g}{spread}, {values.min():g} to {values.max():g}"
