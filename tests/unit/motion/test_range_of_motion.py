from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studykit.motion import rotation
from studykit.motion.range_of_motion import range_of_motion


def hinges(amplitude_rad: float, *, bend_rad: float = 0.0, frames: int = 2000) -> np.ndarray:
    angle = bend_rad + amplitude_rad * np.sin(np.linspace(0.0, 40.0 * np.pi, frames))
    return rotation.exp(angle[:, None, None] * np.array([[0.0, 0.0, 1.0]]))


@pytest.mark.parametrize("amplitude_rad", [0.01, 0.3, 1.2])
@pytest.mark.parametrize("bend_rad", [0.0, 1.0, 3.0])
def test_a_hinge_turns_through_twice_its_amplitude(amplitude_rad: float, bend_rad: float) -> None:
    # The middle 95 % of a sine wave reach to sin(0.95 pi / 2).
    expected = 2.0 * amplitude_rad * np.sin(0.475 * np.pi)
    assert range_of_motion(hinges(amplitude_rad, bend_rad=bend_rad))[0] == pytest.approx(expected, rel=0.01)


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**32 - 1))
def test_how_a_joint_rests_and_the_sign_of_its_quaternions_do_not_count(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turns = rotation.exp(np.cumsum(rng.normal(0.0, 0.05, size=(200, 3, 3)), axis=0))
    signs = rng.choice([-1.0, 1.0], size=(200, 3, 1))
    rest = rotation.exp(rng.normal(size=(3, 3)))
    np.testing.assert_allclose(
        range_of_motion(rotation.multiply(rest, turns) * signs), range_of_motion(turns), atol=1e-9
    )


def test_a_joint_that_keeps_still_and_a_single_wrong_frame_have_no_range() -> None:
    turns = rotation.identity(200, 2)
    turns[77, 1] = rotation.exp(np.array([2.0, 0.0, 0.0]))
    np.testing.assert_allclose(range_of_motion(turns), 0.0, atol=1e-9)
