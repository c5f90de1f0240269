"""What must hold of alignments and of the common space whatever the movement."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studykit.analysis.dynamic_time_warping import COMMON_WEIGHTS, align, common_space, frame_costs
from studykit.motion import rotation
from studykit.motion.kinematics import joint_positions
from studykit.motion.motion import Motion
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY, Skeleton

seeds = st.integers(0, 2**32 - 1)
lengths = st.integers(1, 12)
bands = st.integers(0, 13)
ELSEWHERE = np.array([3.0, 1.0, -2.0])


def movement(seed: int, frames: int) -> np.ndarray:
    return np.cumsum(np.random.default_rng(seed).normal(0.0, 0.1, size=(frames, 15, 3)), axis=0)


def dance(seed: int, frames: int = 40, skeleton: Skeleton = NEUTRAL_BODY) -> Motion:
    rng = np.random.default_rng(seed)
    swing = rng.normal(0.0, 0.4, size=(24, 3)) * np.sin(np.linspace(0.0, 5.0, frames))[:, None, None]
    path = np.cumsum(rng.normal(0.0, 0.02, size=(frames, 3)), axis=0)
    return Motion(skeleton=skeleton, rotations=rotation.exp(swing), root_positions=path, frame_rate_hz=30.0)


def by_recursion(guide: np.ndarray, danced: np.ndarray, band: int) -> float:
    costs = frame_costs(guide[:, None], danced[None], COMMON_WEIGHTS)
    longer = costs.shape[1] - costs.shape[0]
    total = np.full((costs.shape[0] + 1, costs.shape[1] + 1), np.inf)
    total[0, 0] = 0.0
    for i, j in np.ndindex(*costs.shape):
        if min(0, longer) - band <= j - i <= max(0, longer) + band:
            total[i + 1, j + 1] = costs[i, j] + min(total[i, j], total[i, j + 1], total[i + 1, j])
    return float(total[-1, -1])


@settings(max_examples=60, deadline=None)
@given(seeds, lengths, lengths, bands)
def test_the_cost_equals_the_plain_recursion(seed: int, n: int, m: int, band: int) -> None:
    guide, danced = movement(seed, n), movement(seed + 1, m)
    result = align(guide, danced, band)
    assert result.total_m == pytest.approx(by_recursion(guide, danced, band), rel=1e-12)
    steps = np.diff(result.path, axis=0)
    assert result.path[0].tolist() == [0, 0]
    assert result.path[-1].tolist() == [n - 1, m - 1]
    assert {tuple(step) for step in steps.tolist()} <= {(1, 1), (1, 0), (0, 1)}


@settings(deadline=None)
@given(seeds, lengths, bands)
def test_nothing_separates_a_movement_from_itself(seed: int, frames: int, band: int) -> None:
    result = align(movement(seed, frames), movement(seed, frames), band)
    assert result.distance_m == 0.0
    assert result.lag_s == 0.0
    assert not result.distance_by_frame_m.any()


@settings(deadline=None)
@given(seeds, lengths, lengths, bands)
def test_guide_and_dancer_can_change_places(seed: int, n: int, m: int, band: int) -> None:
    guide, danced = movement(seed, n), movement(seed + 1, m)
    forth, back = align(guide, danced, band), align(danced, guide, band)
    assert forth.distance_m == pytest.approx(back.distance_m, rel=1e-12)
    assert forth.lag_s == pytest.approx(-back.lag_s)


@settings(deadline=None)
@given(seeds, lengths, bands)
def test_warping_never_costs_more_than_going_frame_by_frame(seed: int, frames: int, band: int) -> None:
    guide, danced = movement(seed, frames), movement(seed + 1, frames)
    result = align(guide, danced, band)
    frame_by_frame = frame_costs(guide, danced, COMMON_WEIGHTS)
    assert result.distance_m <= frame_by_frame.mean() * (1.0 + 1e-12)
    assert align(guide, danced, band + 1).total_m <= result.total_m * (1.0 + 1e-12)
    assert align(guide, danced, 0).total_m == pytest.approx(frame_by_frame.sum())


@settings(max_examples=25, deadline=None)
@given(seeds, st.floats(-3.1, 3.1), st.floats(0.7, 1.4))
def test_place_facing_and_size_are_taken_away(seed: int, turn_rad: float, size: float) -> None:
    lengths_of_bones = size * np.random.default_rng(seed).uniform(0.8, 1.2, size=(24, 1))
    body = Skeleton(
        joint_names=JOINT_NAMES,
        parents=NEUTRAL_BODY.parents,
        offsets=NEUTRAL_BODY.offsets * lengths_of_bones,
        mirror=NEUTRAL_BODY.mirror,
    )
    guide = joint_positions(dance(seed))
    dancer = rotation.rotate(rotation.yaw(turn_rad), joint_positions(dance(seed, skeleton=body))) + ELSEWHERE
    own, other = common_space(guide, JOINT_NAMES), common_space(dancer, JOINT_NAMES)
    # The front is found from hips and shoulders, which differ a little in another body: compare up to a turn.
    np.testing.assert_allclose(np.linalg.norm(own, axis=-1), np.linalg.norm(other, axis=-1), atol=1e-9)
    same_body = rotation.rotate(rotation.yaw(turn_rad), size * guide) + ELSEWHERE
    np.testing.assert_allclose(common_space(same_body, JOINT_NAMES), own, atol=1e-9)


@settings(max_examples=15, deadline=None)
@given(
    seeds,
    st.lists(st.sampled_from(["spine1", "left_collar", "right_elbow", "left_knee", "neck"]), unique=True),
)
def test_a_joint_out_of_sight_does_not_move_the_others(seed: int, hidden: list[str]) -> None:
    positions = 1.2 * joint_positions(dance(seed))
    whole = common_space(positions, JOINT_NAMES)
    positions[5:9, [JOINT_NAMES.index(name) for name in hidden]] = np.nan
    partial = common_space(positions, JOINT_NAMES)
    seen = np.isfinite(partial)
    np.testing.assert_allclose(partial[seen], whole[seen], atol=1e-9)
    assert np.isnan(partial).any() == any(name in {"right_elbow", "left_knee", "neck"} for name in hidden)
