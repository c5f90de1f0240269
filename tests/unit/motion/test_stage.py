from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import stage

FRAMES = 600


def walk(*, metres: tuple[float, float] = (5.0, 0.0)) -> np.ndarray:
    """Give a straight way, starting away from the origin."""
    share = np.linspace(0.0, 1.0, FRAMES)
    return np.stack((1.0 + metres[0] * share, np.full(FRAMES, 0.9), -2.0 + metres[1] * share), axis=1)


def alternating() -> np.ndarray:
    """Stand for half of the time, twenty frames at a time."""
    return np.arange(FRAMES) % 40 < 20


def test_how_far_a_way_leads_out() -> None:
    assert stage.excess_m(walk(), (6.0, 1.0)) == pytest.approx(2.0)
    assert stage.excess_m(walk(metres=(0.5, -3.0)), (6.0, 2.0)) == pytest.approx(2.0)
    assert stage.excess_m(walk(), (10.0, 1.0)) == 0.0


def test_a_way_on_the_stage_is_left_alone() -> None:
    way = walk(metres=(1.0, -1.0))
    assert np.array_equal(stage.kept_on(way, alternating(), (3.0, 3.0)), way)


def test_a_way_is_bent_to_the_stage_while_no_foot_stands() -> None:
    way, stands = walk(), alternating()
    bent = stage.kept_on(way, stands, (4.0, 4.0))
    assert stage.excess_m(bent, (4.0, 4.0)) < 1e-4
    assert bent[0] == pytest.approx(way[0], abs=1e-5)
    assert np.array_equal(bent[:, 1:], way[:, 1:])
    added = np.abs(np.diff(bent[:, 0] - way[:, 0]))
    both = stands[1:] & stands[:-1]
    # Wrong would be to cut off what sticks out: feet that stand would slide as much as those that do not.
    cut = np.abs(np.diff(np.clip(way[:, 0], -1.0, 3.0) - way[:, 0]))
    assert added[both].mean() < 0.5 * added[~both].mean()
    assert cut[both].mean() > 0.9 * cut[~both].mean()
    # No kink: to turn back at once would change the speed by all of it.
    assert np.abs(np.diff(bent[:, 0] - way[:, 0], 2)).max() < 0.4 * cut.max()


@pytest.mark.parametrize("seed", range(30))
def test_any_way_is_kept_on_any_stage(seed) -> None:
    rng = np.random.default_rng(seed)
    speed = np.cumsum(rng.normal(scale=0.003, size=(FRAMES, 3)), axis=0) * np.exp(rng.normal())
    way = np.cumsum(0.2 * speed, axis=0)
    size = (float(rng.uniform(0.3, 5.0)), float(rng.uniform(0.3, 5.0)))
    stands = rng.random(FRAMES // 10).repeat(10) < 0.6
    bent = stage.kept_on(way, stands, size)
    assert stage.excess_m(bent, size) < 2e-3
    assert np.array_equal(bent[:, 1], way[:, 1])
