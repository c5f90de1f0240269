"""Distances between segments and between poses, by their definitions."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from studykit.choreography import dance_library
from studykit.choreography.dance_library import SegmentDistances, mean_of_pairs
from studykit.choreography.reduction import reduced
from studykit.core.errors import InputError
from studykit.core.seeding import stream
from studykit.motion.skeleton import NEUTRAL_BODY


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
    assert distances.guide(2, 2) == 0.0
    exact = distances.exact([1, 1, 4])
    assert exact[0, 1] == exact[1, 0] == exact[2, 2] == 0.0
    assert exact[0, 2] == exact[2, 1] == pytest.approx(distances.between([1], [4])[0, 0], rel=1e-4)
    assert distances.guide(1, 4) == pytest.approx(exact[0, 2], rel=1e-4)


def test_a_large_library_is_searched_by_reduced_distances_and_judged_by_exact_ones(
    library, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dance_library, "DENSE_LIMIT", 0)
    exact = SegmentDistances(library, "euclidean_z").exact([0, 3])[0, 1]
    large = replace(library, reduced=reduced(library, stream(1, "axes"), dimensions=2))
    found = SegmentDistances(large, "euclidean_z")
    assert found.is_reduced
    assert found.table is None
    assert found.guide(0, 3) == large.reduced.between(0, 3)[0, 0] != exact
    assert found.exact([0, 3])[0, 1] == exact
    assert not SegmentDistances(large, "cosine").is_reduced


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


def spoilt(library, name: str, value: float = np.nan):
    array = np.array(getattr(library, name))
    array[3].flat[5] = value
    return replace(library, **{name: array})


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize(
    "name",
    ["linear_energies", "rotational_energies", "first_poses", "last_poses", "peak_speeds", "peak_angles"],
)
def test_what_is_no_number_is_found_when_a_library_is_opened(library, name: str, value: float) -> None:
    message = rf"^made-up: segment 3 has {name} that are no numbers; build it again\.$"
    with pytest.raises(InputError, match=message):
        spoilt(library, name, value)


def test_a_successor_that_is_no_segment_is_found_when_a_library_is_opened(library) -> None:
    for number in (-1, 6):
        with pytest.raises(InputError, match="a successor is no segment"):
            replace(library, successors=np.full_like(library.successors, number))


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("name", ["rotations", "root_positions"])
def test_what_is_no_number_is_found_when_a_segment_is_danced(library, name: str, value: float) -> None:
    bad = spoilt(library, name, value)
    bad.motion(2)
    with pytest.raises(InputError, match=f"segment 3 has {name} that are no numbers"):
        bad.motion(3)


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("limit", [0, 4096])
def test_features_that_are_no_numbers_are_found_when_compared(library, monkeypatch, value, limit) -> None:
    monkeypatch.setattr(dance_library, "DENSE_LIMIT", limit)
    bad = spoilt(library, "features", value)
    with pytest.raises(InputError, match="segment 3 has features that are no numbers"):
        SegmentDistances(bad, "euclidean_z").between([0, 1], [2, 3])


def test_the_same_movement_is_of_one_take_and_overlaps(library) -> None:
    table = library.segments.assign(
        take=["a", "a", "a", "a", "b", "b"],
        start_s=[0.0, 3.5, 3.996, 0.0, 0.0, 8.0],
        mirrored=[False, False, False, True, False, False],
    )
    library = replace(library, segments=table)
    same = library.same_movement(np.arange(6)[:, None], np.arange(6))
    # 0 and 1 overlap, 1 and 2 as well; 2 follows 0 at a rate of 30.03 Hz; 3 is the mirror image of 0.
    expected = {(0, 1), (1, 2), (0, 3), (1, 3)}
    assert {(a, b) for a, b in combinations(range(6), 2) if same[a, b]} == expected
    assert np.array_equal(same, same.T)
    assert same.diagonal().all()
    assert library.same_movement(0, 3)
    takes, starts_s = library.movements
    assert (takes.dtype, starts_s.dtype) == (np.int64, np.float64)
    assert takes.tolist() == [0, 0, 0, 0, 1, 1]


def test_speed_limits_are_what_joints_do_in_segments_that_move_them(library) -> None:
    peaks = np.tile(np.arange(1.0, 7.0)[:, None], (1, 24))
    peaks[:, 5] = 0.0
    peaks[[0, 2, 4], 6] = 0.0
    library = replace(library, peak_speeds=peaks)
    assert library.speed_limits()[0] == 3.5
    assert library.speed_limits(25.0)[0] == 2.25
    assert library.speed_limits()[5] == np.inf
    assert library.speed_limits()[6] == 4.0
    moved = NEUTRAL_BODY.joint_names[6]
    assert [library.share_below(moved, speed) for speed in (1.9, 2.0, 4.0, 9.0)] == [0.0, 1 / 3, 2 / 3, 1.0]
    assert library.share_below(NEUTRAL_BODY.joint_names[5], 0.5) == 1.0
