"""Where a result comes from: digests of its inputs and versions of its tools."""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Iterable
from importlib.metadata import version
from pathlib import Path
from typing import Any


def canonical_json(value: Any) -> str:
    """Write plain values as JSON that is the same, byte for byte, for equal values."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)


def sha256_of_bytes(data: bytes) -> str:
    """Give the SHA-256 digest of bytes, as 64 hexadecimal digits."""
    return hashlib.sha256(data).hexdigest()


def sha256_of_value(value: Any) -> str:
    """Give the SHA-256 digest of plain values, through their canonical JSON."""
    return sha256_of_bytes(canonical_json(value).encode())


def sha256_of_file(path: Path) -> str:
    """Give the SHA-256 digest of a file, read in pieces."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def sha256_of_files(paths: Iterable[Path]) -> str:
    """Give one digest for several files, in the order given."""
    return sha256_of_value([sha256_of_file(path) for path in paths])


def versions() -> dict[str, str]:
    """Name the versions on which numbers depend."""
    packages = ("studykit", "numpy", "scipy", "pandas", "statsmodels", "pingouin", "numba")
    return {"python": platform.python_version()} | {package: version(package) for package in packages}
