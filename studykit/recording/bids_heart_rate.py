"""The heart rate of a session, from the physiological recordings of a BIDS data set."""

from __future__ import annotations

import gzip
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.recording import bids_lookup

_NAMES = ("heart_rate", "heartrate", "hr", "pulse_rate")


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HeartRate:
    """Readings of a session, shape (reading,), s on its clock and beats/min, and what measured them."""

    times_s: Floats
    bpm: Floats
    device: str


def heart_rate(folder: Path, root: Path, zero_s: Callable[[Path], float]) -> HeartRate:
    """Read all heart rates of a session; there may be none.

    A file counts if its JSON names a column heart_rate (or hr, pulse_rate), in beats a minute.

    Parameters
    ----------
    folder : Path
        Where the files ``*_physio.tsv.gz`` lie.
    root : Path
        The data set.
    zero_s : callable
        Gives when the recording that a file accompanies began, s on the session's clock.

    Raises
    ------
    InputError
        If a file is broken, or its JSON does not tell columns and rate.
    """
    times: list[Floats] = []
    bpm: list[Floats] = []
    device = "not told"
    for path in sorted(folder.glob("*_physio.tsv.gz")):
        told = bids_lookup.description(path, root, "physio.json")
        columns = [str(name).lower() for name in told.get("Columns", [])]
        column = next((columns.index(name) for name in _NAMES if name in columns), None)
        if column is None:
            if not columns:
                raise InputError(
                    "its columns are not told", where=path, remedy="name them in Columns of its JSON"
                )
            continue
        rate_hz = told.get("SamplingFrequency")
        if not isinstance(rate_hz, int | float) or not rate_hz > 0.0:
            raise InputError(
                "its SamplingFrequency is not told",
                where=path,
                remedy="write it in its JSON, in samples a second",
            )
        values = _column(path, column, len(columns))
        begin_s = zero_s(path) + float(told.get("StartTime") or 0.0)
        is_reading = np.isfinite(values)
        times.append((begin_s + np.arange(len(values)) / rate_hz)[is_reading])
        bpm.append(values[is_reading])
        device = str(told.get("ManufacturersModelName") or told.get("Manufacturer") or device)
    everything = np.concatenate([np.empty(0), *times])
    order = np.argsort(everything, kind="stable")
    return HeartRate(times_s=everything[order], bpm=np.concatenate([np.empty(0), *bpm])[order], device=device)


def _column(path: Path, column: int, columns: int) -> Floats:
    try:
        lines = gzip.decompress(path.read_bytes()).decode().replace("n/a", "nan").splitlines()
        values = np.loadtxt(lines, delimiter="\t", ndmin=2) if lines else np.empty((0, columns))
    except (OSError, EOFError, ValueError) as error:
        raise InputError(
            f"it is no packed table of numbers ({error})", where=path, remedy="export it again"
        ) from error
    if values.shape[1] != columns:
        raise InputError(
            f"it has {values.shape[1]} columns, but its JSON names {columns}",
            where=path,
            remedy="name every column in Columns",
        )
    return np.asarray(values[:, column])
