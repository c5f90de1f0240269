"""NumPy's own files, .npy and .npz: read without pickle and never further than the file goes."""

from __future__ import annotations

import io
import math
import struct
import tokenize
import warnings
import zlib
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from studykit.core.errors import InputError
from studykit.io.packed import most_unpacked, read_bytes

LARGEST_BYTES = 170 * 2**20
"""Twenty million numbers and some; what holds more is no take."""

_FAULTS = (
    ArithmeticError,
    BadZipFile,
    EOFError,
    LookupError,
    MemoryError,
    NotImplementedError,
    OSError,
    RecursionError,
    RuntimeError,
    SyntaxError,
    TypeError,
    ValueError,
    struct.error,
    tokenize.TokenError,
    zlib.error,
)


def read_npy(path: Path) -> NDArray[Any]:
    """Read a .npy file, plain or packed (.xz, .gz).

    Raises
    ------
    InputError
        If it is broken, or holds objects instead of numbers or text.
    """
    data = read_bytes(path, largest_bytes=LARGEST_BYTES)
    try:
        return _array(data)
    except _FAULTS as error:
        raise _broken(path, error) from error


class _ObjectsError(ValueError):
    """An array holds objects, which only unpickling could read."""


def read_npz(
    path: Path, names: tuple[str, ...], *, dispensable: tuple[str, ...] = ()
) -> dict[str, NDArray[Any]]:
    """Read those of the named arrays that an .npz file has; the others are not touched.

    Parameters
    ----------
    path : Path
        The file, plain or packed (.xz, .gz).
    names : tuple of str
        What to read.
    dispensable : tuple of str
        What to read, and to leave out where it holds objects.

    Raises
    ------
    InputError
        If it is broken, or an array unpacks to more than any recording has.
    """
    data = read_bytes(path, largest_bytes=LARGEST_BYTES)
    arrays: dict[str, NDArray[Any]] = {}
    left = LARGEST_BYTES
    try:
        with ZipFile(io.BytesIO(data)) as archive:
            there = set(archive.namelist())
            for name in (*names, *dispensable):
                if f"{name}.npy" not in there:
                    continue
                try:
                    arrays[name] = _array(_member(archive, f"{name}.npy", left))
                except _ObjectsError:
                    if name not in dispensable:
                        raise
                    continue
                left -= arrays[name].nbytes
    except _FAULTS as error:
        raise _broken(path, error) from error
    return arrays


def names_in(path: Path) -> set[str]:
    """Name the arrays of a plain .npz file without unpacking any; none if it is no such file."""
    try:
        with path.open("rb") as file, ZipFile(file) as archive:
            return {name.removesuffix(".npy") for name in archive.namelist()}
    except _FAULTS:
        return set()


def _member(archive: ZipFile, name: str, most: int) -> bytes:
    """Unpack one file; what is read ends where the archive says, so a size that lies fails the checksum."""
    info = archive.getinfo(name)
    if info.file_size > most:
        raise ValueError(f"it unpacks to more than {LARGEST_BYTES / 2**20:.0f} MiB")
    if info.file_size > most_unpacked(info.compress_size):
        raise ValueError(f"it unpacks to {info.file_size / 2**20:.0f} MiB, which no recording does")
    if info.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
        raise ValueError("it is packed as NumPy never does")
    return archive.read(info)


def _broken(path: Path, error: BaseException) -> InputError:
    reason = " ".join(str(error).split())[:120] or type(error).__name__
    return InputError(f"broken file of arrays ({reason})", where=path, remedy="copy it again")


def _array(data: bytes) -> NDArray[Any]:
    """Take the array out of a .npy file after checking that the file holds what its header promises."""
    file = io.BytesIO(data)
    version = npy.read_magic(file)
    readers = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
    if version not in readers:
        raise ValueError(f"version {version} of the format is not known")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about headers of Python 2
        shape, by_column, dtype = readers[version](file)
    if dtype.kind not in "biufcSU" or dtype.itemsize == 0:
        raise _ObjectsError("it holds objects, not numbers or text")
    if len(shape) > 32 or not all(type(length) is int and 0 <= length < 2**40 for length in shape):
        raise ValueError("it has no shape")
    there = len(data) - file.tell()
    if math.prod(shape) * dtype.itemsize != there:
        raise ValueError(f"it promises the shape {shape} and has {there} bytes")
    flat = np.frombuffer(data, dtype=dtype, offset=file.tell()) if there else np.zeros(0, dtype=dtype)
    return flat.reshape(shape, order="F" if by_column else "C")
