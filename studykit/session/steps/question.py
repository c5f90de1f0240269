"""Filling in a questionnaire."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from studykit.core.errors import InputError
from studykit.participant import ratings
from studykit.participant.demands import ANSWERING_S, DEMANDS
from studykit.protocol.questionnaire import HIGHEST, LOWEST, PACES, PACES_REVERSED
from studykit.session.plan import PlannedStep
from studykit.session.simulated_participant import SimulatedParticipant
from studykit.session.step import Answer, Reply

ITEMS: dict[str, tuple[str, ...]] = {
    "smoothness": ("rating",),
    "paces": tuple(item.name for item in PACES),
    "demographics": ("age", "sex", "height_m", "weight_kg", "dance_experience_years"),
}
"""The items of each questionnaire, in their order."""


@dataclass(frozen=True)
class Question:
    """Answer the items of one questionnaire, for as long as it takes."""

    planned: PlannedStep
    is_filmed = False

    @property
    def questionnaire(self) -> str | None:
        """The questionnaire to fill in."""
        return self.planned.phase

    def simulate(
        self, participant: SimulatedParticipant, *, start_s: float, rng: np.random.Generator
    ) -> Reply | None:
        """Answer as the planted effects say."""
        participant.exert(DEMANDS[self.planned.phase], start_s)
        person, effects = participant.person, participant.effects
        answers: dict[str, Answer] = {}
        match self.planned.phase:
            case "smoothness":
                answers["rating"] = ratings.smoothness(effects, self.planned.condition or "", person, rng)
            case "paces":
                answers.update(ratings.paces(effects, person, rng, reversed_items=PACES_REVERSED))
            case "demographics":
                answers.update({item: getattr(person, item) for item in ITEMS["demographics"]})
        return Reply(answers=answers, seconds=ANSWERING_S[self.planned.phase])


def check(questionnaire: str, answers: Mapping[str, Answer]) -> None:
    """Refuse missing, unknown or impossible answers.

    Parameters
    ----------
    questionnaire : str
        One of `ITEMS`.
    answers : mapping
        Item to answer.

    Raises
    ------
    InputError
        Naming the item.
    """
    wrong = sorted(set(ITEMS[questionnaire]) ^ set(answers))
    if wrong:
        raise InputError(
            f"the item {wrong[0]} is {'missing' if wrong[0] in ITEMS[questionnaire] else 'unknown'}",
            where=questionnaire,
            remedy=f"answer {', '.join(ITEMS[questionnaire])}",
        )
    if questionnaire == "demographics":
        _check_demographics(answers)
        return
    for item, answer in answers.items():
        if type(answer) is not int or not LOWEST <= answer <= HIGHEST:
            raise InputError(
                f"{item} is {answer!r}", where=questionnaire, remedy=f"tick {LOWEST} to {HIGHEST}"
            )


def _check_demographics(answers: Mapping[str, Answer]) -> None:
    for item, answer in answers.items():
        is_possible = (
            answer in ("F", "M", "O", "n/a")
            if item == "sex"
            else isinstance(answer, int | float) and not isinstance(answer, bool) and answer >= 0
        )
        if not is_possible:
            remedy = "write F, M, O or n/a" if item == "sex" else "write a number"
            raise InputError(f"{item} is {answer!r}", where="demographics", remedy=remedy)
