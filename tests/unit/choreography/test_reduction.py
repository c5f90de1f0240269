"""Distances from few numbers: exact where the axes span all there is, close where they do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from studykit.choreography.dance_library import distances
from studykit.choreography.reduction import Reduced, reduced
from studykit.core.seeding import stream


@pytest.fixture(scope="module")
def library(made_library):
    return made_library(40)


def off_diagonal(square: np.ndarray) -> np.ndarray:
    return square[~np.eye(len(square), dtype=bool)]


def test_with_an_axis_for_every_segment_distances_are_exact(library) -> None:
    exact = distances(library, "euclidean_z").between(range(40), range(40))
    found = reduced(library, stream(1, "axes"), dimensions=39)
    assert found.between(range(40), range(40)) == pytest.approx(exact, rel=1e-4, abs=1e-9)
    assert found.residuals.max() < 1e-2 * exact.max()


def test_what_the_axes_leave_out_is_made_up_for(library) -> None:
    exact = off_diagonal(distances(library, "euclidean_z").between(range(40), range(40)))
    found = reduced(library, stream(1, "axes"), dimensions=8)
    assert found.coordinates.shape == (40, 8)
    assert found.coordinates.dtype == np.float32
    near = off_diagonal(found.between(range(40), range(40)))
    assert np.abs(near / exact - 1.0).max() < 0.15
    assert np.median(near / exact) == pytest.approx(1.0, abs=0.02)
    # Without the residuals the distances would be far too short.
    short = off_diagonal(replace(found, residuals=np.zeros(40)).between(range(40), range(40)))
    assert np.median(short / exact) < 0.7


def test_a_sample_of_the_segments_gives_the_axes(library, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("studykit.choreography.reduction._SAMPLE", 20)
    monkeypatch.setattr("studykit.choreography.reduction._BLOCK", 7)
    found = reduced(library, stream(1, "axes"))
    assert found.coordinates.shape == (40, 19)  # twenty segments about their mean
    exact = off_diagonal(distances(library, "euclidean_z").between(range(40), range(40)))
    assert np.abs(off_diagonal(found.between(range(40), range(40))) / exact - 1.0).max() < 0.05


def test_projection_keeps_the_length_about_the_mean(library) -> None:
    found = reduced(library, stream(1, "axes"), dimensions=5)
    vectors = library.standardised(slice(None)).astype(float)
    lengths = np.linalg.norm(vectors - vectors.mean(axis=0), axis=1)
    kept = np.hypot(np.linalg.norm(found.coordinates, axis=1), found.residuals)
    assert kept == pytest.approx(lengths, rel=1e-4)
    # The axes are those of greatest spread: each coordinate spreads less than the one before.
    spreads = found.coordinates.std(axis=0)
    assert np.all(np.diff(spreads) <= 1e-6)


def test_a_segment_is_no_different_from_itself() -> None:
    made = Reduced(
        coordinates=np.array([[0.0, 0.0], [3.0, 4.0]], dtype=np.float32),
        residuals=np.array([5.0, np.sqrt(50)]),
    )
    assert made.between([0, 1], [0, 1]) == pytest.approx(np.array([[0.0, 10.0], [10.0, 0.0]]))
    assert made.between(0, 1) == pytest.approx(np.array([[10.0]]))
