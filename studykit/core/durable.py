"""Files that are there whole or not at all, whatever happens while they are written."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any


def put(path: Path, content: bytes | str) -> None:
    """Put a file in its place at one stroke; until then the older one stays.

    The content is on the disk before the file has its name, so that a power cut leaves one or the other.

    Parameters
    ----------
    path : Path
        The file; its folder is made.
    content : bytes or str
        All of it; text is written as UTF-8.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")  # hidden from who lists the folder
    try:
        with partial.open("wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise


def put_array(path: Path, array: Any) -> None:
    """Put a .npy file in its place at one stroke; see `put`."""
    import io

    import numpy as np

    buffer = io.BytesIO()
    np.save(buffer, array, allow_pickle=False)
    put(path, buffer.getvalue())


def settle(folder: Path) -> None:
    """Let all files of a folder, and their names, be on the disk before anything refers to them."""
    for path in folder.iterdir():
        with path.open("r+b") as file:
            os.fsync(file.fileno())
    if os.name == "posix":
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
