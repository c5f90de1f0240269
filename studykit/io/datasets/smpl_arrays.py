"""Arrays of SMPL's parameters: checked number by number, then made into movements."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.io.packed import plain_name
from studykit.motion import rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import Skeleton

MOST_NUMBERS = 20_000_000
"""An hour of a body at 60 Hz has 16 million; what has more is no take."""
LARGEST_NUMBER = 1e6
"""No rotation in rad and no place in centimetres is beyond this."""


def plain_stem(path: Path) -> str:
    """Give the name of a file without its ending and that of its packing."""
    return plain_name(path).rsplit(".", 1)[0]


def part(values: Any, name: str, path: Path) -> Any:
    """Give what a file has under a name.

    Raises
    ------
    InputError
        If it has no such thing.
    """
    if not isinstance(values, Mapping):
        raise InputError(
            "holds no table of named arrays", where=path, remedy="check that it belongs to the data set"
        )
    if name not in values:
        raise InputError(f"has no array {name}", where=path, remedy="check that it belongs to the data set")
    return values[name]


def numbers(
    value: Any, name: str, path: Path, *, shape: tuple[int | None, ...], frame_axis: int = 0
) -> Floats:
    """Give an array as numbers after checking its shape and every number of it.

    Parameters
    ----------
    value : object
        What the file has.
    name : str
        What it is called there.
    path : Path
        The file, for the error.
    shape : tuple of int or None
        The shape expected; None stands for any length but zero.
    frame_axis : int
        Which axis counts the frames, for the error.

    Raises
    ------
    InputError
        If it is no array of numbers, has another shape, has no frames, or a number in it is not finite.
    """
    if (
        not isinstance(value, np.ndarray | np.number | float | int)
        or np.asarray(value).dtype.kind not in "iuf"
    ):
        raise InputError(f"{name} is no array of numbers", where=path, remedy="export the file again")
    array = np.asarray(value)
    fits = array.ndim == len(shape) and all(w in (None, h) for h, w in zip(array.shape, shape, strict=True))
    if not fits:
        wanted = ", ".join("any" if length is None else str(length) for length in shape)
        raise InputError(
            f"{name} has the shape {array.shape}, expected ({wanted})",
            where=path,
            remedy="check that it belongs to the data set",
        )
    if array.size == 0:
        raise InputError(f"{name} has no frames", where=path, remedy="export the file again")
    if array.size > MOST_NUMBERS:
        raise InputError(
            f"{name} has {array.size:,} numbers, more than any take", where=path, remedy="cut it into several"
        )
    with np.errstate(over="ignore"):  # long doubles beyond all doubles become infinite
        array = array.astype(np.float64)
    good = np.abs(array) <= LARGEST_NUMBER
    if not np.all(good):
        first = np.argwhere(~good)[0]
        bad = float(array[tuple(first)])
        place = f" in frame {first[frame_axis]}" if len(first) > frame_axis else ""
        problem = f"{name} has {bad:.3g}{place}"
        raise InputError(problem, where=path, remedy="export the file again, or leave it out")
    return array


def rotation_vectors(value: Any, name: str, path: Path) -> Floats:
    """Give rotation vectors of SMPL's 24 joints, stored flat or joint by joint; shape (frame, 24, 3), rad."""
    flat = isinstance(value, np.ndarray) and value.ndim == 2
    array = numbers(value, name, path, shape=(None, 72) if flat else (None, 24, 3))
    return array.reshape(len(array), 24, 3)


def positive(
    value: Any, name: str, path: Path, *, remedy: str = "export the file again, or leave it out"
) -> float:
    """Give one positive number, stored in whatever way.

    Raises
    ------
    InputError
        If it is not one positive number.
    """
    one = value.reshape(()) if isinstance(value, np.ndarray) and value.size == 1 else value
    number = float(numbers(one, name, path, shape=()))
    if not number > 0.0:
        raise InputError(f"{name} is {number:g}", where=path, remedy=remedy)
    return number


def rate_hz(value: Any, name: str, path: Path) -> float:
    """Give a frame rate, stored as one number in whatever way.

    Raises
    ------
    InputError
        If it is not one positive number.
    """
    return positive(value, name, path, remedy="give the true rate in the file")


def same_length(first: Floats, second: Floats, names: str, path: Path) -> None:
    """Check that two arrays have as many frames.

    Raises
    ------
    InputError
        If not; names both.
    """
    if len(first) != len(second):
        problem = f"{names} have {len(first)} and {len(second)} frames"
        raise InputError(problem, where=path, remedy="export the file again")


def movement(vectors: Floats, root_positions: Floats, *, rate: float, skeleton: Skeleton) -> Motion:
    """Make a movement of rotation vectors (frame, 24, 3), rad, and pelvis positions (frame, 3), m, Y up."""
    return Motion(
        skeleton=skeleton,
        rotations=rotation.exp(vectors),
        root_positions=root_positions,
        frame_rate_hz=rate,
    )
