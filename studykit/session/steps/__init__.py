"""The kinds of steps, one module each, and which phase is made of which."""

from __future__ import annotations

from collections.abc import Mapping

from studykit.session.plan import PlannedStep
from studykit.session.step import ShownDance, Step
from studykit.session.steps.dance import Perform, Watch
from studykit.session.steps.question import Question
from studykit.session.steps.quiet import Quiet


def build(planned: PlannedStep, dances: Mapping[str, ShownDance]) -> Step:
    """Make the step that a plan asks for.

    Parameters
    ----------
    planned : PlannedStep
        One step of the plan.
    dances : mapping of str to ShownDance
        The dance of each condition.
    """
    match planned.phase:
        case "watch":
            return Watch(planned)
        case "perform":
            return Perform(planned, dances[planned.condition or ""])
        case "smoothness" | "paces" | "demographics":
            return Question(planned)
        case _:
            return Quiet(planned)
