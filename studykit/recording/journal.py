"""The journal of a session: what happened, line by line, safe against power cuts and tampering."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from io import FileIO
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from studykit.core.errors import InputError

_SEAL = b',"sha256":"'
_SEAL_LENGTH = len(_SEAL) + 64 + len(b'"}')
_NO_RECORD = "0" * 64  # what the first record's digest covers in place of an earlier one


@dataclass(frozen=True, kw_only=True, slots=True)
class Record:
    """One line of a journal.

    Parameters
    ----------
    number : int
        1, 2, 3 ... without a gap.
    time_s : float
        When it happened, s from the start of the recording.
    kind : str
        What happened, such as ``step_started``.
    data : mapping
        The particulars.
    sha256 : str
        Digest of this record and of the one before it, so that no earlier line can be changed unnoticed.
    """

    number: int
    time_s: float
    kind: str
    data: Mapping[str, Any]
    sha256: str


class Journal:
    """A journal that is being written.

    Use `create` for a new session and `reopen` for one that was interrupted.
    """

    def __init__(self, path: Path, file: FileIO) -> None:
        self.path = path
        self.records: tuple[Record, ...] = ()
        self._number, self._sha256 = 0, _NO_RECORD
        self._file = file
        self._is_synced = True
        self._fault: InputError | None = None

    @classmethod
    def create(cls, path: Path) -> Self:
        """Begin a journal.

        Raises
        ------
        InputError
            If there is one already, or the folder cannot be written.
        """
        if path.exists():
            raise InputError(
                "this session has already been recorded", where=path, remedy="resume it or name another"
            )
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            file = path.open("xb", buffering=0)
            _sync_folder(path.parent)
        except OSError as error:
            raise unwritable(path.parent, error) from error
        _lock(file, path)
        return cls(path, file)

    @classmethod
    def reopen(cls, path: Path) -> Self:
        """Go on with a journal after an interruption; `records` holds what it says so far.

        Half a line that a power cut left at the end is moved to a file beside the frames, so that nothing
        is lost and the next record starts on a line of its own.

        Raises
        ------
        InputError
            If it is damaged, cannot be written or is being written by somebody else; it stays as it is.
        """
        try:
            file = path.open("ab", buffering=0)
        except OSError as error:
            raise unwritable(path.parent, error) from error
        try:
            _lock(file, path)
            records, tail = _read(path)
            if tail:
                _set_aside(path, tail)
        except OSError as error:
            file.close()
            raise unwritable(path.parent, error) from error
        except InputError:
            file.close()
            raise
        journal = cls(path, file)
        journal.records = records
        if records:
            journal._number, journal._sha256 = records[-1].number, records[-1].sha256
        return journal

    def append(self, kind: str, data: Mapping[str, Any], *, time_s: float, durable: bool = True) -> Record:
        """Write one record and return once it is safe.

        Parameters
        ----------
        kind : str
            What happened.
        data : mapping
            The particulars: plain values that JSON can hold.
        time_s : float
            When it happened, s.
        durable : bool, optional
            Wait until the disk has it (a power cut does not lose it). Otherwise the operating system has it
            (the end of this program does not lose it) until `sync`.
        """
        if self._fault is not None:  # half a line may lie at the end: nothing may follow it
            raise self._fault
        number = self._number + 1
        body = json.dumps(
            {"number": number, "time_s": round(time_s, 6), "kind": kind, "data": data},
            separators=(",", ":"),
            ensure_ascii=False,
            allow_nan=False,
        ).encode()
        sha256 = _digest(self._sha256, body)
        try:
            write_all(self._file, body[:-1] + _SEAL + sha256.encode() + b'"}\n')
        except OSError as error:
            self._fault = unwritable(self.path.parent, error)
            raise self._fault from error
        self._number, self._sha256, self._is_synced = number, sha256, False
        if durable:
            self.sync()
        return Record(number=number, time_s=round(time_s, 6), kind=kind, data=data, sha256=sha256)

    def sync(self) -> None:
        """Wait until the disk has everything."""
        if not self._is_synced:
            os.fsync(self._file.fileno())
            self._is_synced = True

    def close(self) -> None:
        """Sync and close; closing twice does no harm."""
        if not self._file.closed:
            self.sync()
            self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def read_journal(path: Path) -> tuple[Record, ...]:
    """Read the whole records of a journal; half a line at the end is left out.

    Raises
    ------
    InputError
        If a line was changed, lost or damaged; the message names it.
    """
    return _read(path)[0]


def unwritable(folder: Path, error: OSError) -> InputError:
    """Give the error for a folder that cannot be written."""
    reason = (error.strerror or str(error)).lower()
    return InputError(
        f"the folder cannot be written ({reason})",
        where=folder,
        remedy="choose another folder or ask for the right to write there",
    )


def write_all(file: FileIO, data: bytes) -> None:
    """Write all bytes to an open file, also where the system takes them in parts."""
    written = file.write(data)
    while written < len(data):
        written += file.write(data[written:])


def _read(path: Path) -> tuple[tuple[Record, ...], bytes]:
    """Give the whole records and the bytes of half a line at the end."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(
            "the journal cannot be read", where=path, remedy="check the participant and the study folder"
        ) from error
    end = content.rfind(b"\n") + 1
    return tuple(_records(path, content[:end].split(b"\n")[:-1])), content[end:]


def _records(path: Path, lines: list[bytes]) -> Iterator[Record]:
    sha256 = _NO_RECORD
    for number, line in enumerate(lines, start=1):
        body, seal = line[:-_SEAL_LENGTH] + b"}", line[-_SEAL_LENGTH:]
        sha256 = _digest(sha256, body)
        if seal != _SEAL + sha256.encode() + b'"}':
            raise InputError(
                "the record does not agree with its checksum",
                where=f"{path}, line {number}",
                remedy="it has been changed or damaged since it was recorded, so restore it from a copy",
            )
        yield Record(sha256=sha256, **json.loads(body))


def _digest(before: str, body: bytes) -> str:
    return hashlib.sha256(before.encode() + body).hexdigest()


def _lock(file: FileIO, path: Path) -> None:
    """Refuse a second writer, where the system can; the lock ends with the program."""
    try:
        import fcntl
    except ImportError:
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        file.close()
        raise InputError(
            "the session is being recorded at this moment",
            where=path,
            remedy="stop the other program or notebook first",
        ) from error


def _set_aside(path: Path, tail: bytes) -> None:
    """Copy the half line to a file of its own, and only then cut it off."""
    size = path.stat().st_size - len(tail)
    aside = path.with_suffix("") / f"torn_line_at_{size}.bytes"
    aside.parent.mkdir(exist_ok=True)
    with aside.open("wb") as file:
        file.write(tail)
        file.flush()
        os.fsync(file.fileno())
    _sync_folder(aside.parent)
    with path.open("r+b") as file:
        file.truncate(size)
        os.fsync(file.fileno())


def _sync_folder(folder: Path) -> None:
    """Make a new file's name durable, where the system can."""
    if os.name != "posix":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
