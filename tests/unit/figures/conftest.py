"""A small made-up study for drawing: numbers only, nobody's data."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest

from studykit.choreography.dance import Animation, Dance, DanceBlock, DanceMeasures, DanceSegment, measured
from studykit.choreography.rjmcmc.trace import TraceRow
from studykit.figures import DanceStrip
from studykit.motion import rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY
from studykit.protocol.condition import ALL_CONDITIONS


@pytest.fixture(scope="session")
def made_trials() -> Callable[..., pd.DataFrame]:
    """Make up a table of trials in which outcomes follow the conditions."""

    def make(*, participants: int = 6, simulated: bool = True) -> pd.DataFrame:
        rng = np.random.default_rng(3)
        rows = []
        for person in range(participants):
            level = rng.normal(0.0, 8.0)
            for condition in ALL_CONDITIONS:
                intensity, variety, transition = condition.split("-")
                intense, hard = intensity == "intense", variety == "hard"
                rating = np.clip(round(4.2 + 1.2 * (transition == "on") + rng.normal(0, 1.2)), 1, 7)
                rows.append(
                    {
                        "participant": f"{person + 1:02d}",
                        "condition": condition,
                        "transition": transition,
                        "is_valid": True,
                        "heart_rate_mean_bpm": 105.0 + 28.0 * intense + level + rng.normal(0, 3),
                        "dtw_m": 0.16 + 0.06 * hard + level / 1000.0 + rng.normal(0, 0.01),
                        "smoothness_rating": float(rating),
                        "linear_energy_asked": 2.1 if intense else 0.8,
                        "rotational_energy_asked": 1.4 if intense else 0.5,
                        "variety_achieved": 0.93 if hard else 0.55,
                        "simulated": simulated,
                    }
                )
        return pd.DataFrame(rows)

    return make


@pytest.fixture(scope="session")
def made_dances() -> Callable[..., pd.DataFrame]:
    """Make up a table of dances that nearly meet their goals."""

    def make(*, is_synthetic: bool = True) -> pd.DataFrame:
        rows = []
        for number, condition in enumerate(ALL_CONDITIONS):
            intense, hard = condition.startswith("intense"), "-hard-" in condition
            row: dict[str, object] = {"condition": condition, "is_synthetic": is_synthetic}
            for goal, asked in (
                ("linear_energy", 2.1 if intense else 0.8),
                ("rotational_energy", 1.4 if intense else 0.5),
                ("variety", 0.94 if hard else 0.55),
            ):
                achieved = asked * (1.0 + 0.01 * number)
                row |= {
                    f"{goal}_asked": asked,
                    f"{goal}_achieved": achieved,
                    f"{goal}_shown": 1.02 * achieved,
                }
            rows.append(row)
        return pd.DataFrame(rows)

    return make


@pytest.fixture(scope="session")
def made_strip() -> Callable[..., DanceStrip]:
    """Make up a dance of 8 s in which only the left elbow works, and those who danced it."""

    def make(
        condition: str = "light-easy-on", *, amplitude: float = 0.5, participants: int = 5
    ) -> DanceStrip:
        vectors = np.zeros((240, 24, 3))
        vectors[:, NEUTRAL_BODY.index("left_elbow"), 1] = amplitude * np.sin(np.arange(240) / 5.0)
        motion = Motion(
            skeleton=NEUTRAL_BODY,
            rotations=rotation.exp(vectors),
            root_positions=np.tile([3.0, 1.0, -2.0], (240, 1)),
            frame_rate_hz=30.0,
        )
        times_s = np.arange(0.25, 8.0, 0.5)
        levels = np.arange(participants)[:, None]
        return DanceStrip(
            condition=condition,
            motion=motion,
            times_s=times_s,
            heart_rate_bpm=80.0 + levels + times_s,
            distance_m=0.2 + 0.01 * levels + 0.0 * times_s,
        )

    return make


@pytest.fixture(scope="session")
def made_dance() -> Callable[..., Dance]:
    """Make up a dance of letters, one a segment: the elbows turn, each letter at a rate of its own.

    A small letter is the mirror image of its capital. The left elbow turns three times as far as the right.
    """

    def make(letters: str = "ABAb", *, blocks: int = 1, **changes: Any) -> Dance:
        motion = _danced(letters)
        (shown,) = measured(motion, (80.0,), (len(letters),))
        varieties = tuple(80.0 + 5.0 * block for block in range(blocks))
        parts = measured(motion, varieties, (len(letters) // blocks,) * blocks)
        values: dict[str, Any] = {
            "condition": "light-easy-on",
            "seed": 0,
            "preset": "studykit",
            "targets_from": "percentiles",
            "segments": tuple(
                DanceSegment(
                    id=ord(letter), take="made up", start_s=float(ord(letter.upper())),
                    mirrored=letter.islower(), licence="",
                )
                for letter in letters
            ),
            "motion": motion,
            "asked": _scaled(shown, 0.8, 1.25, 1.0 / 1.02),
            "achieved": _scaled(shown, 0.9, 1.1, 1.0),
            "achieved_blended": shown,
            "cost_total": 0.2,
            "cost_terms": {"linear": 0.1, "variety": 0.05},
            "displacements_m": tuple(0.1 + 0.01 * join for join in range(len(letters) - 1)),
            "trace": tuple(
                TraceRow(
                    iteration=100 * (row + 1), temperature=0.3 * 0.8**row, width=max(1.0, 5.0 - row),
                    cost=1.0 / (row + 1.0), best_cost=0.9 / (row + 1.0), segments=8 + row % 2, accepted=0.5,
                    inserted=None if row < 2 else 0.1, replaced=0.6,
                    terms={"linear": 0.5 / (row + 1.0), "variety": 0.25 / (row + 1.0), "unwanted": 9.0},
                )
                for row in range(6)
            ),
            "library_sha256": "",
            "is_synthetic": True,
            "weights": {"linear": 1.0, "variety": 2.0, "unwanted": 0.0},
            "blocks": tuple(
                DanceBlock(
                    asked=_scaled(part, 0.8, 1.25, 1.0 / 1.02),
                    achieved=_scaled(part, 0.9, 1.1, 1.0),
                    achieved_blended=part,
                )
                for part in parts
            ),
            "mask": None,
            "chain_costs": (0.2, 0.3, 0.25),
            "animation": Animation(blend="offset", is_cleaned=True),
            "is_interrupted": False,
        }  # fmt: skip
        return Dance(**(values | changes))

    return make


def _danced(letters: str) -> Motion:
    vectors = np.zeros((120 * len(letters), 24, 3))
    times_s = np.arange(120) / 30.0
    for number, letter in enumerate(letters):
        turn = 0.3 * np.sin(2.0 * np.pi * times_s * (1 + ord(letter.upper()) - ord("A")) / 4.0)
        left, right = (1.0, 3.0) if letter.islower() else (3.0, 1.0)
        frames = slice(120 * number, 120 * (number + 1))
        vectors[frames, NEUTRAL_BODY.index("left_elbow"), 1] = left * turn
        vectors[frames, NEUTRAL_BODY.index("right_elbow"), 1] = -right * turn
    return Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.exp(vectors),
        root_positions=np.tile([3.0, 1.0, -2.0], (len(vectors), 1)),
        frame_rate_hz=30.0,
    )


def _scaled(measures: DanceMeasures, linear: float, rotational: float, variety: float) -> DanceMeasures:
    return DanceMeasures(
        duration_s=measures.duration_s,
        linear_energy=linear * measures.linear_energy,
        rotational_energy=rotational * measures.rotational_energy,
        variety=variety * measures.variety,
    )
