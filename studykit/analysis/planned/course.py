"""A declared comparison at every moment of the dance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from studykit.analysis.curves import CurveComparison, cluster_permutation, several
from studykit.analysis.results import CurveResult
from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.core.seeding import stream
from studykit.protocol.analysis_plan import CurvePlan


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Course:
    """What was measured over time in one condition.

    Parameters
    ----------
    participants : tuple of str
        Who danced it.
    times_s : ndarray, shape (time,), s
        From the start of the dance.
    values : ndarray, shape (participant, time)
        NaN where nothing was measured.
    """

    participants: tuple[str, ...]
    times_s: Floats
    values: Floats

    def of(self, people: Sequence[str]) -> Floats:
        """Give the values of some people, in their order, shape (participant, time)."""
        return self.values[[self.participants.index(person) for person in people]]


def follow(plan: CurvePlan, courses: Mapping[str, Course]) -> CurveResult:
    """Compare conditions over time, for the people who have a curve in all of them.

    Parameters
    ----------
    plan : CurvePlan
        What was declared.
    courses : mapping of str to Course
        By condition.
    """
    lacking = [name for name in plan.conditions if name not in courses or not courses[name].participants]
    if lacking:
        return CurveResult(plan=plan, not_computed_because=f"nobody has a curve in {', '.join(lacking)}")
    chosen = [courses[name] for name in plan.conditions]
    people = sorted(set.intersection(*(set(one.participants) for one in chosen)))
    times = chosen[0].times_s[: min(len(one.times_s) for one in chosen)]
    curves = {
        name: one.of(people)[:, : len(times)] for name, one in zip(plan.conditions, chosen, strict=True)
    }
    if any(not np.isfinite(values).any() for values in curves.values()):
        return CurveResult(plan=plan, not_computed_because="nothing was measured in one of the conditions")
    try:
        return CurveResult(plan=plan, found=_compared(plan, curves, times))
    except InputError as refused:
        return CurveResult(plan=plan, not_computed_because=refused.problem)


def _compared(plan: CurvePlan, curves: Mapping[str, Floats], times_s: Floats) -> CurveComparison:
    rng = stream(0, "curves", plan.name)
    if len(curves) == 2:
        a, b = curves.values()
        return cluster_permutation(a, b, times_s, rng=rng)
    return several(curves, times_s, rng=rng)
