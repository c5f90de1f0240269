"""Files, plain or packed, of bounded size."""

from __future__ import annotations

import gzip
import lzma
import zlib
from pathlib import Path
from typing import Any

from studykit.core.errors import InputError

PACKED = (".xz", ".gz")
LARGEST_BYTES = 2**30
"""No take is larger than this (an hour at 120 Hz as text); what unpacks to more is not a take."""

MOST_LINES = 2_000_000
"""No take with a line a frame has more (an hour at 120 Hz has 432 thousand)."""

SMALL_BYTES = 2**21
MOST_UNPACKED = 100
"""How often a recording may hold its packed size once it is not small; real ones hold it up to ten times."""

_LINE_ENDS = ("\n", "\r", "\v", "\f", "\x1c", "\x1d", "\x1e", "\x85", "\u2028", "\u2029")
_ENDS_OF_OLD = "\x1a\0"
# The end of a text as CP/M and DOS wrote it, or what filled its last block.

LEFT_BESIDE = "._"
"""How the names of the files begin that macOS leaves beside others."""

_CHUNK = 1 << 20


def files_ending(folder: Path, *endings: str) -> list[Path]:
    """List the files below a folder with one of the endings, plain or packed, in the order of their names.

    What macOS leaves beside files when it packs or copies them is none of them: ``._01.bvh``, ``__MACOSX``.
    """
    wanted = tuple(f"{ending}{packed}" for ending in endings for packed in ("", *PACKED))
    return sorted(
        path
        for path in folder.rglob("*")
        if path.name.lower().endswith(wanted)
        and not path.name.startswith(LEFT_BESIDE)
        and "__MACOSX" not in path.relative_to(folder).parts
        and path.is_file()
    )


def plain_name(path: Path) -> str:
    """Give the name of a file without .xz or .gz."""
    return path.name.removesuffix(path.suffix) if path.suffix in PACKED else path.name


def read_bytes(path: Path, *, largest_bytes: int = LARGEST_BYTES) -> bytes:
    """Read a file; one that ends in .xz or .gz is unpacked on the way, and never further than is allowed.

    Raises
    ------
    InputError
        If the file cannot be read, is not what its ending says, or holds more than `largest_bytes`.
    """
    opener: Any = {".xz": lzma.open, ".gz": gzip.open}.get(path.suffix, open)
    data = bytearray()
    try:
        if path.suffix in PACKED:
            largest_bytes = min(largest_bytes, most_unpacked(path.stat().st_size))
        with opener(path, "rb") as file:
            while chunk := file.read(_CHUNK):
                data += chunk
                if len(data) > largest_bytes:
                    raise InputError(
                        f"holds more than {largest_bytes / 2**20:.0f} MiB",
                        where=path,
                        remedy="it is not a take, or must be cut into several",
                    )
    except (lzma.LZMAError, gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise InputError(
            f"broken {path.suffix} file ({error})", where=path, remedy="copy it again"
        ) from error
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"cannot be read ({reason})", where=path, remedy="check the path and its rights"
        ) from error
    return bytes(data)


def most_unpacked(packed_bytes: int) -> int:
    """Give how many bytes a packed recording may hold: what holds far more was made to fill the memory."""
    return max(SMALL_BYTES, MOST_UNPACKED * packed_bytes)


def read_text(path: Path) -> str:
    """Read a text file, plain or packed; see `read_bytes`. What is not UTF-8 is taken for Latin-1."""
    data = read_bytes(path)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def read_lines(path: Path) -> list[str]:
    """Read the lines of a text file that has a line a frame; see `read_text`.

    What old programs put behind the last line (Ctrl-Z, zeros) falls out.

    Raises
    ------
    InputError
        If the file cannot be read or has more lines than a take; they are counted before they are cut.
    """
    text = read_text(path).rstrip(_ENDS_OF_OLD)
    if sum(map(text.count, _LINE_ENDS)) > MOST_LINES:
        problem = f"has more than {MOST_LINES} lines"
        raise InputError(problem, where=path, remedy="it is not a take, or must be cut into several")
    return text.splitlines()
