from __future__ import annotations

import json
from itertools import product

import numpy as np
import pytest
from pydantic import ValidationError

from studykit.core.seeding import stream
from studykit.participant.effects import NONE, PAPER, PLANTED, Effects, Response
from studykit.participant.movement import LARGEST_ERROR_M

CONDITIONS = ["-".join(levels) for levels in product(("light", "intense"), ("easy", "hard"), ("on", "off"))]
OUTCOMES = ("effort", "movement_error", "smoothness")


def drawn(effects: Effects, outcome: str, condition: str) -> float:
    response: Response = getattr(effects, outcome)
    return response.draw(condition, 0.7, stream(5, "trial"))


@pytest.mark.parametrize("outcome", OUTCOMES)
def test_without_effects_the_same_chance_gives_the_same_value_in_every_condition(outcome: str) -> None:
    assert len({drawn(NONE, outcome, condition) for condition in CONDITIONS}) == 1


@pytest.mark.parametrize("outcome", OUTCOMES)
def test_the_published_effects_differ_between_conditions(outcome: str) -> None:
    assert len({drawn(PAPER, outcome, condition) for condition in CONDITIONS}) > 1


def test_the_published_effects_have_the_published_directions() -> None:
    effort, error, smooth = PAPER.effort, PAPER.movement_error, PAPER.smoothness
    assert effort.expected("light-easy-on") == pytest.approx(0.3, abs=0.05)
    assert effort.expected("intense-hard-on") == pytest.approx(0.85, abs=0.05)
    assert effort.expected("intense-easy-on") - effort.expected("light-hard-on") > 0.4
    order = ["light-easy-on", "intense-easy-on", "light-hard-on", "intense-hard-on"]
    errors = [error.expected(condition) for condition in order]
    assert errors == sorted(errors)
    assert smooth.expected("light-easy-on") - smooth.expected("light-easy-off") > 0.5
    assert smooth.expected("light-easy-on") == smooth.expected("intense-hard-on")


def test_chance_is_the_same_with_and_without_effects() -> None:
    for outcome in OUTCOMES:
        with_effects, without = getattr(PAPER, outcome), getattr(NONE, outcome)
        assert (with_effects.person_sd, with_effects.trial_sd) == (without.person_sd, without.trial_sd)
        expected = np.mean([with_effects.expected(c) for c in CONDITIONS])
        assert expected == pytest.approx(without.base, rel=0.01)


def test_trials_of_one_person_vary_as_planted() -> None:
    rng = stream(1, "trials")
    values = [PAPER.effort.draw("light-easy-on", 1.0, rng) for _ in range(4000)]
    expected = PAPER.effort.expected("light-easy-on") + PAPER.effort.person_sd
    assert np.mean(values) == pytest.approx(expected, abs=0.002)
    assert np.std(values) == pytest.approx(PAPER.effort.trial_sd, rel=0.05)


@pytest.mark.parametrize("effects", list(PLANTED.values()))
def test_what_is_planted_can_be_written_down(effects: Effects) -> None:
    assert PLANTED[effects.name] is effects
    assert Effects.model_validate(json.loads(json.dumps(effects.model_dump()))) == effects


@pytest.mark.parametrize("effects", list(PLANTED.values()))
def test_planted_errors_can_be_danced_by_nearly_everybody(effects: Effects) -> None:
    error = effects.movement_error
    expected = [error.expected(condition) for condition in CONDITIONS]
    spread = 2.0 * np.hypot(error.person_sd, error.trial_sd)
    assert min(expected) - spread > 0.01
    assert max(expected) + spread < LARGEST_ERROR_M


def test_an_error_that_cannot_be_danced_is_refused() -> None:
    planted = PAPER.model_dump()
    planted["movement_error"] |= {"base": 0.06, "intense": 0.05, "hard": 0.05, "on": -0.05}
    with pytest.raises(ValidationError, match=r"0\.160 m in one condition: a dancer can be 0\.135 m off"):
        Effects.model_validate(planted)


def test_a_misspelt_or_negative_effect_is_refused() -> None:
    with pytest.raises(ValidationError, match="intens"):
        Response.model_validate({"base": 1, "intens": 2, "person_sd": 0, "trial_sd": 0})
    with pytest.raises(ValidationError, match="greater than or equal to 0"):
        Response(base=1.0, person_sd=-0.1, trial_sd=0.0)
