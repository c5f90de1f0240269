"""Make every comparison that the protocol declares, and say what was left out and why."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from studykit.analysis import tables
from studykit.analysis.planned.comparison import compare
from studykit.analysis.planned.course import Course, follow
from studykit.analysis.planned.equality import equal
from studykit.analysis.planned.model import model, order
from studykit.analysis.planned.relation import correlate
from studykit.analysis.planned.values import refuse_repeats
from studykit.analysis.results import Results
from studykit.core.errors import InputError
from studykit.protocol.analysis_plan import AnalysisPlan, Curve

if TYPE_CHECKING:
    import pandas as pd

_NEEDED = ("participant", "session", "condition", "is_valid", "exclusion_reason", "simulated")


Courses = Mapping[Curve, Mapping[str, Course]]
"""What was measured over time: by the kind of curve, then by condition."""


def run(plan: AnalysisPlan, trials: pd.DataFrame, *, courses: Courses | None = None) -> Results:
    """Make every comparison that was declared before the study.

    Only valid trials count. A test compares the people who have a value in all of its conditions; a
    correlation uses the people with at least two.

    Parameters
    ----------
    plan : AnalysisPlan
        The tests declared.
    trials : pandas.DataFrame
        One row a trial, columns as in `tables.TRIALS` (those that the plan needs).
    courses : mapping, optional
        What was measured over time, which declared curves need.

    Returns
    -------
    Results
        A test that cannot be made says why instead of giving numbers.

    Raises
    ------
    InputError
        If there are no trials, a column is missing or wrong, or somebody has two valid trials of a condition.
    """
    if not len(trials):
        raise InputError("there are no trials", where=tables.TRIALS.name, remedy="run a session first")
    tables.check(trials, tables.TRIALS, columns=dict.fromkeys((*_NEEDED, *plan.outcomes)))
    valid = trials[trials["is_valid"]]
    refuse_repeats(valid)
    return Results(
        alpha=plan.alpha,
        participants=int(trials["participant"].nunique()),
        trials=len(trials),
        valid_trials=len(valid),
        is_simulated=bool(trials["simulated"].any()),
        tests=tuple(compare(test, trials, plan.alpha) for test in plan.tests),
        correlations=tuple(correlate(declared, trials, plan.alpha) for declared in plan.correlations),
        models=tuple(model(declared, valid, plan.alpha) for declared in plan.models or ()),
        equivalences=tuple(equal(declared, trials, plan.alpha) for declared in plan.equivalences or ()),
        curves=tuple(
            follow(declared, (courses or {}).get(declared.curve, {})) for declared in plan.curves or ()
        ),
        order_effects=tuple(order(outcome, valid, plan.alpha) for outcome in _compared(plan)),
    )


def _compared(plan: AnalysisPlan) -> tuple[str, ...]:
    """Give the outcomes that are compared between conditions, each once."""
    tested = [test.outcome for test in plan.tests]
    return tuple(dict.fromkeys((*tested, *(one.outcome for one in plan.models or ()))))
