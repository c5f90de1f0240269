"""What one file of takes became, kept under the digest of all that it depends on.

A library is an index over shards. Since a shard is named by what it was made from, a build makes only those
that are not there yet: a new take rewrites nothing, and an interrupted build goes on where it was.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from studykit.core.provenance import canonical_json, sha256_of_file
from studykit.io.datasets.take import Take
from studykit.library.measure import LARGE, SMALL, Measured

FOLDER = "takes"
_LARGE_ROW = np.dtype([(name, form, shape) for name, (shape, form) in LARGE.items()])
_SMALL_ROW = np.dtype([(name, form, shape) for name, (shape, form) in SMALL.items()])


def large_path(library: Path, key: str) -> Path:
    """Name the file with the movement and features of a shard's segments."""
    return library / FOLDER / f"{key}.npy"


def small_path(library: Path, key: str) -> Path:
    """Name the file with the energies and boundary poses of a shard's segments."""
    return library / FOLDER / f"{key}.small.npy"


def outcome_path(library: Path, key: str) -> Path:
    """Name the file that says what became of the takes; written last, so that what has one is whole."""
    return library / FOLDER / f"{key}.json"


def outcome(library: Path, key: str) -> dict[str, Any] | None:
    """Give what became of the takes of a shard, or None if it is not there, or not whole."""
    try:
        told: dict[str, Any] = json.loads(outcome_path(library, key).read_text(encoding="utf-8"))
        whole = all((library / FOLDER / name).stat().st_size == size for name, size in told["sizes"].items())
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None
    return told if whole else None


def write(library: Path, key: str, takes: Sequence[tuple[Take, Measured]]) -> dict[str, Any]:
    """Write a shard and give what became of its takes.

    Parameters
    ----------
    library : Path
        The folder of the library.
    key : str
        Digest of all that the shard depends on.
    takes : sequence of (Take, Measured)
        The dancers of one file and their segments.
    """
    (library / FOLDER).mkdir(parents=True, exist_ok=True)
    files: list[Path] = []
    if any(len(one.starts_s) for _, one in takes):
        for path, row in ((large_path(library, key), _LARGE_ROW), (small_path(library, key), _SMALL_ROW)):
            rows = np.zeros(sum(len(one.starts_s) for _, one in takes), dtype=row)
            for name in row.names or ():
                rows[name] = np.concatenate([one.arrays[name] for _, one in takes])
            _replace(path, rows)
            files.append(path)
    told = {
        "sizes": {path.name: path.stat().st_size for path in files},
        "sha256": {path.name: sha256_of_file(path) for path in files},
        "takes": [
            {
                "name": take.name,
                "source": asdict(take.source),
                "starts_s": one.starts_s.tolist(),
                "is_mirrored": one.is_mirrored.tolist(),
                "outcome": one.outcome,
                "findings": one.findings,
            }
            for take, one in takes
        ],
    }
    _replace(outcome_path(library, key), canonical_json(told).encode())
    loaded: dict[str, Any] = json.loads(canonical_json(told))
    return loaded


def _replace(path: Path, content: Any) -> None:
    """Write a file under a name of this process, then give it its own: it is whole or not there."""
    partial = path.with_name(f"{path.name}.{os.getpid()}.partial")
    with partial.open("wb") as file:
        if isinstance(content, bytes):
            file.write(content)
        else:
            np.save(file, content, allow_pickle=False)
        file.flush()
        os.fsync(file.fileno())
    partial.replace(path)


@lru_cache(maxsize=256)
def _mapped(path: Path) -> Any:
    return np.load(path, mmap_mode="r", allow_pickle=False)


class SegmentRows:
    """One array over all segments of a library, of which only the rows asked for are read from disk.

    Parameters
    ----------
    library : Path
        The folder of the library.
    name : str
        Which of the large arrays.
    keys : sequence of str
        The shards, in the order of the segments.
    counts : sequence of int
        How many segments each has.
    """

    def __init__(self, library: Path, name: str, keys: Sequence[str], counts: Sequence[int]) -> None:
        self._library, self._name, self._keys = library, name, keys
        self._ends = np.cumsum(np.asarray(counts, dtype=np.int64))
        shape, form = LARGE[name]
        self.dtype = np.dtype(form)
        self.shape = (int(self._ends[-1]) if len(self._ends) else 0, *shape)

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, rows: int | slice | Sequence[int] | np.ndarray[Any, Any]) -> Any:
        """Read rows: one for an integer, else a copy of several in the order asked for."""
        numbers = np.arange(len(self))[np.asarray(rows) if not isinstance(rows, slice) else rows]
        wanted = np.atleast_1d(numbers)
        out = np.empty((len(wanted), *self.shape[1:]), dtype=self.dtype)
        shards = np.searchsorted(self._ends, wanted, side="right")
        for shard in np.unique(shards):
            here = shards == shard
            before = self._ends[shard - 1] if shard else 0
            out[here] = self._file(int(shard))[self._name][wanted[here] - before]
        return out if np.ndim(numbers) else out[0]

    def _file(self, shard: int) -> Any:
        return _mapped(large_path(self._library, self._keys[shard]))
