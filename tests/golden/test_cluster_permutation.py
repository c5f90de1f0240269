"""Clusters over time against MNE (make_cluster_permutation.py)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studykit.analysis.curves import cluster_permutation

GOLDEN: dict[str, Any] = json.loads(Path(__file__).with_name("cluster_permutation.json").read_text())


@pytest.mark.parametrize("threshold_p", GOLDEN["clusters"])
def test_clusters_masses_and_exact_p_are_those_of_mne(threshold_p: str) -> None:
    a, b = np.array(GOLDEN["a"]), np.array(GOLDEN["b"])
    found = cluster_permutation(
        a, b, np.arange(48.0), rng=np.random.default_rng(0), threshold_p=float(threshold_p)
    )
    expected = GOLDEN["clusters"][threshold_p]
    assert found.permutations == 512
    for cluster, (start, stop, mass, p) in zip(found.clusters, expected, strict=True):
        assert (cluster.start_s, cluster.stop_s) == (start, stop)
        assert cluster.mass == pytest.approx(mass, rel=1e-9)
        # MNE looks at one flip of each of the 256 mirrored pairs but for one pair, which it leaves out.
        assert round(256 * cluster.p) - round(255 * p) in {0, 1}
