"""The trials of a study as they would be had one choice been made otherwise."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from studykit.analysis.heart_rate import Maximum
from studykit.analysis.tables import DANCED_AGAIN
from studykit.core.parallel import spread
from studykit.core.progress import Progress, silent
from studykit.io.protocol_file import read_protocol
from studykit.recording.session_record import SessionRecord, StepRecord
from studykit.recording.study_folder import StudyFolder
from studykit.reports import readable
from studykit.reports.choices import Choices, Window
from studykit.reports.heart_measures import Readings, heart_measures
from studykit.reports.measured import columns_of_alignment, columns_of_heart
from studykit.reports.movement_measures import aligned, side_by_side
from studykit.reports.place import AnyStudy, folder_of

if TYPE_CHECKING:
    import pandas as pd

LEAST_COVERAGE = 0.9
"""Share of a trial that must have been seen, where only well-seen trials are to count."""

_WINDOWS: dict[Window, str] = {
    "perform": "heart rate while dancing",
    "perform+30": "heart rate until 30 s after the dance",
    "watch+perform": "heart rate from watching the dance on",
}
_MAXIMA: dict[Maximum, str] = {
    "tanaka": "highest heart rate 208 - 0.7 age",
    "fox": "highest heart rate 220 - age",
}

_KEY = ("participant", "session", "condition", "repetition")
_Key = tuple[str, str, str, int]
_Values = dict[_Key, dict[str, float]]


def heart_choices(declared: Choices) -> dict[str, Choices]:
    """Give the other defensible ways of measuring the heart, by what they are in words."""
    others = {words: replace(declared, window=name) for name, words in _WINDOWS.items()}
    others |= {words: replace(declared, maximum=name) for name, words in _MAXIMA.items()}
    others["heart rate from corrected beats"] = replace(declared, heart_source="beats")
    return {words: choices for words, choices in others.items() if choices != declared}


def movement_choices(declared: Choices) -> dict[str, Choices]:
    """Give the other defensible distances from the guide, by what they are in words."""
    band_s = declared.band_s or 1.0
    return {
        f"early or late by up to {0.5 * band_s:g} s": replace(declared, band_s=0.5 * band_s),
        f"early or late by up to {2.0 * band_s:g} s": replace(declared, band_s=2.0 * band_s),
        "distance as tslearn defines it": replace(declared, definition="tslearn"),
    }


def alternatives(
    study: AnyStudy,
    table: pd.DataFrame,
    *,
    workers: int | None = None,
    progress: Progress = silent,
) -> dict[str, pd.DataFrame]:
    """Give the trials of a study under each other defensible choice.

    Parameters
    ----------
    study : Study, StudyFolder, Path or str
        Where it was recorded.
    table : DataFrame
        Its trials as declared.
    workers : int, optional
        Processes that measure; if not given, what joblib's `parallel_config` says. The result is the same.
    progress : Progress
        Told of each visit.

    Returns
    -------
    dict of str to DataFrame
        By the choice, in words: other windows and sources of the heart rate, other formulas of its maximum,
        other distances from the guide, other trials counted.
    """
    folder = folder_of(study)
    declared = Choices.of(read_protocol(folder.protocol))
    records = readable.visits(folder).records
    stamp = readable.stamp(folder)
    jobs = ((record, folder, stamp, declared) for record in records)
    measured: dict[str, _Values] = {}
    for found in progress(
        spread(_of_visit, jobs, workers=workers), label="Measuring otherwise", total=len(records)
    ):
        for words, values in found.items():
            measured.setdefault(words, {}).update(values)
    return {words: _replaced(table, values) for words, values in measured.items()} | _counted_otherwise(table)


def _of_visit(
    record: SessionRecord, folder: StudyFolder, stamp: str, declared: Choices
) -> dict[str, _Values]:
    """Measure the trials of one visit with every other choice, by where they stand in the table."""
    dances = readable.dances(folder, as_of=stamp)
    hearts = {words: (one, Readings.of(record, one)) for words, one in heart_choices(declared).items()}
    found: dict[str, _Values] = {}
    for step, key in _trials(record):
        for words, (choices, readings) in hearts.items():
            heart = heart_measures(record, step, choices, readings=readings)
            found.setdefault(words, {})[key] = columns_of_heart(heart)
        dance, tracks = dances.shown_to(record, step.condition), readable.tracks(record, step)
        both = (
            None if dance is None or tracks is None else side_by_side(tracks, step.start_s, dance, declared)
        )
        if both is not None:
            for words, choices in movement_choices(declared).items():
                found.setdefault(words, {})[key] = columns_of_alignment(aligned(both, choices))
    return found


def _trials(record: SessionRecord) -> Iterator[tuple[StepRecord, _Key]]:
    """Give the steps in which something was danced to its end, each with its place in the table."""
    begun: Counter[str] = Counter()
    for step in record.steps:
        if step.phase != "perform":
            continue
        condition = str(step.condition)
        begun[condition] += 1
        if step.is_complete:
            yield step, (record.participant, record.session, condition, begun[condition])


def _replaced(table: pd.DataFrame, values: _Values) -> pd.DataFrame:
    """Put other values into the rows that have some."""
    keys = list(zip(*(table[name] for name in _KEY), strict=True))
    names = list(next(iter(values.values())))
    rows = [
        [values[key][name] for name in names] if key in values else table[names].iloc[place].tolist()
        for place, key in enumerate(keys)
    ]
    return table.assign(**dict(zip(names, zip(*rows, strict=True), strict=True)))


def _counted_otherwise(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Give the same values with other trials counted."""
    seen = table[["heart_rate_coverage", "skeleton_coverage"]].min(axis=1) >= LEAST_COVERAGE
    valid = table[table["is_valid"]]
    danced = valid.groupby("participant")["condition"].nunique()
    whole = table["participant"].map(danced) == table["condition"].nunique()
    again = table["is_valid"] | (table["exclusion_reason"] == DANCED_AGAIN)
    first = again & ~table[again].duplicated(["participant", "condition"]).reindex(
        table.index, fill_value=True
    )
    return {
        f"only trials seen for {LEAST_COVERAGE:.0%} of their time": _valid_where(
            table, table["is_valid"] & seen
        ),
        "only people who danced every condition": _valid_where(table, table["is_valid"] & whole),
        "the first of several repetitions": _valid_where(table, first),
    }


def _valid_where(table: pd.DataFrame, counts: pd.Series[bool]) -> pd.DataFrame:
    reason = table["exclusion_reason"].where(table["exclusion_reason"].notna(), "left out on trial")
    return table.assign(is_valid=counts, exclusion_reason=reason.where(~counts, None))
