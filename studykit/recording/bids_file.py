"""Files of a BIDS data set: the same bytes for the same content, whole or not at all."""

from __future__ import annotations

import gzip
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from studykit.core import durable
from studykit.core.arrays import Floats
from studykit.recording.journal import unwritable

MISSING = "n/a"


def write(path: Path, content: bytes) -> None:
    """Write a derived file whole or not at all.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    try:
        durable.put(path, content)
    except OSError as error:
        raise unwritable(path.parent, error) from error


def description(content: Mapping[str, Any]) -> bytes:
    """Give a JSON file."""
    return (json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode()


def table(columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> bytes:
    r"""Give a tab-separated table with its header; None becomes n/a.

    Examples
    --------
    >>> table(["onset", "trial_type"], [[0.5, "rest"], [None, True]]).decode().splitlines()
    ['onset\ttrial_type', '0.5\trest', 'n/a\ttrue']
    """
    lines = ["\t".join(columns), *("\t".join(map(_cell, row)) for row in rows)]
    return ("\n".join(lines) + "\n").encode()


def samples(values: Floats, *, decimals: int = 4) -> bytes:
    r"""Give numbers as a tab-separated table without header; NaN becomes n/a.

    Parameters
    ----------
    values : ndarray, shape (sample, channel)
        The numbers.
    decimals : int, optional
        Digits after the point.

    Examples
    --------
    >>> samples(np.array([[1.00005, -0.00001], [np.nan, 2.0]])).decode().splitlines()
    ['1.0001\t0.0000', 'n/a\t2.0000']
    """
    text = io.BytesIO()
    rounded = np.round(values, decimals) + 0.0  # minus zero becomes zero
    np.savetxt(text, rounded, fmt=f"%.{decimals}f", delimiter="\t")
    return text.getvalue().replace(b"nan", MISSING.encode())


def compressed(content: bytes) -> bytes:
    """Give the content in gzip format, without the time of writing."""
    return gzip.compress(content, compresslevel=6, mtime=0)


def _cell(value: Any) -> str:
    if value is None:
        return MISSING
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{round(value, 4):.12g}"
    return str(value)
