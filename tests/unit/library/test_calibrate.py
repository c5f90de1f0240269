"""What is light, intense, varied and smooth is measured on chains of the library's own segments."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from studykit.choreography.dance_library import distances
from studykit.core.errors import InputError
from studykit.core.seeding import stream
from studykit.library import calibrate
from studykit.library.calibrate import CHAINS


def relabelled(library, **columns):
    return replace(library, segments=library.segments.assign(**columns))


def test_a_thousand_chains_of_eight(made_library) -> None:
    library = made_library(20)
    measured = calibrate.calibrate(library, stream(1, "calibration"))
    assert len(measured.chain_linear_energies) == len(measured.chain_varieties) == CHAINS
    assert len(measured.join_displacements) == 7 * CHAINS
    # Eight of twenty segments: the mean over chains is eight times the mean segment.
    each = library.linear_energies.sum(axis=1)
    assert measured.chain_linear_energies.mean() == pytest.approx(8.0 * each.mean(), rel=0.02)
    assert measured.chain_linear_energies.min() >= np.sort(each)[:8].sum() - 1e-12
    assert measured.chain_linear_energies.max() <= np.sort(each)[-8:].sum() + 1e-12
    pairs = [library.displacement(a, b) for a in range(20) for b in range(20) if a != b]
    assert measured.join_displacements.mean() == pytest.approx(np.mean(pairs), rel=0.02)
    assert set(np.round(measured.join_displacements, 9)) <= set(np.round(pairs, 9))
    between = distances(library, "euclidean_z")
    apart = [between.between([a], [b])[0, 0] for a, b in combinations(range(20), 2)]
    assert measured.chain_varieties.mean() == pytest.approx(np.mean(apart), rel=0.01)
    assert measured.transition_tolerance_m == pytest.approx(np.percentile(measured.join_displacements, 3.0))
    assert measured.energy_targets(25.0)[0] < measured.energy_targets(75.0)[0]


def test_the_unit_of_variety_is_between_takes(made_library) -> None:
    # Two segments a take: neighbours are left out of the median.
    library = made_library(8)
    features = np.array(library.features)
    features[1::2] = features[::2] + 0.001 * features[1::2]
    library = replace(library, features=features)
    between = distances(library, "euclidean_z")
    apart = [between.between([a], [b])[0, 0] for a, b in combinations(range(8), 2) if a // 2 != b // 2]
    measured = calibrate.calibrate(library, stream(1, "calibration"))
    assert measured.median_distance == pytest.approx(np.median(apart), rel=0.01)
    near = between.between([0], [1])[0, 0]
    assert near < 0.1 * measured.median_distance


def test_chains_keep_to_one_genre(made_library) -> None:
    # Eight slow segments and twelve wild ones: no chain mixes them.
    library = relabelled(made_library(20), genre=["slow"] * 8 + ["wild"] * 12)
    energies = np.where(np.arange(20) < 8, 1.0, 100.0)[:, None] / 24.0 * np.ones(24)
    library = replace(library, linear_energies=energies)
    sums = calibrate.calibrate(library, stream(2, "calibration")).chain_linear_energies
    assert set(np.round(sums, 6)) == {8.0, 800.0}
    assert np.mean(sums > 100.0) == pytest.approx(0.6, abs=0.05)  # genres by their number of segments


def test_small_genres_are_danced_together(made_library) -> None:
    library = relabelled(made_library(10), genre=["a"] * 5 + ["b"] * 5)
    assert len(calibrate.calibrate(library, stream(1, "calibration")).chain_varieties) == CHAINS


def test_the_same_seed_measures_the_same(made_library) -> None:
    library = made_library(12)
    first, again, other = (calibrate.calibrate(library, stream(seed, "calibration")) for seed in (3, 3, 4))
    assert np.array_equal(first.chain_varieties, again.chain_varieties)
    assert not np.array_equal(first.chain_varieties, other.chain_varieties)


@pytest.mark.parametrize(("segments", "take"), [(7, None), (12, "one")])
def test_too_little_to_calibrate_is_named(made_library, segments, take) -> None:
    library = made_library(segments)
    if take is not None:
        library = relabelled(library, take=take)
    with pytest.raises(InputError, match=r"^made-up: .* too few to calibrate; give at least 8 segments"):
        calibrate.calibrate(library, stream(1, "calibration"))
