"""What simulated people would show in a study, drawn in a moment: no camera, no belt, no dances."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.seeding import stream
from studykit.participant import ratings
from studykit.participant.demands import ANSWERING_S, DEMANDS
from studykit.participant.effects import Effects
from studykit.participant.movement import LARGEST_ERROR_M, LEAST_ERROR_M
from studykit.participant.person import Person, cohort
from studykit.protocol.condition import FACTORS, Condition
from studykit.protocol.latin_square import williams
from studykit.protocol.study_protocol import StudyProtocol

if TYPE_CHECKING:
    import pandas as pd

_AFTER_S = 30.0
"""How far the window "perform+30" reaches beyond the dance, s."""


def simulated_trials(
    protocol: StudyProtocol, effects: Effects, *, people: int = 200, seed: int = 1
) -> pd.DataFrame:
    """Let simulated people go through the visits of a study on paper.

    Parameters
    ----------
    protocol : StudyProtocol
        Gives conditions, orders, how long each phase lasts and in which window the heart counts.
    effects : Effects
        What is planted.
    people : int
        How many; the rows of the square are used in turn.
    seed : int
        The same seed gives the same people and the same chance.

    Returns
    -------
    DataFrame
        One row a trial, with the columns of `tables.TRIALS` that people bring: `heart_rate_mean_bpm` from the
        heart's kinetics through the whole visit, `dtw_m` as the distance planted (a camera's noise is not in
        it) and `smoothness_rating`.
    """
    import pandas as pd

    labels = protocol.order.labels
    rows = williams(len(labels))
    sequences = np.arange(people) % len(rows)
    orders = rows[sequences]
    crowd = cohort(people, seed)
    rng = stream(seed, "simulated_trials")
    shape = (people, len(labels))
    expected = {
        name: np.array([getattr(effects, name).expected(label) for label in labels])[orders]
        for name in ("effort", "movement_error")
    }
    traits = {name: np.array([[getattr(p, name)] for p in crowd]) for name in ("exertion", "skill")}
    effort = (
        expected["effort"]
        + effects.effort.person_sd * traits["exertion"]
        + effects.effort.trial_sd * rng.normal(size=shape)
    )
    error = (
        expected["movement_error"]
        - effects.movement_error.person_sd * traits["skill"]
        + effects.movement_error.trial_sd * rng.normal(size=shape)
    )
    rated = [
        [ratings.smoothness(effects, labels[condition], person, rng) for condition in order]
        for person, order in zip(crowd, orders, strict=True)
    ]
    conditions = np.array(labels)[orders]
    previous = np.hstack([np.full((people, 1), None), conditions[:, :-1]])
    width = max(2, len(str(people)))
    table = pd.DataFrame(
        {
            "participant": np.repeat([f"{n:0{width}d}" for n in range(1, people + 1)], len(labels)),
            "session": "01",
            "sequence": np.repeat(sequences + 1, len(labels)),
            "period": np.tile(np.arange(1, len(labels) + 1), people),
            "condition": conditions.ravel(),
            "previous_condition": previous.ravel(),
            "is_valid": True,
            "exclusion_reason": None,
            "heart_rate_mean_bpm": _heart_rates(protocol, crowd, effort).ravel(),
            "dtw_m": np.clip(error, LEAST_ERROR_M, LARGEST_ERROR_M).ravel(),
            "smoothness_rating": np.array(rated, dtype=np.float64).ravel(),
            "simulated": True,
        }
    )
    for factor in FACTORS:
        table[factor] = [getattr(Condition.parse(name), factor) for name in table["condition"]]
    return table.astype({"previous_condition": "str", "exclusion_reason": "str"})


def _heart_rates(protocol: StudyProtocol, crowd: Sequence[Person], effort: Floats) -> Floats:
    """Give everybody's mean heart rate in each period, shape (person, period), beats/min."""
    heart, session = _Hearts(crowd), protocol.session
    for phase, seconds in (
        ("calibrate", session.calibrate_s),
        ("baseline", session.baseline_s),
        ("train", session.train_s),
    ):
        heart.beat(DEMANDS[phase], seconds)
    reaches_on = protocol.heart_rate.window == "perform+30"
    duration_s = protocol.dance.duration_s
    means = np.empty_like(effort)
    for period in range(effort.shape[1]):
        heart.beat(DEMANDS["watch"], session.watch_repetitions * duration_s)
        for _ in range(session.perform_repetitions):  # what is danced again counts as danced last
            beats = heart.beat(effort[:, period], duration_s)
        counted_s, left_s = duration_s, _AFTER_S if reaches_on else 0.0
        for phase, seconds in (("smoothness", ANSWERING_S["smoothness"]), ("rest", session.rest_s)):
            within_s = min(left_s, seconds)
            beats = beats + heart.beat(DEMANDS[phase], within_s)
            heart.beat(DEMANDS[phase], seconds - within_s)
            counted_s, left_s = counted_s + within_s, left_s - within_s
        means[:, period] = beats / counted_s
    return means


class _Hearts:
    """The hearts of many people at once, by the kinetics of `participant.heart_rate_kinetics`."""

    def __init__(self, crowd: Sequence[Person]) -> None:
        self._rest_bpm = np.array([person.resting_heart_rate_bpm for person in crowd])
        self._reserve_bpm = np.array([person.maximum_heart_rate_bpm for person in crowd]) - self._rest_bpm
        self._rise_s = np.array([person.rise_s for person in crowd])
        self._fall_s = np.array([person.fall_s for person in crowd])
        self._rate_bpm = self._rest_bpm.copy()

    def beat(self, demand: Floats | float, seconds: float) -> Floats:
        """Go on for a while under an effort; give the heart rate summed over that time, beats/min x s."""
        steady = self._rest_bpm + np.clip(demand, 0.0, 1.0) * self._reserve_bpm
        constant_s = np.where(steady > self._rate_bpm, self._rise_s, self._fall_s)
        kept = np.exp(-seconds / constant_s)
        summed = steady * seconds + (self._rate_bpm - steady) * constant_s * (1.0 - kept)
        self._rate_bpm = steady + (self._rate_bpm - steady) * kept
        return np.asarray(summed)
