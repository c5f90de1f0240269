"""What a player is given, checked and brought into the form in which it crosses to the browser."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from studykit.core.errors import InputError

MARK_KINDS: Final = ("flag", "keep", "cut", "note")
"""What a mark on the line of time can mean; each has its colour and pattern."""
SHOWN_RATE_HZ: Final = 60.0
"""No screen shows more pictures a second, so faster recordings are thinned to at most this many."""

Poses = NDArray[np.float32]
"""Joint positions, shape (frame, joint, 3), m, little-endian 32-bit: the form that crosses to the browser."""
Mark = tuple[float, float, str, str]
"""Start, s; stop, s; label; kind."""


def poses(values: Any, joints: int) -> Poses:
    """Check joint positions and give them as they cross to the browser.

    Parameters
    ----------
    values : array_like, shape (frame, joint, 3), m
        Right-handed, Y up, the floor at 0.
    joints : int
        How many joints the body has.

    Raises
    ------
    InputError
        If the shape is another or a number is not finite.

    Examples
    --------
    >>> poses([[[0.0, 1.0, 0.0]]], 1).dtype.str, poses([[[0.0, 1.0, 0.0]]], 1).nbytes
    ('<f4', 12)
    """
    try:
        given = np.asarray(values)
    except ValueError as error:
        raise _unusable("are no table of numbers", joints) from error
    if given.dtype.kind not in "fiu":
        raise _unusable("are no table of numbers", joints)
    with np.errstate(over="ignore"):
        array = np.array(given, dtype="<f4", order="C")
    if array.ndim != 3 or array.shape[1:] != (joints, 3):
        raise _unusable(f"have the shape {array.shape}", joints)
    if not np.isfinite(array).all():
        raise _unusable("have places that are no numbers or too far away", joints)
    array.flags.writeable = False
    return array


def _unusable(problem: str, joints: int) -> InputError:
    return InputError(
        f"the positions {problem}",
        where="positions",
        remedy=f"give finite metres of the shape (frame, {joints}, 3)",
    )


def joint_values(values: Any, joints: int) -> list[float]:
    """Check one value a joint, 0 or more; an empty list says that there are none.

    Raises
    ------
    InputError
        If there are more or fewer, or one is negative or not finite.
    """
    try:
        array = np.array([] if values is None else values, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.full(1, np.nan)
    if array.size and (array.shape != (joints,) or not np.isfinite(array).all() or array.min() < 0.0):
        raise InputError(
            "the values are not one finite number a joint, 0 or more",
            where="joint_values",
            remedy=f"give {joints} of them, or none",
        )
    return [float(value) for value in array]


def marks(values: Sequence[Any]) -> list[Mark]:
    """Check the marks of a line of time and put them in the order of their starts.

    Parameters
    ----------
    values : sequence of (start_s, stop_s, label, kind)
        `kind` is one of `MARK_KINDS`; a mark of one frame may start and stop at the same time.

    Raises
    ------
    InputError
        Says which mark cannot be used.

    Examples
    --------
    >>> marks([(2, 2.5, "left_foot", "flag"), (0, 1, "whole body", "cut")])
    [(0.0, 1.0, 'whole body', 'cut'), (2.0, 2.5, 'left_foot', 'flag')]
    """
    return sorted(_mark(value, number) for number, value in enumerate(values, start=1))


def _mark(value: Any, number: int) -> Mark:
    try:
        start, stop, label, kind = value
        start, stop = float(start), float(stop)
        is_fine = 0.0 <= start <= stop < np.inf and isinstance(label, str) and kind in MARK_KINDS
    except (TypeError, ValueError):
        is_fine = False
    if not is_fine:
        raise InputError(
            f"mark {number} is {value!r}",
            where="marks",
            remedy=f"give (start_s, stop_s, label, kind) with 0 <= start <= stop and a kind of {MARK_KINDS}",
        )
    return start, stop, label, kind


def sides(joint_names: Sequence[str]) -> list[str]:
    """Say for each joint whether it is on the left, on the right or in the middle."""
    return [
        next((side for side in ("left", "right") if name.startswith(f"{side}_")), "middle")
        for name in joint_names
    ]


def thinned(positions: NDArray[Any], frame_rate_hz: float) -> tuple[NDArray[Any], float]:
    """Leave out frames that no screen would show: every n-th stays, and the rate becomes an n-th.

    Parameters
    ----------
    positions : ndarray, shape (frame, joint, 3), m
        One pose a frame.
    frame_rate_hz : float
        Frames a second.

    Examples
    --------
    >>> shown, rate_hz = thinned(np.zeros((500, 24, 3)), 250.0)
    >>> len(shown), rate_hz
    (100, 50.0)
    """
    every = max(int(np.ceil(frame_rate_hz / SHOWN_RATE_HZ - 1e-6)), 1)
    return positions[::every], frame_rate_hz / every
