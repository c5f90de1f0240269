"""The synthetic library: any size, repeatable, graded, no row twice."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io.datasets.take import Take
from studykit.library import sample
from studykit.motion import cleaning, energy, kinematics


@pytest.fixture(scope="module")
def takes() -> list[Take]:
    return list(sample.takes(240, seed=1))


def test_as_many_segments_as_asked_for(takes: list[Take]) -> None:
    assert [len(take.motion) for take in takes] == [1200] * 24
    assert [len(take.motion) for take in sample.takes(13, seed=1)] == [1200, 360]


def test_a_take_is_the_same_whatever_the_count(takes: list[Take]) -> None:
    short = list(sample.takes(13, seed=1))[-1]
    assert np.array_equal(short.motion.rotations, takes[1].motion.rotations[:360])
    assert np.array_equal(short.motion.root_positions, takes[1].motion.root_positions[:360])
    again = next(iter(sample.takes(34_613, seed=1)))
    assert np.array_equal(again.motion.rotations, takes[0].motion.rotations)
    other = next(iter(sample.takes(10, seed=2)))
    assert not np.array_equal(other.motion.rotations, takes[0].motion.rotations)


def test_takes_are_made_one_by_one() -> None:
    assert len(list(islice(sample.takes(10**9, seed=1), 2))) == 2


def test_every_take_says_what_it_is(takes: list[Take]) -> None:
    assert len({take.name for take in takes}) == len({take.source.sha256 for take in takes}) == 24
    assert len({take.source.genre for take in takes}) == 6
    for take in takes:
        assert take.source.is_synthetic
        for words in (take.name, take.source.data_set, take.source.performer, take.source.genre):
            assert "synthetic" in words


def test_no_row_comes_twice(takes: list[Take]) -> None:
    rows = np.concatenate([take.motion.rotations.reshape(10, -1) for take in takes]).astype(np.float32)
    assert len(np.unique(rows, axis=0)) == 240


def test_intensity_is_graded_over_a_factor_of_eight(takes: list[Take]) -> None:
    means = []
    for take in takes:
        centred = kinematics.centred_positions(take.motion.skeleton, take.motion.rotations)
        means.append(np.mean([energy.linear_energy(part, 30.0).sum() for part in np.split(centred, 10)]))
    logs = np.log(np.sort(means) / sample.LEAST_ENERGY) / np.log(sample.ENERGY_RANGE)
    evenly = (np.arange(24) + 0.5) / 24
    assert logs == pytest.approx(evenly, abs=0.17)  # spread evenly on the log scale from end to end
    assert max(means) / min(means) > 5.0


def test_the_noise_rule_keeps_everything(takes: list[Take]) -> None:
    for take in takes:
        centred = kinematics.centred_positions(take.motion.skeleton, take.motion.rotations)
        flags = cleaning.flagged(centred, 30.0, "robust")
        assert not any(flag.any() for flag in flags.values())


@pytest.mark.parametrize("count", [0, -3])
def test_an_empty_library_is_refused(count: int) -> None:
    with pytest.raises(InputError, match=r"segments: .* segments are asked for; ask for 1 or more"):
        next(sample.takes(count, seed=1))
