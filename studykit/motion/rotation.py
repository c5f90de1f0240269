"""Rotations as unit quaternions, scalar first, in arrays of shape (..., 4)."""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from studykit.core.arrays import Floats


def _scipy(quaternions: Floats) -> Rotation:
    return Rotation.from_quat(quaternions.reshape(-1, 4), scalar_first=True)


def identity(*shape: int) -> Floats:
    """Give rotations that leave everything where it is, shape (*shape, 4)."""
    quaternions = np.zeros((*shape, 4))
    quaternions[..., 0] = 1.0
    return quaternions


def multiply(first: Floats, second: Floats) -> Floats:
    """Turn by `second`, then by `first` (as matrices: first @ second).

    Parameters
    ----------
    first, second : ndarray, shape (..., 4)
        Unit quaternions, scalar first.
    """
    a, b, c, d = (first[..., n] for n in range(4))
    w, x, y, z = (second[..., n] for n in range(4))
    product = np.empty(np.broadcast_shapes(first.shape, second.shape))
    product[..., 0] = a * w - b * x - c * y - d * z
    product[..., 1] = a * x + b * w + c * z - d * y
    product[..., 2] = a * y - b * z + c * w + d * x
    product[..., 3] = a * z + b * y - c * x + d * w
    return product


def inverse(quaternions: Floats) -> Floats:
    """Turn back: the inverse of each rotation, shape (..., 4)."""
    return np.asarray(quaternions * np.array([1.0, -1.0, -1.0, -1.0]))


def rotate(quaternions: Floats, vectors: Floats) -> Floats:
    """Turn vectors.

    Parameters
    ----------
    quaternions : ndarray, shape (..., 4)
        Unit quaternions, scalar first.
    vectors : ndarray, shape (..., 3)
        What is turned; leading axes broadcast.
    """
    # v + 2 w (u x v) + 2 u x (u x v), written out: np.cross takes four times as long on short arrays.
    w, x, y, z = (quaternions[..., n] for n in range(4))
    a, b, c = (vectors[..., n] for n in range(3))
    d, e, f = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    turned = np.empty((*np.broadcast_shapes(quaternions.shape[:-1], vectors.shape[:-1]), 3))
    turned[..., 0] = a + w * d + y * f - z * e
    turned[..., 1] = b + w * e + z * d - x * f
    turned[..., 2] = c + w * f + x * e - y * d
    return turned


def log(quaternions: Floats) -> Floats:
    """Give the rotation vectors (axis times angle, rad, at most pi long), shape (..., 3).

    Exact from angles of 1e-12 up to pi, where the textbook formula with an arc cosine fails.
    """
    return _scipy(quaternions).as_rotvec().reshape(*quaternions.shape[:-1], 3)


def exp(vectors: Floats) -> Floats:
    """Give the rotations of rotation vectors (axis times angle, rad), shape (..., 4).

    Examples
    --------
    >>> exp(np.array([0.0, np.pi, 0.0])).round(6).tolist()
    [0.0, 0.0, 1.0, 0.0]
    """
    quaternions = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_quat(scalar_first=True)
    return quaternions.reshape(*vectors.shape[:-1], 4)


def from_matrix(matrices: Floats) -> Floats:
    """Give the rotations of 3 x 3 matrices, shape (..., 4)."""
    quaternions = Rotation.from_matrix(matrices.reshape(-1, 3, 3)).as_quat(scalar_first=True)
    return quaternions.reshape(*matrices.shape[:-2], 4)


def to_matrix(quaternions: Floats) -> Floats:
    """Give rotations as 3 x 3 matrices, shape (..., 3, 3)."""
    return _scipy(quaternions).as_matrix().reshape(*quaternions.shape[:-1], 3, 3)


def from_euler(order: str, angles: Floats) -> Floats:
    """Give the rotations of Euler angles about moving axes.

    Parameters
    ----------
    order : str
        The axes in the order listed in the file, for example "ZXY".
    angles : ndarray, shape (..., 3), rad
        One angle an axis, in the same order.
    """
    quaternions = Rotation.from_euler(order.upper(), angles.reshape(-1, 3)).as_quat(scalar_first=True)
    return quaternions.reshape(*angles.shape[:-1], 4)


def to_euler(order: Literal["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"], quaternions: Floats) -> Floats:
    """Give Euler angles about moving axes, shape (..., 3), rad; see `from_euler`."""
    angles = _scipy(quaternions).as_euler(order, suppress_warnings=True)
    return np.asarray(angles).reshape(*quaternions.shape[:-1], 3)


def yaw(angle_rad: Floats | float) -> Floats:
    """Give turns about the vertical axis, shape (..., 4); positive turns +Z towards +X."""
    half = 0.5 * np.asarray(angle_rad, dtype=np.float64)
    zero = np.zeros_like(half)
    return np.stack((np.cos(half), zero, np.sin(half), zero), axis=-1)


def between(start: Floats, end: Floats) -> Floats:
    """Give the rotation vectors that lead from `start` to `end`, shape (..., 3), rad: log(start^-1 end)."""
    return log(multiply(inverse(start), end))


def slerp(start: Floats, end: Floats, share: Floats) -> Floats:
    """Go along the shortest arc from one rotation to another (Grassia 1998).

    Parameters
    ----------
    start, end : ndarray, shape (..., 4)
        Unit quaternions.
    share : ndarray, broadcastable to the leading axes
        0 at `start`, 1 at `end`.
    """
    return multiply(start, exp(np.asarray(share)[..., None] * between(start, end)))
