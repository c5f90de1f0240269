"""Fixtures for all tests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from shutil import copytree

import numpy as np
import pandas as pd
import pytest

from studykit.choreography.dance import (
    Animation,
    Dance,
    DanceBlock,
    DanceMeasures,
    DanceSegment,
    measured,
)
from studykit.choreography.dance_library import Calibration, DanceLibrary
from studykit.choreography.neighbours import successors
from studykit.io.protocol_file import read_protocol
from studykit.library.dance_file import write_dances
from studykit.motion import kinematics, rotation
from studykit.motion.features import FeatureScaler
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY
from studykit.protocol.study_protocol import StudyProtocol
from studykit.session import open_study

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
    values["analysis"] |= {
        "tests": [],
        "correlations": [],
        "models": None,
        "equivalences": None,
        "curves": None,
    }
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


@pytest.fixture(scope="session")
def made_library() -> Callable[..., DanceLibrary]:
    """Make up a library of a few segments, all in memory; numbers without meaning."""

    def make(segments: int, *, seed: int = 0) -> DanceLibrary:
        rng = np.random.default_rng(seed)
        features = rng.normal(1.0, 0.3, size=(segments, 120, 97)).astype(np.float32)
        turns = rng.normal(scale=0.3, size=(segments, 1, 24, 3)) + np.cumsum(
            rng.normal(scale=0.01, size=(segments, 120, 24, 3)), axis=1
        )
        rotations = rotation.exp(turns)
        linear_energies = rng.gamma(2.0, 0.01, size=(segments, 24))
        rotational_energies = rng.gamma(2.0, 0.005, size=(segments, 24))
        first_poses, last_poses = rng.normal(scale=0.2, size=(2, segments, 24, 3))
        return DanceLibrary(
            name="made-up",
            segments=pd.DataFrame(
                {
                    "id": range(segments),
                    "take": [f"take-{n // 2}" for n in range(segments)],
                    "data_set": "made-up",
                    "performer": "nobody",
                    "genre": "none",
                    "licence": "CC0-1.0",
                    "start_s": [4.0 * (n % 2) for n in range(segments)],
                    "is_synthetic": True,
                    "mirrored": False,
                    "partners": "",
                }
            ),
            rotations=rotations,
            root_positions=np.tile([0.0, 0.9, 0.0], (segments, 120, 1)),
            features=features,
            linear_energies=linear_energies,
            rotational_energies=rotational_energies,
            first_poses=first_poses,
            last_poses=last_poses,
            peak_speeds=kinematics.angular_speeds(np.moveaxis(rotations, 1, 0), 30.0).max(axis=0),
            peak_angles=kinematics.rest_angles(rotations).max(axis=1),
            successors=successors(first_poses, last_poses),
            scaler=FeatureScaler(
                kinetic_medians=np.ones(72), means=np.full(97, 1.0), deviations=np.full(97, 0.3)
            ),
            calibration=Calibration(
                chain_linear_energies=rng.gamma(50.0, 0.08, size=200),
                chain_rotational_energies=rng.gamma(50.0, 0.04, size=200),
                chain_varieties=rng.normal(140.0, 8.0, size=200),
                chain_cosine_varieties=rng.normal(0.9, 0.05, size=200),
                join_displacements=rng.gamma(20.0, 0.01, size=700),
                window_linear_energies=[],
                window_rotational_energies=[],
                window_varieties=[],
                median_distance=150.0,
            ),
            sha256="0" * 64,
        )

    return make


def _protocol() -> StudyProtocol:
    source = Path(__file__).parents[1] / "protocols" / "dance-2x2x2.toml"
    values = read_protocol(source).model_dump(mode="json")
    values["study"] |= {"name": "small", "title": "Dances for <b>everyone</b> & all", "participants": 3}
    values["dance"]["duration_s"] = 4.0
    values["session"] |= {"calibrate_s": 1.0, "baseline_s": 2.0, "train_s": 1.0, "rest_s": 2.0}
    return StudyProtocol.model_validate(values)


def _dance(condition: str, number: int) -> Dance:
    speed = (6.0 if condition.startswith("intense") else 2.0) + 0.1 * number
    vectors = 0.3 * np.sin(np.arange(120)[:, None, None] / 30.0 * speed + np.arange(72).reshape(24, 3))
    motion = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.exp(vectors),
        root_positions=np.tile([0.0, 0.95, 0.0], (120, 1)),
        frame_rate_hz=30.0,
    )
    shown = measured(motion, (1.2 if "-hard-" in condition else 0.8,), (round(motion.duration_s / 4.0),))[0]
    asked = DanceMeasures(**{name: 0.97 * value for name, value in shown.to_dict().items()})
    return Dance(
        condition=condition,
        seed=1,
        preset="studykit",
        targets_from="percentiles",
        segments=(DanceSegment(id=number, take="made-up", start_s=0.0, mirrored=False, licence="CC0-1.0"),),
        motion=motion,
        asked=asked,
        achieved=shown,
        achieved_blended=shown,
        blocks=(DanceBlock(asked=asked, achieved=shown, achieved_blended=shown),),
        cost_total=0.5,
        cost_terms={"duration": 0.5},
        weights={"duration": 1.0},
        chain_costs=(0.5,),
        animation=Animation(blend="offset", is_cleaned=True),
        displacements_m=(0.05 if condition.endswith("-on") else 0.10,),
        trace=(),
        library_sha256="1" * 64,
        is_synthetic=True,
    )


@pytest.fixture(scope="session")
def _recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    protocol = _protocol()
    dances = {name: _dance(name, n) for n, name in enumerate(protocol.conditions_list())}
    study = open_study(tmp_path_factory.mktemp("recorded") / "small", protocol=protocol)
    write_dances(dances, study.folder.dances)
    study.simulate(dances, seed=1)
    return study.path


@pytest.fixture
def recorded_study(_recorded: Path, tmp_path: Path) -> Callable[[], Path]:
    """Give a copy of the folder of a finished study of three simulated people; each call gives another."""

    def copy() -> Path:
        count = len(list(tmp_path.iterdir()))
        return Path(copytree(_recorded, tmp_path / f"study-{count}" / "small"))

    return copy
