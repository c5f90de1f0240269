"""Text files, plain or packed."""

from __future__ import annotations

import gzip
import lzma
import zlib
from pathlib import Path

from studykit.core.errors import InputError

PACKED = (".xz", ".gz")


def read_text(path: Path) -> str:
    """Read a text file; one that ends in .xz or .gz is unpacked on the way.

    Raises
    ------
    InputError
        If the file cannot be read, is not what its ending says, or is not text.
    """
    try:
        data = path.read_bytes()
        if path.suffix == ".xz":
            data = lzma.decompress(data)
        elif path.suffix == ".gz":
            data = gzip.decompress(data)
    except (lzma.LZMAError, gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise InputError(
            f"broken {path.suffix} file ({error})", where=path, remedy="copy it again"
        ) from error
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"cannot be read ({reason})", where=path, remedy="check the path and its rights"
        ) from error
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")
