"""A small made-up study, for drawing: numbers only, nobody's data."""

from __future__ import annotations

import numpy as np
import pandas as pd

from studykit.figures import DanceStrip
from studykit.motion import rotation
from studykit.motion.kinematics import joint_positions
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY

CONDITIONS = tuple(
    f"{intensity}-{variety}-{transition}"
    for intensity in ("light", "intense")
    for variety in ("easy", "hard")
    for transition in ("on", "off")
)
ON = tuple(name for name in CONDITIONS if name.endswith("-on"))


def trials_table(*, participants: int = 20, simulated: bool = True) -> pd.DataFrame:
    rng = np.random.default_rng(3)
    rows = []
    for person in range(participants):
        level, skill = rng.normal(0.0, 8.0), rng.normal(0.0, 0.02)
        for condition in CONDITIONS:
            intensity, variety, transition = condition.split("-")
            intense, hard, on = intensity == "intense", variety == "hard", transition == "on"
            rows.append(
                {
                    "participant": f"{person + 1:02d}",
                    "condition": condition,
                    "intensity": intensity,
                    "variety": variety,
                    "transition": transition,
                    "is_valid": True,
                    "heart_rate_mean_bpm": 105.0 + 28.0 * intense + 4.0 * hard + level + rng.normal(0, 3),
                    "dtw_m": 0.16 + 0.03 * intense + 0.06 * hard + skill + rng.normal(0, 0.01),
                    "smoothness_rating": float(np.clip(round(4.2 + 1.2 * on + rng.normal(0, 1.2)), 1, 7)),
                    "linear_energy_asked": 2.1 if intense else 0.8,
                    "rotational_energy_asked": 1.4 if intense else 0.5,
                    "variety_achieved": 0.93 if hard else 0.55,
                    "simulated": simulated,
                }
            )
    return pd.DataFrame(rows)


def dances_table(*, simulated: bool = True) -> pd.DataFrame:
    rng = np.random.default_rng(4)
    rows = []
    for condition in CONDITIONS:
        intense, hard = condition.startswith("intense"), "-hard-" in condition
        asked = (2.1 if intense else 0.8, 1.4 if intense else 0.5, 0.94 if hard else 0.55)
        row: dict[str, object] = {"condition": condition, "simulated": simulated}
        for goal, value in zip(("linear_energy", "rotational_energy", "variety"), asked, strict=True):
            row |= {f"{goal}_asked": value, f"{goal}_achieved": value * (1.0 + rng.normal(0, 0.03))}
        rows.append(row)
    return pd.DataFrame(rows)


def poses(condition: str, *, count: int = 8) -> np.ndarray:
    """Give a swaying body with swinging arms, larger when the condition is intense."""
    size = 1.1 if condition.startswith("intense") else 0.5
    time = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    vectors = np.zeros((count, 24, 3))
    for name, axis, amount in (
        ("left_shoulder", 2, 1.2), ("right_shoulder", 2, -1.0), ("left_hip", 0, -0.7), ("right_hip", 0, 0.7),
        ("left_knee", 0, 0.6), ("right_knee", 0, 0.6), ("spine1", 1, 0.3), ("left_elbow", 1, -1.2),
    ):  # fmt: skip
        vectors[:, NEUTRAL_BODY.index(name), axis] = size * amount * np.sin(time + axis)
    motion = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.exp(vectors),
        root_positions=np.zeros((count, 3)),
        frame_rate_hz=30.0,
    )
    positions = joint_positions(motion)
    positions[..., 1] -= positions[..., 1].min(axis=1, keepdims=True)
    return np.asarray(positions)


def strip(condition: str, *, participants: int = 12) -> DanceStrip:
    rng = np.random.default_rng(5)
    times = np.arange(0.0, 32.25, 0.5)
    intense, hard = condition.startswith("intense"), "-hard-" in condition
    rise = (45.0 if intense else 15.0) * (1.0 - np.exp(-times / 20.0))
    level = 88.0 + rng.normal(0.0, 8.0, (participants, 1))
    wave = 0.16 + 0.06 * hard + 0.03 * np.sin(times) + rng.normal(0.0, 0.03, (participants, 1))
    intensity = np.abs(rng.normal(0.0, 1.0, (8, 24))) ** 2 * (1.0 if intense else 0.25)
    return DanceStrip(
        condition=condition,
        duration_s=32.0,
        poses=poses(condition),
        pose_times_s=np.arange(2.0, 32.0, 4.0),
        intensity=intensity,
        times_s=times,
        heart_rate_bpm=level + rise,
        distance_m=np.abs(wave + rng.normal(0.0, 0.01, (participants, len(times)))),
    )
