"""A whole simulated study, small enough to be recorded in a second or two."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from shutil import copytree

import numpy as np
import pytest

from studykit.choreography.dance import (
    Animation,
    Dance,
    DanceBlock,
    DanceMeasures,
    DanceSegment,
    measured,
)
from studykit.io.protocol_file import read_protocol
from studykit.library.dance_file import write_dances
from studykit.motion import rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY
from studykit.protocol.study_protocol import StudyProtocol
from studykit.session import open_study


def _protocol() -> StudyProtocol:
    source = Path(__file__).parents[3] / "protocols" / "dance-2x2x2.toml"
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
