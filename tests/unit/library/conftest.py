"""A folder of three small takes, and the library built from it."""

from __future__ import annotations

import lzma
from pathlib import Path

import numpy as np
import pytest

from studykit.choreography.dance_library import DanceLibrary
from studykit.io.bvh import bvh_text
from studykit.io.datasets.read import find_recipe
from studykit.library.build import build
from studykit.library.measure import Settings
from studykit.motion import rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY

RECIPE = """
data_set = "three-takes"
licence = "CC0-1.0"
skeleton = "smpl"
units_m = 0.01
skip_frames = 4

[[takes]]
match = "waltz/*.bvh"
genre = "waltz"
performer = "Ada"
frame_rate_hz = 60.0  # the files say 120

[[takes]]
match = "*.bvh"
genre = "tango"
performer = "Ben"
"""


def a_take(seed: int, *, frames: int, rate: float) -> Motion:
    """Give a smooth movement that walks across a floor at 0.3 m."""
    rng = np.random.default_rng(seed)
    times = np.arange(frames)[:, None, None] / 60.0
    turns = rng.normal(scale=0.3, size=(1, 24, 3)) + rng.normal(scale=0.25, size=(1, 24, 3)) * np.sin(
        rng.uniform(1.0, 4.0, size=(1, 24, 3)) * times
    )
    turns[:, [0, 3, 6, 9]] *= 0.2  # upright
    turns[:, [4, 5]] = np.abs(turns[:, [4, 5]]) * np.array([1.0, 0.0, 0.0])  # knees bend one way only
    return Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.exp(turns),
        root_positions=[2.0, 1.5, -1.0] + times[:, 0] * np.array([0.3, 0.0, 0.1]),
        frame_rate_hz=rate,
    )


@pytest.fixture(scope="session")
def takes_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("takes")
    (folder / "waltz").mkdir()
    (folder / "library.toml").write_text(RECIPE)
    (folder / "readme.txt").write_text("no take")
    texts = {
        "waltz/01.bvh": bvh_text(a_take(1, frames=4 + 960, rate=120.0)),
        "waltz/02.bvh.xz": bvh_text(a_take(2, frames=4 + 750, rate=120.0)),
        "tango.bvh": bvh_text(a_take(3, frames=4 + 800, rate=59.94)),
    }
    # One frame of the first take glitches, 4.5 s after its start: a knee is turned round.
    rows = texts["waltz/01.bvh"].splitlines()
    first = rows.index("MOTION") + 3
    broken = rows[first + 4 + 270].split()
    broken[9:12] = ["-150", "80", "0"]
    rows[first + 4 + 270] = " ".join(broken)
    texts["waltz/01.bvh"] = "\n".join(rows)
    for name, text in texts.items():
        data = text.encode()
        (folder / name).write_bytes(lzma.compress(data, preset=0) if name.endswith(".xz") else data)
    return folder


@pytest.fixture(scope="session")
def built_folder(takes_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("libraries") / "three-takes"
    build({takes_folder: find_recipe(takes_folder)}, out, settings=Settings(seed=5))
    return out


@pytest.fixture
def built(built_folder: Path) -> DanceLibrary:
    from studykit.library import open_library

    return open_library(built_folder)
