"""Make cluster_permutation.json with MNE: python make_cluster_permutation.py > cluster_permutation.json.

Nine people's curves of two conditions, every flip of the signs looked at, at two thresholds.
"""

from __future__ import annotations

import json
import sys

import mne
import numpy as np
import scipy
from scipy import stats
from scipy.ndimage import gaussian_filter1d

rng = np.random.default_rng(12)
curves = gaussian_filter1d(rng.normal(size=(2, 9, 48)), 2.0, axis=-1)
curves[0, :, 20:30] += 0.35
curves = curves.round(4)
found = {}
for threshold_p in (0.05, 0.2):
    threshold = float(stats.t.isf(threshold_p / 2.0, 8))
    observed, clusters, p, _ = mne.stats.permutation_cluster_1samp_test(
        curves[0] - curves[1], threshold=threshold, n_permutations="all", out_type="mask", verbose=False
    )
    found[str(threshold_p)] = sorted(
        [cluster[0].start, cluster[0].stop - 1, float(observed[cluster[0]].sum()), float(value)]
        for cluster, value in zip(clusters, p, strict=True)
    )
json.dump(
    {
        "versions": {"mne": mne.__version__, "numpy": np.__version__, "scipy": scipy.__version__},
        "a": curves[0].tolist(),
        "b": curves[1].tolist(),
        "clusters": found,
    },
    sys.stdout,
)
