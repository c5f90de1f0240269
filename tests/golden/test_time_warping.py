"""Alignments against tslearn, another implementation."""

from __future__ import annotations

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
