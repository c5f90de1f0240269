"""How long the heavy parts take; measurements without a verdict (make benchmark)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from time import thread_time
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


def test_warping_takes_a_third_of_tslearns_time_at_most() -> None:
    metrics = pytest.importorskip("tslearn.metrics")
    guide, danced = np.cumsum(np.random.default_rng(0).normal(size=(2, 960, 24, 3)), axis=1)

    def ours() -> float:
        return align(guide, danced, None, definition="tslearn").distance_m

    def theirs() -> float:
        return float(metrics.dtw_path(guide.reshape(960, -1), danced.reshape(960, -1))[1])

    assert ours() == pytest.approx(theirs(), rel=1e-9)  # and both are compiled now
    assert 3.0 * _shortest_s(ours) <= _shortest_s(theirs)


def _shortest_s(work: Callable[[], object]) -> float:
    times = []
    for _ in range(15):
        start = thread_time()  # whatever else the machine does
        work()
        times.append(thread_time() - start)
    return min(times)
