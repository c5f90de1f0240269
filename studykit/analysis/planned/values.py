"""Which values enter a declared comparison, and what is left out and why."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from studykit.analysis import tables
from studykit.analysis.results import Exclusions
from studykit.core.arrays import Floats
from studykit.core.errors import InputError

if TYPE_CHECKING:
    import pandas as pd


def refuse_repeats(valid: pd.DataFrame) -> None:
    """Refuse two valid trials of one condition by one person.

    Raises
    ------
    InputError
        Naming the first such person.
    """
    twice = valid[valid.duplicated(["participant", "condition"])]
    if len(twice):
        first = twice.iloc[0]
        raise InputError(
            f"participant {first['participant']} has two valid trials of {first['condition']}",
            where=tables.TRIALS.name,
            remedy="mark one of them as not valid, with a reason",
        )


def values_of(trials: pd.DataFrame, conditions: Sequence[str], values: pd.Series[float]) -> pd.DataFrame:
    """Give the valid, finite values as a table of people and conditions; NaN where there is none."""
    usable = trials.assign(value=values)[trials["is_valid"] & trials["condition"].isin(conditions)]
    table = usable.pivot(index="participant", columns="condition", values="value")
    people = sorted(trials["participant"].unique())
    return table.reindex(index=people, columns=list(conditions)).astype("float64")


def exclusions_of(
    trials: pd.DataFrame, conditions: Sequence[str], values: pd.DataFrame, kept: pd.DataFrame
) -> Exclusions:
    """Count what a comparison does not use, by reason, and name the people left out.

    Parameters
    ----------
    trials : DataFrame
        All trials.
    conditions : sequence of str
        Those compared.
    values, kept : DataFrame
        Values as of `values_of`, and the part of them that is used.
    """
    of_conditions = trials[trials["condition"].isin(conditions)]
    valid = of_conditions["is_valid"]
    reasons = of_conditions.loc[~valid, "exclusion_reason"].fillna("no reason given").value_counts()
    left_out = values.drop(index=kept.index)
    return Exclusions(
        trials=len(of_conditions),
        used=int(kept.notna().to_numpy().sum()),
        not_valid={str(reason): int(count) for reason, count in sorted(reasons.items())},
        without_value=int(valid.sum() - values.notna().to_numpy().sum()),
        participants_left_out={
            str(person): [name for name in values.columns if math.isnan(row[name])]
            for person, row in left_out.iterrows()
        },
    )


def why_not_compared(values: pd.DataFrame, table: Floats) -> str | None:
    """Say why conditions cannot be compared within people, or None if they can.

    Parameters
    ----------
    values : DataFrame
        As of `values_of`.
    table : ndarray, shape (person, condition)
        The people who have all of them.
    """
    empty = [name for name in values.columns if values[name].isna().all()]
    if empty:
        return f"nobody has a value in {', '.join(empty)}"
    if len(table) < 2:
        people = "nobody has" if not len(table) else "only one participant has"
        return f"{people} a value in all conditions; at least two are needed"
    if np.all(table == table[:, :1]):
        return "every participant has the same value in all conditions"
    return None
