from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import foot_contact, kinematics, rotation
from studykit.motion.skeleton import NEUTRAL_BODY

LEFT_BALL, RIGHT_BALL = 2, 3
FRAMES = 24


def standing(frames: int = FRAMES) -> np.ndarray:
    """Give joint positions of a body that stands still with flat feet."""
    pose = kinematics.centred_positions(NEUTRAL_BODY, rotation.identity(24))
    return np.tile(pose - [0.0, pose[:, 1].min(), 0.0], (frames, 1, 1))


def test_a_body_at_rest_stands_on_both_feet() -> None:
    assert foot_contact.contacts(standing(), 30.0).all()


def test_a_foot_that_is_lifted_or_fast_does_not_stand() -> None:
    positions = standing()
    left, right = foot_contact.POINTS[LEFT_BALL], foot_contact.POINTS[RIGHT_BALL]
    positions[10:16, left, 1] += 0.06
    positions[8:, right, 2] += 0.011 * np.arange(FRAMES - 8)  # 0.33 m/s from frame 8 on
    stands = foot_contact.contacts(positions, 30.0)
    assert not stands[9:17, LEFT_BALL].any()
    assert stands[:9, LEFT_BALL].all()
    assert stands[17:, LEFT_BALL].all()
    assert stands[:8, RIGHT_BALL].all()
    assert not stands[9:, RIGHT_BALL].any()


def test_two_frames_are_no_stand() -> None:
    positions = standing()
    positions[:8, :, 1] += 0.3
    positions[12:, :, 1] += 0.3
    # Frames 8 to 11 are low, 9 and 10 slow too.
    assert not foot_contact.contacts(positions, 30.0)[7:13].any()


def sliding(velocities: np.ndarray) -> np.ndarray:
    """Give points, shape (frame, 4, 3), that travel evenly; m a frame."""
    return np.arange(FRAMES)[:, None, None] * np.asarray(velocities)


def test_the_root_goes_against_a_foot_that_slides_while_it_stands() -> None:
    points = sliding([[0.0, 0.0, 0.0], [0.0] * 3, [0.01, 0.0, -0.02], [0.3, 0.0, 0.1]])
    stands = np.zeros((FRAMES, 4), dtype=bool)
    stands[:, LEFT_BALL] = True
    steps = foot_contact.root_steps(points, stands)
    assert steps.shape == (FRAMES - 1, 3)
    assert np.array_equal(steps[[0, -1]], np.zeros((2, 3)))
    # The root needs some frames to get under way, and makes up for them; the foot ends where it began.
    assert steps[8:-8] == pytest.approx(np.tile([-0.0115, 0.0, 0.023], (FRAMES - 17, 1)), abs=1e-3)
    moved = points[-2, LEFT_BALL] - points[1, LEFT_BALL] + steps[1:-1].sum(axis=0)
    assert moved == pytest.approx(np.zeros(3), abs=1e-6)


def test_without_a_foot_that_stands_the_root_goes_its_way() -> None:
    points = np.random.default_rng(0).normal(size=(FRAMES, 4, 3))
    assert not foot_contact.root_steps(points, np.zeros((FRAMES, 4), dtype=bool)).any()


def test_the_root_turns_with_the_room() -> None:
    rng = np.random.default_rng(1)
    points, stands = (
        np.cumsum(rng.normal(scale=0.01, size=(FRAMES, 4, 3)), axis=0),
        rng.random((FRAMES, 4)) < 0.7,
    )
    turn = rotation.yaw(0.8)
    steps = foot_contact.root_steps(points, stands)
    turned = foot_contact.root_steps(rotation.rotate(turn, points), stands)
    assert turned == pytest.approx(rotation.rotate(turn, steps), abs=1e-9)


def test_feet_are_held_where_they_are_outside_the_window() -> None:
    points = sliding([[0.002, 0.0, 0.0]] * 4)
    stands = np.zeros((FRAMES, 4), dtype=bool)
    stands[:9, 0] = stands[14:, 1] = stands[6:11, 2] = True
    places, is_held = foot_contact.footholds(points, stands)
    assert np.array_equal(is_held, stands)
    assert places[:9, 0] == pytest.approx(np.tile(points[1, 0], (9, 1)))
    assert places[14:, 1] == pytest.approx(np.tile(points[-2, 1], (10, 1)))
    assert places[6:11, 2] == pytest.approx(np.tile(points[8, 2], (5, 1)))
    assert np.array_equal(places[~stands], points[~stands])


def test_a_foot_that_stands_in_two_places_steps() -> None:
    points = sliding([[0.01, 0.0, 0.0]] * 4)
    stands = np.ones((FRAMES, 4), dtype=bool)
    places, is_held = foot_contact.footholds(points, stands)
    assert is_held.all()
    ball = places[:, LEFT_BALL]
    assert ball[:5] == pytest.approx(np.tile(points[1, LEFT_BALL], (5, 1)))
    assert ball[-5:] == pytest.approx(np.tile(points[-2, LEFT_BALL], (5, 1)))
    length = points[-2, LEFT_BALL, 0] - points[1, LEFT_BALL, 0]
    assert 0.25 * length < ball[:, 1].max() <= 0.3 * length


def test_a_foot_that_is_carried_far_away_is_let_go() -> None:
    points = sliding([[0.02, 0.0, 0.0]] * 4)
    stands = np.zeros((FRAMES, 4), dtype=bool)
    stands[:20] = True
    _, is_held = foot_contact.footholds(points, stands)
    assert is_held[:8].all()
    assert not is_held[10:].any()
