"""Fixtures for all tests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from studykit.io.protocol_file import read_protocol
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY
from studykit.protocol.study_protocol import StudyProtocol

SHARED = Path(__file__).resolve().parents[2] / "shared" / "data"


@pytest.fixture(scope="session")
def shared_data() -> Callable[[str], Path]:
    """Find a file or folder of the real data beside the project, or skip."""

    def find(name: str) -> Path:
        path = SHARED / name
        if not path.exists():
            pytest.skip(f"the real data {name} do not lie beside this checkout")
        return path

    return find


@pytest.fixture(scope="session")
def small_protocol() -> StudyProtocol:
    """Two participants, two conditions, dances of 4 s and phases of a second or two."""
    values = read_protocol(Path(__file__).parents[1] / "protocols" / "dance-2x2x2.toml").model_dump(
        mode="json"
    )
    values["study"] |= {"name": "small", "participants": 2}
    values["conditions"] = {"intensity": ["light", "intense"], "variety": ["easy"], "transition": ["on"]}
    values["order"] |= {"labels": ["light-easy-on", "intense-easy-on"], "extra_rows": []}
    values["dance"]["duration_s"] = 4.0
    values["session"] |= {"calibrate_s": 1.0, "baseline_s": 2.0, "train_s": 1.0, "rest_s": 2.0}
    values["analysis"] |= {"tests": [], "correlations": []}
    return StudyProtocol.model_validate(values)


@dataclass(frozen=True)
class SmallDance:
    """As much of a dance as a session needs."""

    condition: str
    motion: Motion
    sha256: str


@pytest.fixture(scope="session")
def small_dances(small_protocol: StudyProtocol) -> dict[str, SmallDance]:
    """One dance of swinging limbs for each condition of the small protocol."""
    times = np.arange(120) / 30.0
    dances = {}
    for number, condition in enumerate(small_protocol.conditions_list(), start=1):
        angles = 0.2 * number * np.sin(times[:, None] * np.linspace(2.0, 6.0, 24))
        rotations = np.zeros((120, 24, 4))
        rotations[..., 0], rotations[..., 1] = np.cos(angles / 2), np.sin(angles / 2)
        root = np.array([0.0, 0.95, 0.0]) + 0.1 * np.sin(times)[:, None]
        motion = Motion(skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=root, frame_rate_hz=30.0)
        dances[condition] = SmallDance(condition=condition, motion=motion, sha256=f"{number:064x}")
    return dances
