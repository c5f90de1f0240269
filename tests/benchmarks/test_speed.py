"""How long the heavy parts take; measurements without a verdict (make benchmark)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studykit.analysis.dynamic_time_warping import align
from studykit.choreography.choreograph import dance
from studykit.choreography.targets import goals
from studykit.io.protocol_file import default_protocol, read_protocol
from studykit.library import make_sample
from studykit.motion import kinematics

pytestmark = pytest.mark.benchmark

Benchmark = Callable[..., Any]


def test_one_dance(benchmark: Benchmark, tmp_path: Path) -> None:
    library = make_sample(tmp_path / "library")
    goal = goals(read_protocol(default_protocol()), library)["light-easy-on"]
    assert benchmark(dance, goal, library).achieved.duration_s == goal.duration_s


def test_forward_kinematics_of_a_dance(benchmark: Benchmark, tmp_path: Path) -> None:
    motion = make_sample(tmp_path / "library", segments=20).motion(0)
    assert benchmark(kinematics.joint_positions, motion).shape == (120, 24, 3)


def test_warping_of_two_dances(benchmark: Benchmark) -> None:
    guide, danced = np.random.default_rng(0).normal(size=(2, 960, 15, 3))
    assert benchmark(align, guide, danced, 30).distance_m > 0.0


@pytest.mark.parametrize("program", ["studykit", "tslearn"])
def test_warping_without_a_band(benchmark: Benchmark, program: str) -> None:
    guide, danced = np.random.default_rng(0).normal(size=(2, 960, 24, 3))
    if program == "studykit":
        benchmark(align, guide, danced, None, definition="tslearn")
        return
    metrics = pytest.importorskip("tslearn.metrics")
    benchmark(metrics.dtw_path, guide.reshape(960, -1), danced.reshape(960, -1))
