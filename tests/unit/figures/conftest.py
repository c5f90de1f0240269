"""A small made-up study for drawing: numbers only, nobody's data."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

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
