from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import kinematics, rotation
from studykit.motion.skeleton import NEUTRAL_BODY
from studykit.motion.window_fit import Pull, _banded_solution, fitted

ELBOW = NEUTRAL_BODY.index("left_elbow")
BEYOND = [NEUTRAL_BODY.index("left_wrist"), NEUTRAL_BODY.index("left_hand")]
FRAMES = 16


def any_turns(rng: np.random.Generator, *shape: int) -> np.ndarray:
    return rotation.exp(rng.normal(scale=0.6, size=(*shape, 24, 3)))


def one_hinge(angles: np.ndarray) -> np.ndarray:
    """Give one window of a body that turns its left elbow about Y."""
    rotations = rotation.identity(1, len(angles), 24)
    rotations[0, :, ELBOW] = rotation.exp(angles[:, None] * np.array([0.0, 1.0, 0.0]))
    return rotations


def pull(
    *, weights: float = 0.0, prior: float = 0.0, smoothness: float = 0.0, is_lively: bool = False
) -> Pull:
    return Pull(np.array(weights), np.array(prior), smoothness, is_lively)


@pytest.mark.parametrize("seed", range(3))
def test_slopes_are_those_of_finite_differences(seed) -> None:
    rng = np.random.default_rng(seed)
    rotations = any_turns(rng, 2)
    turning = (0, 1, 4, 9, 16, 18)
    slopes = kinematics.position_slopes(NEUTRAL_BODY, kinematics.posed(NEUTRAL_BODY, rotations), turning)
    assert slopes.shape == (2, 24, 3, 18)
    for column in range(18):
        joint, axis = turning[column // 3], column % 3
        moved = []
        for size in (1e-6, -1e-6):
            turned = np.array(rotations)
            turned[:, joint] = rotation.multiply(rotations[:, joint], rotation.exp(size * np.eye(3)[axis]))
            moved.append(kinematics.centred_positions(NEUTRAL_BODY, turned))
        assert slopes[..., column] == pytest.approx((moved[0] - moved[1]) / 2e-6, abs=1e-8)


def test_slopes_about_the_parents_axes_would_be_noticed() -> None:
    rotations = any_turns(np.random.default_rng(0), 1)
    slopes = kinematics.position_slopes(NEUTRAL_BODY, kinematics.posed(NEUTRAL_BODY, rotations), (16,))
    # Wrong: the turn is taken to be R <- exp(delta) R.
    wrong = slopes @ rotation.to_matrix(rotations[0, 16]).T
    assert np.abs(slopes - wrong).max() > 0.05


def test_a_body_comes_to_where_its_joints_are_wanted() -> None:
    rng = np.random.default_rng(1)
    aim = any_turns(rng, 2, FRAMES)
    start = rotation.multiply(aim, rotation.exp(rng.normal(scale=0.2, size=(2, FRAMES, 24, 3))))
    start[:, [0, 1, -2, -1]] = aim[:, [0, 1, -2, -1]]
    wanted = kinematics.centred_positions(NEUTRAL_BODY, aim)
    free = [joint for joint in range(24) if NEUTRAL_BODY.children(joint)]
    found = fitted(start, wanted, NEUTRAL_BODY, free=free, pull=pull(weights=1.0, prior=1e-7), rounds=12)
    missed = np.linalg.norm(kinematics.centred_positions(NEUTRAL_BODY, found) - wanted, axis=-1)
    before = np.linalg.norm(kinematics.centred_positions(NEUTRAL_BODY, start) - wanted, axis=-1)
    assert before.max() > 0.1
    assert missed.max() < 1e-4
    # The ends of a window and joints that are not free stay as they were, to the last bit.
    held = [joint for joint in range(24) if joint not in free]
    assert np.array_equal(found[:, [0, 1, -2, -1]], start[:, [0, 1, -2, -1]])
    assert np.array_equal(found[:, :, held], start[:, :, held])


def test_a_prior_holds_a_hinge_back_by_its_share() -> None:
    # One small turn: weight x sum of arms^2 against prior x lever^2.
    wanted_angle, weight, prior = 1e-3, 2.0, 0.7
    angles = np.zeros(FRAMES)
    wanted = kinematics.centred_positions(NEUTRAL_BODY, one_hinge(np.full(FRAMES, wanted_angle)))
    found = fitted(
        one_hinge(angles),
        wanted,
        NEUTRAL_BODY,
        free=(ELBOW,),
        pull=pull(weights=weight, prior=prior),
        rounds=2,
    )
    positions = kinematics.centred_positions(NEUTRAL_BODY, one_hinge(angles))[0, 0]
    arms = positions[BEYOND] - positions[ELBOW]
    across = np.sum(arms[:, [0, 2]] ** 2)
    bones = NEUTRAL_BODY.bone_lengths
    lever = bones[BEYOND[0]] ** 2 + (bones[BEYOND[0]] + bones[BEYOND[1]]) ** 2
    share = weight * across / (weight * across + prior * lever)
    turn = rotation.log(found)[0, 2:-2, ELBOW]
    assert turn[:, 1] == pytest.approx(np.full(FRAMES - 4, share * wanted_angle), rel=1e-3)


@pytest.mark.parametrize("is_lively", [False, True])
def test_smoothing_a_hinge_is_a_smoothing_spline(is_lively) -> None:
    # About one axis all is linear: (prior + smoothness D'D) change = -smoothness D'D angles.
    angles = np.random.default_rng(2).normal(scale=0.3, size=FRAMES)
    prior, smoothness = 0.5, 3.0
    start = one_hinge(angles)
    wanted = kinematics.centred_positions(NEUTRAL_BODY, start)
    found = fitted(
        start,
        wanted,
        NEUTRAL_BODY,
        free=(ELBOW,),
        pull=pull(prior=prior, smoothness=smoothness, is_lively=is_lively),
        rounds=2,
    )
    bends = np.diff(np.eye(FRAMES), 2, axis=0)
    inner = bends[:, 2:-2]
    change = np.linalg.solve(
        prior * np.eye(FRAMES - 4) + smoothness * inner.T @ inner, -smoothness * inner.T @ bends @ angles
    )
    expected = angles.copy()
    # A lively movement has nothing that the fit must smooth.
    expected[2:-2] += 0.0 if is_lively else change
    assert rotation.log(found)[0, :, ELBOW, 1] == pytest.approx(expected, abs=1e-9)


def test_all_windows_are_solved_at_once_as_each_alone() -> None:
    rng = np.random.default_rng(3)
    half = rng.normal(size=(2, 5, 4, 4))
    blocks = half @ np.swapaxes(half, 2, 3) + 0.1 * np.eye(4)
    bends = np.diff(np.eye(9), 2, axis=0)[:, 2:-2]
    stiffness, force = rng.uniform(0.1, 1.0, size=4), rng.normal(size=(2, 5, 4))
    found = _banded_solution(blocks, bends.T @ bends, stiffness, force)
    for window in range(2):
        dense = np.kron(bends.T @ bends, np.diag(stiffness))
        for frame in range(5):
            part = slice(4 * frame, 4 * frame + 4)
            dense[part, part] += blocks[window, frame]
        alone = np.linalg.solve(dense, force[window].ravel())
        assert found[window].ravel() == pytest.approx(alone, abs=1e-9)
