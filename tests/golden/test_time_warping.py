"""Alignments against tslearn, another implementation."""

from __future__ import annotations

from collections.abc import Callable
from time import thread_time

import numpy as np
import pytest

from studykit.analysis.dynamic_time_warping import COMMON_WEIGHTS, align, frame_costs


def test_path_and_cost_equal_tslearns() -> None:
    metrics = pytest.importorskip("tslearn.metrics")
    rng = np.random.default_rng(0)
    for guide_frames, danced_frames, band in ((40, 40, 5), (40, 34, 4), (34, 40, 4)):
        guide, danced = (
            np.cumsum(rng.normal(size=(frames, 15, 3)), axis=0) for frames in (guide_frames, danced_frames)
        )
        costs = frame_costs(guide[:, None], danced[None], COMMON_WEIGHTS)
        path, total = metrics.dtw_path_from_metric(
            costs, metric="precomputed", global_constraint="sakoe_chiba", sakoe_chiba_radius=band
        )
        found = align(guide, danced, band)
        assert found.total_m == pytest.approx(total, rel=1e-9)
        assert found.path.tolist() == [list(step) for step in path]
        assert found.distance_m == pytest.approx(total / len(path), rel=1e-9)


@pytest.mark.parametrize("radius", [None, 0, 3, 25])
@pytest.mark.parametrize(("guide_frames", "danced_frames"), [(60, 60), (60, 47), (47, 60)])
def test_tslearns_own_distance_can_be_chosen(
    radius: int | None, guide_frames: int, danced_frames: int
) -> None:
    metrics = pytest.importorskip("tslearn.metrics")
    rng = np.random.default_rng(1)
    guide, danced = (
        np.cumsum(rng.normal(size=(frames, 24, 3)), axis=0) for frames in (guide_frames, danced_frames)
    )
    constraint = {} if radius is None else {"global_constraint": "sakoe_chiba", "sakoe_chiba_radius": radius}
    path, distance = metrics.dtw_path(
        guide.reshape(guide_frames, -1), danced.reshape(danced_frames, -1), **constraint
    )
    found = align(guide, danced, radius, definition="tslearn")
    assert found.distance_m == pytest.approx(distance, rel=1e-9)
    assert found.path.tolist() == [list(step) for step in path]
    # The mean of distances along the same path is another number altogether.
    assert align(guide, danced, radius, np.ones(24)).distance_m != pytest.approx(distance, rel=0.1)


@pytest.mark.slow
def test_a_pair_of_dances_takes_a_third_of_tslearns_time_at_most() -> None:
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
