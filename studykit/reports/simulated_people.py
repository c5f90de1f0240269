"""What simulated people would show in a dance that nobody has danced yet: their hearts and their accuracy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from studykit.analysis.common_body import COMMON_WEIGHTS, common_space, same_front
from studykit.analysis.dynamic_time_warping import align
from studykit.choreography.dance import Dance
from studykit.core.arrays import Floats
from studykit.core.seeding import stream
from studykit.figures.time_curves import PeopleCurve
from studykit.motion.kinematics import joint_positions
from studykit.motion.motion import Motion
from studykit.participant.effects import PAPER, Effects, Response
from studykit.participant.heart_rate_kinetics import Heart
from studykit.participant.movement import LARGEST_ERROR_M, delays_s
from studykit.participant.person import Person, cohort
from studykit.protocol.analysis_plan import Curve
from studykit.reports.measured import stretches_s
from studykit.session.simulated_movement import copy, delayed, own_size

LABELS: dict[Curve, str] = {
    "heart_rate": "Heart rate\n(beats/min)",
    "distance": "Distance from\nthe guide (DTW, m)",
    "energy": "Energy danced\n(J/kg per s)",
}
"""What the axes of people's curves say."""

_BAND_S = 1.0


def heart_rates(dance: Dance, *, people: int = 12, effects: Effects = PAPER, seed: int = 0) -> PeopleCurve:
    """Let hearts follow a dance, block by block, from rest.

    Parameters
    ----------
    dance : Dance
        An effort is planted for each block: that of intense dances where the block asks for more energy than
        the mean of its lightest and its most intense block, else that of light ones. A dance of one block
        is what its condition says.
    people : int
        How many; with the ages and hearts of a published study.
    effects : Effects
        What is planted.
    seed : int
        Grows all chance.

    Returns
    -------
    PeopleCurve
        In beats a minute.
    """

    def one(person: Person, rng: np.random.Generator) -> Floats:
        chance = float(rng.normal())
        heart = Heart(person, rng)
        for name, start_s, _ in block_conditions(dance):
            heart.exert(_planted(effects.effort, name, person.exertion, chance), start_s)
        return np.array([heart.rate_bpm(time_s) for time_s in stretches_s(dance.motion.duration_s)])

    return _curve(dance, LABELS["heart_rate"], one, people=people, seed=seed)


def distances(dance: Dance, *, people: int = 12, effects: Effects = PAPER, seed: int = 0) -> PeopleCurve:
    """Let people dance along, and measure how far they are from the guide as in a study.

    Parameters
    ----------
    dance : Dance
        An error is planted for each block, as in `heart_rates`.
    people, effects, seed
        See `heart_rates`.

    Returns
    -------
    PeopleCurve
        In m: dynamic time warping in the space of the comparison, means over half a second.
    """
    rate = dance.motion.frame_rate_hz
    names = dance.motion.skeleton.joint_names
    guide = common_space(joint_positions(dance.motion), names, frame_rate_hz=rate)
    band = round(_BAND_S * rate)
    stretches = len(stretches_s(dance.motion.duration_s))

    def one(person: Person, rng: np.random.Generator) -> Floats:
        seen = joint_positions(_danced(dance, person, effects, rng))
        danced = same_front(guide, common_space(seen, names, frame_rate_hz=rate), band)
        found = align(guide, danced, band, COMMON_WEIGHTS, frame_rate_hz=rate).distance_by_frame_m
        return np.array([part.mean() for part in np.array_split(found, stretches)])

    return _curve(dance, LABELS["distance"], one, people=people, seed=seed)


def block_conditions(dance: Dance) -> tuple[tuple[str, float, float], ...]:
    """Tell what each block of a dance is nearest to: the name of a condition, its start and its end, s."""
    if len(dance.blocks) == 1:
        return ((dance.condition, 0.0, dance.motion.duration_s),)
    asked = [block.asked for block in dance.blocks]
    lengths = np.array([one.duration_s for one in asked])
    energies = np.array([one.linear_energy + one.rotational_energy for one in asked]) / lengths
    varieties = np.array([one.variety for one in asked])
    ends = np.cumsum(lengths)
    return tuple(
        (
            f"{'intense' if intense else 'light'}-{'hard' if hard else 'easy'}-on",
            float(end - length),
            float(end),
        )
        for intense, hard, length, end in zip(
            _is_high(energies), _is_high(varieties), lengths, ends, strict=True
        )
    )


def _is_high(levels: Floats) -> list[bool]:
    """Tell which blocks lie above the middle of a range; none, where all are about the same."""
    low, high = float(levels.min()), float(levels.max())
    return [high > 1.1 * low and bool(level > (low + high) / 2.0) for level in levels]


def _planted(response: Response, condition: str, person: float, trial: float) -> float:
    return response.expected(condition) + response.person_sd * person + response.trial_sd * trial


def _curve(
    dance: Dance, label: str, one: Callable[[Person, np.random.Generator], Floats], *, people: int, seed: int
) -> PeopleCurve:
    values = [
        one(person, stream(seed, "simulated people", label, person.id)) for person in cohort(people, seed)
    ]
    return PeopleCurve(label=label, times_s=stretches_s(dance.motion.duration_s), values=np.array(values))


def _danced(dance: Dance, person: Person, effects: Effects, rng: np.random.Generator) -> Motion:
    """Dance along in one go, each block with the error that is planted for it."""
    guide = own_size(dance.motion, person)
    rate, chance = guide.frame_rate_hz, float(rng.normal())
    turned = []
    for name, start_s, end_s in block_conditions(dance):
        frames = slice(round(start_s * rate), round(end_s * rate))
        block = replace(guide, rotations=guide.rotations[frames], root_positions=guide.root_positions[frames])
        error_m = _planted(effects.movement_error, name, -person.skill, chance)
        turned.append(copy(block, min(max(error_m, 0.0), LARGEST_ERROR_M), rng).rotations)
    copied = replace(guide, rotations=np.concatenate(turned))
    return delayed(copied, delays_s(len(guide), rng, frame_rate_hz=rate))
