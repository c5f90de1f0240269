"""Segments of real takes, joined: no harder, sliding no more and asking no more than the takes themselves."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from studykit.library.build import build
from studykit.library.measure import Settings
from studykit.motion import blending, foot_contact, kinematics, rotation
from studykit.motion.animation import REACH, animate
from studykit.motion.join_quality import JoinQuality, join_quality, usual_acceleration
from studykit.motion.motion import Motion
from studykit.motion.segmentation import SEGMENT_FRAMES

pytestmark = pytest.mark.slow

FOLDERS = ("motion/cmu-bvh-acrnn", "motion/cmu-fbx-keijiro")
CHAINS, SEGMENTS = 20, 8


@pytest.fixture(scope="module")
def library(shared_data: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory):
    out = tmp_path_factory.mktemp("libraries") / "joins"
    return build([shared_data(name) for name in FOLDERS], out, settings=Settings(mirrored=True))


@pytest.fixture(scope="module")
def segments(library) -> list[Motion]:
    return [library.motion(row) for row in range(len(library))]


@pytest.fixture(scope="module")
def random_chains(segments) -> list[list[Motion]]:
    """Chains of segments that have nothing to do with each other."""
    rng = np.random.default_rng(0)
    rows = [rng.choice(len(segments), SEGMENTS, replace=False) for _ in range(CHAINS)]
    return [[segments[row] for row in chain] for chain in rows]


@pytest.fixture(scope="module")
def smooth_chains(library, segments) -> list[list[Motion]]:
    """Chains in which each segment begins much as the last one ended."""
    rng = np.random.default_rng(1)
    last, first = np.array(library.last_poses), np.array(library.first_poses)
    chains = []
    for _ in range(CHAINS):
        rows = [int(rng.integers(len(segments)))]
        while len(rows) < SEGMENTS:
            jumps = np.linalg.norm(last[rows[-1]] - first, axis=-1).mean(axis=-1)
            near = [int(row) for row in np.argsort(jumps) if row not in rows]
            rows.append(int(rng.choice(near[:10])))
        chains.append([segments[row] for row in rows])
    return chains


def qualities(chains: list[list[Motion]], play: Callable[[list[Motion]], Motion]) -> list[JoinQuality]:
    return [join_quality(chain, play(chain)) for chain in chains]


def jolting(found: list[JoinQuality], usual: float) -> float:
    """Give the share of joins with a jolt beyond what is usual in the library."""
    return float(np.mean(np.concatenate([quality.accelerations for quality in found]) > usual))


def within(found: list[JoinQuality], name: str) -> float:
    """Give the share of dances whose energy is within 5 % of that of their segments."""
    return float(np.mean([abs(getattr(quality, name) - 1.0) <= 0.05 for quality in found]))


def mean(found: list[JoinQuality], name: str) -> float:
    return float(np.mean([getattr(quality, name) for quality in found]))


def places_alone(rotations: np.ndarray, roots: np.ndarray, frame: int) -> None:
    """Spread the gap of places over ten frames, and forget that of speeds (wrong)."""
    turn = rotation.between(rotations[frame - 1], rotations[frame])
    gap = roots[frame] - roots[frame - 1]
    share = (np.arange(5) + 0.5) / 5.0
    share = 0.5 * (1.0 - share**2 * (3.0 - 2.0 * share))
    for side, frames in ((1.0, frame - 1 - np.arange(5)), (-1.0, frame + np.arange(5))):
        spread = rotation.exp(side * share[:, None, None] * turn)
        rotations[frames] = rotation.multiply(rotations[frames], spread)
        roots[frames] += side * share[:, None] * gap


@pytest.fixture(scope="module")
def usual(segments) -> float:
    return usual_acceleration(segments)


def test_dances_of_smooth_joins_are_as_takes_are(smooth_chains, usual) -> None:
    found = qualities(smooth_chains, animate)
    assert jolting(found, usual) <= 0.05
    assert mean(found, "sliding") <= 1.2
    assert mean(found, "join_sliding") <= 1.6
    assert within(found, "linear_energy") >= 0.9
    assert within(found, "rotational_energy") >= 0.8


def test_dances_of_any_joins_are_nearly_so(random_chains, usual) -> None:
    found = qualities(random_chains, animate)
    assert jolting(found, usual) <= 0.10
    assert mean(found, "sliding") <= 1.3
    assert mean(found, "join_sliding") <= 2.0
    assert within(found, "linear_energy") >= 0.6
    assert within(found, "rotational_energy") >= 0.8


def test_feet_that_are_held_stand_still(smooth_chains, random_chains, monkeypatch) -> None:
    holds: list[foot_contact.Footholds] = []
    given = foot_contact.footholds

    def noted(points: np.ndarray, stands: np.ndarray) -> foot_contact.Footholds:
        holds.append(given(points, stands))
        return holds[-1]

    monkeypatch.setattr(foot_contact, "footholds", noted)
    missed = []
    for chain in (*smooth_chains, *random_chains):
        holds.clear()
        points = kinematics.joint_positions(animate(chain))[:, foot_contact.POINTS]
        for number, hold in enumerate(holds):
            join = SEGMENT_FRAMES * (number + 1)
            balls = slice(join - REACH, join + REACH), slice(2, None)
            part = slice(2, -2), slice(2, None)
            miss = np.linalg.norm(points[balls] - hold.places[part], axis=-1)
            missed.append(miss[hold.is_held[part]])
    misses = np.concatenate(missed)
    assert len(misses) > 1000
    assert np.mean(misses > 0.001) < 0.005
    assert misses.max() < 0.01


def test_a_stage_costs_neither_energy_nor_much_sliding(random_chains) -> None:
    free = qualities(random_chains, animate)
    kept = qualities(random_chains, lambda chain: animate(chain, stage_m=(3.0, 3.0)))
    assert mean(kept, "linear_energy") == pytest.approx(mean(free, "linear_energy"), rel=0.01)
    assert mean(kept, "sliding") <= mean(free, "sliding") + 0.1


def test_not_cleaning_and_not_matching_speeds_would_be_noticed(
    smooth_chains, random_chains, usual, monkeypatch
) -> None:
    blended = qualities(random_chains, blending.joined)
    assert jolting(blended, usual) > 0.15
    assert within(blended, "linear_energy") < 0.5
    assert mean(blended, "join_sliding") > 1.15 * mean(qualities(random_chains, animate), "join_sliding")
    monkeypatch.setattr(blending, "_spread_mismatch", places_alone)
    assert jolting(qualities(random_chains, blending.joined), usual) > 0.3
    assert jolting(qualities(smooth_chains, blending.joined), usual) > 0.1
