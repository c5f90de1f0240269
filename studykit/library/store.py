"""A dance library as a folder: an index table, arrays and a manifest."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any
from zipfile import BadZipFile

import numpy as np

from studykit.choreography.dance_library import Calibration, DanceLibrary
from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_files
from studykit.motion.features import FeatureScaler

VERSION = 1
ARRAYS = (
    "rotations",
    "root_positions",
    "features",
    "linear_energies",
    "rotational_energies",
    "first_poses",
    "last_poses",
)
"""One .npy file each, one row a segment."""

_MAPPED = ("rotations", "root_positions", "features")
_SCALER = ("kinetic_medians", "means", "deviations")


class ArrayWriter:
    """Writes rows to a .npy file one after the other, so that no library has to fit in memory.

    Parameters
    ----------
    path : Path
        The file to make.
    row_shape : tuple of int
        Shape of one row.
    dtype : str
        Type of the numbers, such as "<f4".
    """

    def __init__(self, path: Path, row_shape: tuple[int, ...], dtype: str) -> None:
        self._row_shape, self._dtype, self._rows = row_shape, np.dtype(dtype), 0
        self._file: IO[bytes] = path.open("wb")
        self._header()

    def _header(self) -> None:
        # NumPy leaves room in the header for the first axis to grow, so it can be rewritten in place.
        self._file.seek(0)
        header = {"descr": self._dtype.str, "fortran_order": False, "shape": (self._rows, *self._row_shape)}
        np.lib.format.write_array_header_2_0(self._file, header)

    def append(self, rows: Any) -> None:
        """Add rows, shape (row, *row_shape)."""
        self._file.write(np.ascontiguousarray(rows, dtype=self._dtype).tobytes())
        self._rows += len(rows)

    def close(self) -> None:
        """Write the number of rows and close."""
        self._header()
        self._file.close()


@contextmanager
def new_folder(out: Path) -> Iterator[Path]:
    """Give a folder to work in that becomes `out` only when all went well.

    Raises
    ------
    InputError
        If `out` is there already or its place cannot be written.
    """
    if out.exists():
        raise InputError("there is something already", where=out, remedy="choose another folder or remove it")
    partial = out.with_name(out.name + ".partial")
    try:
        if partial.exists():
            shutil.rmtree(partial)
        partial.mkdir(parents=True)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"cannot be written ({reason})", where=out, remedy="choose another folder"
        ) from error
    try:
        yield partial
        partial.rename(out)
    except BaseException:
        shutil.rmtree(partial, ignore_errors=True)
        raise


def digest(folder: Path) -> str:
    """Give the digest of a library's content: its segments, all that is measured on them, its calibration."""
    names = ("segments.parquet", "calibration.npz", *(f"{name}.npy" for name in ARRAYS))
    return sha256_of_files(folder / name for name in names)


UNCALIBRATED = Calibration(**{name: np.zeros(0) for name in Calibration.array_names()}, median_distance=1.0)
"""Stands in for the calibration of a library that is being built."""


def write_calibration(folder: Path, scaler: FeatureScaler, calibration: Calibration) -> None:
    """Save how features are scaled and what is light, intense, varied and smooth."""
    arrays = {name: getattr(scaler, name) for name in _SCALER}
    arrays |= {name: getattr(calibration, name) for name in Calibration.array_names()}
    np.savez(folder / "calibration.npz", median_distance=calibration.median_distance, **arrays)


def read_manifest(folder: Path) -> dict[str, Any]:
    """Read what a library says of itself.

    Raises
    ------
    InputError
        If the folder is not a library of this version.
    """
    path = folder / "manifest.json"
    try:
        manifest: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        version = manifest["version"]
    except (OSError, ValueError, KeyError, TypeError):
        remedy = "build one with 'studykit library build' or 'studykit library sample'"
        raise InputError("not a dance library", where=folder, remedy=remedy) from None
    if version != VERSION:
        raise InputError(
            f"a library of version {version}, this studykit reads {VERSION}",
            where=path,
            remedy="build it again",
        )
    return manifest


def load(
    folder: Path, *, name: str, scaler: FeatureScaler, calibration: Calibration, sha256: str
) -> DanceLibrary:
    """Put a library together from the files of its segments and what is known of them."""
    import pandas as pd

    arrays = {
        # What the search looks at all the time is held; the large arrays are mapped.
        key: np.load(folder / f"{key}.npy", mmap_mode="r" if key in _MAPPED else None, allow_pickle=False)
        for key in ARRAYS
    }
    segments = pd.read_parquet(folder / "segments.parquet")
    if any(len(array) != len(segments) for array in arrays.values()):
        raise ValueError("arrays of different length")
    return DanceLibrary(
        name=name, segments=segments, scaler=scaler, calibration=calibration, sha256=sha256, **arrays
    )


def open_library(path: str | Path) -> DanceLibrary:
    """Open a dance library; its large arrays stay on disk until rows are used.

    Parameters
    ----------
    path : str or Path
        The folder that 'studykit library build' or 'sample' made.

    Raises
    ------
    InputError
        If the folder is not a library or one of its files is missing or broken.
    """
    folder = Path(path)
    manifest = read_manifest(folder)
    try:
        # NumPy leaves an archive that it cannot read open; a file of our own is closed.
        with (folder / "calibration.npz").open("rb") as file, np.load(file, allow_pickle=False) as saved:
            scaler = FeatureScaler(**{name: saved[name] for name in _SCALER})
            calibration = Calibration(
                median_distance=float(saved["median_distance"]),
                **{name: saved[name] for name in Calibration.array_names()},
            )
        return load(
            folder, name=manifest["name"], scaler=scaler, calibration=calibration, sha256=manifest["sha256"]
        )
    except (OSError, ValueError, EOFError, KeyError, BadZipFile) as error:
        raise InputError(f"broken library ({error})", where=folder, remedy="build it again") from error
