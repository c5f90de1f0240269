"""What one file of takes became, kept under the digest of all that it depends on.

A library is an index over shards. Since a shard is named by what it was made from, a build makes only those
that are not there yet: a new take rewrites nothing, and an interrupted build goes on where it was.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from studykit.core import durable
from studykit.core.errors import InputError
from studykit.core.provenance import canonical_json, sha256_of_file, sha256_of_value, versions
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


def is_part(path: Path) -> bool:
    """Tell whether this is a file of a shard, whole or not."""
    return re.fullmatch(r"\.?[0-9a-f]{32}(\.small)?\.(npy|json)(\.\d+\.partial)?", path.name) is not None


def told(library: Path, key: str) -> dict[str, Any]:
    """Read what became of the takes of a shard that is in use."""
    said: dict[str, Any] = json.loads(outcome_path(library, key).read_text(encoding="utf-8"))
    return said


def outcome(library: Path, key: str) -> dict[str, Any] | None:
    """Give what became of the takes of a shard, or None if it is not there or not what was written."""
    try:
        said = told(library, key)
        whole = all(sha256_of_file(library / FOLDER / name) == sha for name, sha in said["sha256"].items())
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None
    return said if whole else None


def basis(take: Take) -> str:
    """Tell one reading of a take from another, by file, rate and frames skipped: 12 hexadecimal digits."""
    motion = take.motion
    return sha256_of_value([take.source.sha256, round(motion.frame_rate_hz, 9), len(motion)])[:12]


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
    files: list[Path] = []
    if any(len(one.starts_s) for _, one in takes):
        for path, row in ((large_path(library, key), _LARGE_ROW), (small_path(library, key), _SMALL_ROW)):
            rows = np.zeros(sum(len(one.starts_s) for _, one in takes), dtype=row)
            for name in row.names or ():
                rows[name] = np.concatenate([one.arrays[name] for _, one in takes])
            durable.put_array(path, rows)
            files.append(path)
    said = {
        "sizes": {path.name: path.stat().st_size for path in files},
        "sha256": {path.name: sha256_of_file(path) for path in files},
        "versions": versions(),
        "takes": [
            {
                "name": take.name,
                "basis": basis(take),
                "source": asdict(take.source),
                "starts_s": one.starts_s.tolist(),
                "is_mirrored": one.is_mirrored.tolist(),
                "outcome": one.outcome,
                "findings": one.findings,
            }
            for take, one in takes
        ],
    }
    durable.put(outcome_path(library, key), canonical_json(said))
    return told(library, key)


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
        numbers = np.arange(len(self))[rows if isinstance(rows, slice) else _integers(rows)]
        wanted = np.atleast_1d(numbers)
        if wanted.ndim > 1:
            raise IndexError("rows are asked for by one number, several in a row, or a slice")
        out = np.empty((len(wanted), *self.shape[1:]), dtype=self.dtype)
        shards = np.searchsorted(self._ends, wanted, side="right")
        for shard in np.unique(shards):
            here = shards == shard
            before = self._ends[shard - 1] if shard else 0
            out[here] = self._file(int(shard))[self._name][wanted[here] - before]
        return out if np.ndim(numbers) else out[0]

    def _file(self, shard: int) -> Any:
        try:
            return _mapped(large_path(self._library, self._keys[shard]))
        except FileNotFoundError as error:
            remedy = "open it again"
            raise InputError("was built again meanwhile", where=self._library, remedy=remedy) from error


def _integers(rows: Any) -> Any:
    asked = np.asarray(rows)
    return asked if asked.size else asked.astype(np.int64)
