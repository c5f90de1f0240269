"""Arrays with a meaning: their types, and the checks that every container makes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
"""Numbers; the docstring beside each use gives the shape and the unit."""
Integers = NDArray[np.int64]
Booleans = NDArray[np.bool_]


def frozen(values: Any, *, shape: tuple[int | None, ...], name: str) -> Floats:
    """Give a read-only copy of numbers after checking their shape.

    Parameters
    ----------
    values : array_like
        The numbers.
    shape : tuple of int or None
        The shape expected; None stands for any length.
    name : str
        What the numbers are, for the error.

    Raises
    ------
    ValueError
        If the shape differs.
    """
    array = np.array(values, dtype=np.float64)
    if array.ndim != len(shape) or any(
        want is not None and have != want for have, want in zip(array.shape, shape, strict=True)
    ):
        wanted = ", ".join("any" if want is None else str(want) for want in shape)
        raise ValueError(f"{name} has the shape {array.shape}, expected ({wanted})")
    array.flags.writeable = False
    return array
