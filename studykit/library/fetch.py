"""Bringing public dances from where they are published: checked, and taken up again where it broke off."""

from __future__ import annotations

import http.client
import json
import os
import urllib.error
import urllib.request
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Final

from pydantic import BaseModel, ConfigDict, Field

from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.core.provenance import sha256_of_file
from studykit.io.datasets.recipe import FILE_NAME, built_in_recipes

_TIMEOUT_S: Final = 30.0
_ATTEMPTS: Final = 3
_CHUNK_BYTES: Final = 1 << 16
_CHANGED: Final = "run the same command again; if that does not help, the origin has changed its files"
_AGAIN: Final = "run the same command again, what has arrived is kept"


class RegisteredFile(BaseModel):
    """One file of a public data set and what must be in it."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    path: str
    """Path below the address of the data set, and in the folder made."""
    size_bytes: Annotated[int, Field(gt=0)]
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class RegisteredDataSet(BaseModel):
    """A public data set: where it lies and how its takes are read."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    title: str
    origin: str
    """Repository, folder and commit, or whatever names the edition."""
    base_url: str
    """Address that each file's path is added to."""
    recipe: str
    """The built-in recipe that reads the takes."""
    files: tuple[RegisteredFile, ...]


class _BrokenOffError(Exception):
    """The connection ended before the file did."""


def registry() -> dict[str, RegisteredDataSet]:
    """Name the public data sets that can be fetched."""
    text = (files("studykit.library") / "registry.json").read_text(encoding="utf-8")
    return {name: RegisteredDataSet.model_validate(entry) for name, entry in json.loads(text).items()}


def fetch(name: str, out: Path, progress: Progress = silent, *, base_url: str | None = None) -> Path:
    """Bring a public data set into a folder from which a library can be built.

    Every file is compared with the digest in the registry before it gets its name, so a file that is there is
    whole and right. What is there already is not fetched again; half a file is continued.

    Parameters
    ----------
    name : str
        A name of the registry, such as "cmu-dance".
    out : Path
        The folder; made if it is not there.
    progress : Progress
        Told about each file.
    base_url : str, optional
        Another address at which the same files lie, such as a mirror of your own.

    Returns
    -------
    Path
        The folder, with a library.toml that says how to read the takes.

    Raises
    ------
    InputError
        If the name is unknown, the network or the origin fails, a file is not the one in the registry, or the
        folder cannot be written.
    """
    known = registry()
    if name not in known:
        raise InputError(f"no public data set is called {name!r}", remedy=f"choose {' or '.join(known)}")
    entry, folder = known[name], Path(out)
    base = (base_url or entry.base_url).rstrip("/") + "/"
    if not base.startswith(("https://", "http://")):
        raise InputError("is not a web address", where=base, remedy="begin it with https://")
    try:
        for file in progress(entry.files, label=f"Fetching {name}", total=len(entry.files)):
            _fetch_file(base + file.path, file, folder / file.path)
        if not (folder / FILE_NAME).exists():
            (folder / FILE_NAME).write_bytes(built_in_recipes()[entry.recipe].read_bytes())
    except OSError as error:
        raise InputError(
            f"cannot be written ({error.strerror or error})",
            where=error.filename or folder,
            remedy="choose a folder that you may write to, on a disk with room",
        ) from error
    return folder


def _fetch_file(url: str, file: RegisteredFile, target: Path) -> None:
    """Bring one file, unless it is there; it gets its name only when its content is right."""
    if target.exists() and sha256_of_file(target) == file.sha256:
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(target.name + ".part")
    for attempt in range(1, _ATTEMPTS + 1):
        try:
            _receive(url, part, file.size_bytes)
            break
        except _BrokenOffError as error:
            if attempt == _ATTEMPTS:
                raise InputError(
                    f"the connection broke off {_ATTEMPTS} times", where=url, remedy=_AGAIN
                ) from error
    if sha256_of_file(part) != file.sha256:
        part.unlink()
        raise InputError(
            "what arrived is not the file of the registry (its SHA-256 differs) and was thrown away",
            where=url,
            remedy=_CHANGED,
        )
    part.replace(target)


def _receive(url: str, part: Path, size_bytes: int) -> None:
    """Add what is missing to a partial file.

    Raises
    ------
    _BrokenOffError
        If the connection ends early.
    """
    there = part.stat().st_size if part.exists() else 0
    if there > size_bytes:
        part.unlink()
        there = 0
    if there == size_bytes:
        return
    response = _open(url, there)
    with response, part.open("ab") as file:
        if response.status != http.HTTPStatus.PARTIAL_CONTENT:  # the server sends the file from its beginning
            file.truncate(0)
            there = 0
        if response.length is not None and response.length != size_bytes - there:
            raise InputError("is not as long as the registry says", where=url, remedy=_CHANGED)
        while there < size_bytes:
            chunk = _read(response, min(_CHUNK_BYTES, size_bytes - there))
            file.write(chunk)
            there += len(chunk)
        file.flush()
        os.fsync(file.fileno())


def _open(url: str, first_byte: int) -> http.client.HTTPResponse:
    """Ask for a file from a byte on."""
    headers = {"Range": f"bytes={first_byte}-"} if first_byte else {}
    request = urllib.request.Request(url, headers=headers)  # noqa: S310 - the scheme was checked
    try:
        response: http.client.HTTPResponse = urllib.request.urlopen(request, timeout=_TIMEOUT_S)  # noqa: S310
    except urllib.error.HTTPError as error:
        raise InputError(
            f"the server answers {error.code} {error.reason}",
            where=url,
            remedy="try again later, or give the address of a mirror",
        ) from error
    except urllib.error.URLError as error:
        if isinstance(error.reason, ConnectionResetError):
            raise _BrokenOffError from error
        raise InputError(
            f"cannot be reached ({error.reason})",
            where=url,
            remedy=f"check the network connection and {_AGAIN}",
        ) from error
    except (OSError, http.client.HTTPException) as error:
        raise _BrokenOffError from error
    return response


def _read(response: http.client.HTTPResponse, count: int) -> bytes:
    """Read some bytes; none means that the connection ended."""
    try:
        chunk = response.read(count)
    except (OSError, http.client.HTTPException) as error:
        raise _BrokenOffError from error
    if not chunk:
        raise _BrokenOffError
    return chunk
