"""What must hold of any rotation."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from studykit.motion import rotation

RELATIVE = 1e-9


def unit_axes(draw_from: st.DataObject) -> np.ndarray:
    raw = draw_from.draw(
        arrays(np.float64, 3, elements=st.floats(-1.0, 1.0)).filter(lambda v: np.linalg.norm(v) > 0.1)
    )
    return raw / np.linalg.norm(raw)


# Angles of every size, from a trillionth of a radian to a billionth short of half a turn.
ANGLES = st.one_of(
    st.floats(-12.0, 0.0).map(lambda power: 10.0**power),
    st.floats(-9.0, 0.0).map(lambda power: np.pi - 10.0**power),
)


@given(data=st.data(), angle=ANGLES)
@settings(max_examples=300, deadline=None)
def test_log_undoes_exp_for_every_size_of_angle(data, angle: float) -> None:
    vector = unit_axes(data) * angle
    back = rotation.log(rotation.exp(vector))
    assert np.linalg.norm(back - vector) <= RELATIVE * angle


def textbook_log(matrix: np.ndarray) -> np.ndarray:
    """Wrong: the angle by an arc cosine of the trace, the axis by dividing by its sine."""
    angle = np.arccos(np.clip((np.trace(matrix) - 1.0) / 2.0, -1.0, 1.0))
    skew = (matrix - matrix.T) / (2.0 * max(np.sin(angle), 1e-300))
    return np.array([skew[2, 1], skew[0, 2], skew[1, 0]]) * angle


@pytest.mark.parametrize("angle", [1e-12, 1e-9, np.pi - 1e-9])
def test_the_textbook_log_would_be_noticed(angle: float) -> None:
    vector = np.array([0.6, 0.0, 0.8]) * angle
    wrong = textbook_log(rotation.to_matrix(rotation.exp(vector)))
    assert np.linalg.norm(wrong - vector) > RELATIVE * angle


@pytest.mark.parametrize("angle", [1e-12, 1e-6, 1.0, np.pi - 1e-6, np.pi - 1e-9])
def test_log_has_the_angle_of_a_turn_about_a_known_axis(angle: float) -> None:
    quaternion = np.array([np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0])
    assert rotation.log(quaternion) == pytest.approx([0.0, angle, 0.0], rel=RELATIVE)
    assert rotation.log(-quaternion) == pytest.approx([0.0, angle, 0.0], rel=RELATIVE)  # the same rotation


@given(data=st.data(), angle=st.floats(0.01, 3.0), share=st.floats(0.0, 1.0))
@settings(deadline=None)
def test_slerp_goes_at_a_constant_speed(data, angle: float, share: float) -> None:
    start = rotation.exp(unit_axes(data) * 2.0)
    axis = unit_axes(data)
    end = rotation.multiply(start, rotation.exp(axis * angle))
    there = rotation.slerp(start, end, np.array(share))
    assert np.linalg.norm(there) == pytest.approx(1.0, abs=1e-12)
    assert rotation.between(start, there) == pytest.approx(axis * angle * share, abs=1e-9)
    assert rotation.between(there, end) == pytest.approx(axis * angle * (1.0 - share), abs=1e-9)


@given(data=st.data(), angle=st.floats(0.01, 3.0))
@settings(deadline=None)
def test_slerp_takes_the_short_way_whatever_the_signs(data, angle: float) -> None:
    start = rotation.exp(unit_axes(data))
    end = rotation.multiply(start, rotation.exp(unit_axes(data) * angle))
    steps = np.linspace(0.0, 1.0, 11)
    way = rotation.slerp(start, end, steps)
    other = rotation.slerp(start, -end, steps)
    assert np.abs(np.sum(way * other, axis=-1)) == pytest.approx(np.ones(11), abs=1e-12)


@given(seed=st.integers(0, 10_000))
@settings(deadline=None)
def test_products_and_turns_agree_with_matrices(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first, second = Rotation.random(2, rng=rng).as_quat(scalar_first=True)
    vectors = rng.normal(size=(5, 3))
    a, b = rotation.to_matrix(first), rotation.to_matrix(second)
    product = rotation.multiply(first, second)
    assert rotation.to_matrix(product) == pytest.approx(a @ b, abs=1e-12)
    assert rotation.rotate(product, vectors) == pytest.approx(vectors @ (a @ b).T, abs=1e-12)
    assert rotation.to_matrix(rotation.inverse(first)) == pytest.approx(a.T, abs=1e-12)
    # the wrong order would be noticed
    assert np.abs(rotation.to_matrix(rotation.multiply(second, first)) - a @ b).max() > 1e-6


@given(seed=st.integers(0, 10_000), order=st.sampled_from(["ZXY", "ZYX", "XYZ", "YZX", "XZY", "YXZ"]))
@settings(deadline=None)
def test_matrices_and_euler_angles_give_the_rotation_back(seed: int, order: str) -> None:
    quaternions = Rotation.random(7, rng=np.random.default_rng(seed)).as_quat(scalar_first=True)
    for back in (
        rotation.from_matrix(rotation.to_matrix(quaternions)),
        rotation.from_euler(order, rotation.to_euler(order, quaternions)),
    ):
        assert np.abs(np.sum(back * quaternions, axis=-1)) == pytest.approx(np.ones(7), abs=1e-9)


def test_euler_angles_are_about_moving_axes_in_the_order_listed() -> None:
    z, x, y = 0.3, -0.5, 0.7
    one_by_one = rotation.multiply(
        rotation.exp(np.array([0.0, 0.0, z])),
        rotation.multiply(rotation.exp(np.array([x, 0.0, 0.0])), rotation.exp(np.array([0.0, y, 0.0]))),
    )
    assert rotation.from_euler("ZXY", np.array([z, x, y])) == pytest.approx(one_by_one, abs=1e-12)
    assert rotation.from_euler("YXZ", np.array([y, x, z])) != pytest.approx(one_by_one, abs=1e-3)
