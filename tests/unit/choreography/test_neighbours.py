"""The segments that follow another most smoothly, against all pairs one by one."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.choreography import neighbours
from studykit.choreography.neighbours import successors


def ranked(first_poses, last_poses, count: int) -> np.ndarray:
    """Rank all segments by Eq. 3, word by word."""
    rows = []
    for before, last in enumerate(last_poses):
        displacements = [
            np.inf if after == before else np.linalg.norm(first - last, axis=-1).mean()
            for after, first in enumerate(first_poses)
        ]
        rows.append(np.argsort(displacements, kind="stable")[:count])
    return np.array(rows)


@pytest.fixture
def poses() -> np.ndarray:
    return np.random.default_rng(3).normal(scale=0.3, size=(2, 60, 24, 3))


@pytest.mark.parametrize("tile", [7, 1024])
def test_the_nearest_come_first(poses, tile, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(neighbours, "_TILE", tile)
    found = successors(*poses, count=10)
    assert found.dtype == np.int32
    assert np.array_equal(found, ranked(*poses, 10))
    # Which of the two poses is the last one matters, and so does the mean of lengths (Eq. 3), which is
    # not the length of all differences together.
    assert not np.array_equal(found, ranked(poses[1], poses[0], 10))
    together = np.linalg.norm((poses[0][None] - poses[1][:, None]).reshape(60, 60, -1), axis=-1)
    np.fill_diagonal(together, np.inf)
    assert not np.array_equal(found, np.argsort(together, axis=1)[:, :10])


def test_no_segment_follows_itself_though_it_ends_as_it_begins(poses) -> None:
    found = successors(poses[0], poses[0], count=5)
    assert not np.any(found == np.arange(60)[:, None])


def test_of_equal_ones_the_first_comes_first() -> None:
    still = np.zeros((5, 24, 3))
    assert successors(still, still, count=3).tolist() == [
        [1, 2, 3],
        [0, 2, 3],
        [0, 1, 3],
        [0, 1, 2],
        [0, 1, 2],
    ]


@pytest.mark.parametrize(("segments", "kept"), [(1, 0), (2, 1), (32, 31), (33, 32), (40, 32)])
def test_a_small_library_gives_what_it_has(segments: int, kept: int) -> None:
    poses = np.random.default_rng(1).normal(size=(2, segments, 24, 3))
    assert successors(*poses).shape == (segments, kept)
