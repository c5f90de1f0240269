"""The synthetic library: any size, repeatable, graded, no row twice."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io.datasets.take import Take
from studykit.library import sample
from studykit.motion import cleaning, energy, kinematics


def made_up(count: int, seed: int) -> list[Take]:
    return [take for source in sample.synthetic_takes(count, seed) for take in source.takes()]


@pytest.fixture(scope="module")
def takes() -> list[Take]:
    return made_up(240, 1)


def test_as_many_segments_as_asked_for(takes: list[Take]) -> None:
    assert [len(take.motion) for take in takes] == [1200] * 24
    assert [len(take.motion) for take in made_up(13, 1)] == [1200, 360]


def test_a_take_is_the_same_whatever_the_count(takes: list[Take]) -> None:
    short = made_up(13, 1)[-1]
    assert np.array_equal(short.motion.rotations, takes[1].motion.rotations[:360])
    assert np.array_equal(short.motion.root_positions, takes[1].motion.root_positions[:360])
    again = sample.synthetic_takes(34_613, 1)[0].takes()[0]
    assert np.array_equal(again.motion.rotations, takes[0].motion.rotations)
    other = made_up(10, 2)[0]
    assert not np.array_equal(other.motion.rotations, takes[0].motion.rotations)


def test_takes_are_made_when_they_are_read() -> None:
    sources = sample.synthetic_takes(100_000, 1)
    assert len({source.digest() for source in sources[:50]}) == 50
    assert [source.name for source in sources[-1:]] == ["synthetic-09999"]


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
        excess = cleaning.excesses(centred, take.motion.root_positions, 30.0)
        assert not cleaning.flagged(excess, "robust").any()


@pytest.mark.parametrize("count", [0, -3])
def test_an_empty_library_is_refused(count: int) -> None:
    with pytest.raises(InputError, match=r"segments: .* segments are asked for; ask for 1 or more"):
        sample.synthetic_takes(count, 1)
