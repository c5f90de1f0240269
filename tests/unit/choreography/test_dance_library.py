"""Distances between segments and between poses, by their definitions."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.choreography import dance_library
from studykit.choreography.dance_library import SegmentDistances, mean_of_pairs, require_segments
from studykit.core.errors import InputError


@pytest.fixture(scope="module")
def library(made_library):
    return made_library(6)


def vectors(library) -> np.ndarray:
    """Give the standardised features, shape (segment, 120, 97), in full precision."""
    return np.clip((np.log1p(library.features.astype(float)[..., :72]) - 1.0) / 0.3, -5, 5), np.clip(
        (library.features.astype(float)[..., 72:] - 1.0) / 0.3, -5, 5
    )


@pytest.fixture(params=["dense", "on demand"])
def measured(request, library, monkeypatch):
    if request.param == "on demand":
        monkeypatch.setattr(dance_library, "DENSE_LIMIT", 0)
    return lambda metric: SegmentDistances(library, metric)


def test_euclidean_distances(library, measured) -> None:
    whole = np.concatenate([block.reshape(6, -1) for block in vectors(library)], axis=1)
    expected = np.linalg.norm(whole[:, None] - whole[None], axis=-1)
    assert measured("euclidean_z").between(range(6), range(6)) == pytest.approx(expected, rel=1e-4, abs=1e-9)


def test_cosine_distances_weigh_both_blocks_alike(library, measured) -> None:
    kinetic, geometric = (block.reshape(6, -1) for block in vectors(library))
    whole = np.concatenate((kinetic * np.sqrt(0.5 / 72), geometric * np.sqrt(0.5 / 25)), axis=1)
    whole /= np.linalg.norm(whole, axis=1, keepdims=True)
    # Eq. 5: phi of a pair is one minus the cosine.
    assert measured("cosine").between(range(6), range(6)) == pytest.approx(
        1.0 - whole @ whole.T, rel=1e-4, abs=1e-6
    )


@pytest.mark.parametrize("metric", ["euclidean_z", "cosine"])
def test_a_repeated_segment_is_no_different_from_itself(measured, metric) -> None:
    distances = measured(metric)
    assert distances.between([2, 2], [2, 3])[0, 0] == 0.0
    total = distances.total(1, (1, 1, 4))
    assert total == pytest.approx(distances.between([1], [4])[0, 0])


def test_the_mean_over_pairs() -> None:
    between = np.array([[0.0, 1.0, 2.0], [1.0, 0.0, 6.0], [2.0, 6.0, 0.0]])
    assert mean_of_pairs(between) == pytest.approx(3.0)
    assert mean_of_pairs(np.zeros((1, 1))) == 0.0


def test_displacement_is_the_mean_over_joints(library) -> None:
    expected = np.mean(
        [np.sqrt(((library.first_poses[4][j] - library.last_poses[1][j]) ** 2).sum()) for j in range(24)]
    )
    assert library.displacement(1, 4) == pytest.approx(expected)
    assert library.displacement(4, 1) != library.displacement(1, 4)


def test_too_few_segments_are_refused(library) -> None:
    require_segments(library, 6)
    with pytest.raises(InputError, match=r"^made-up: the library has 6 segments, .* needs 8; add takes"):
        require_segments(library, 8)
