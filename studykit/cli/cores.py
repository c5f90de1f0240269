"""How commands choose where their work is done: processes here, or a Dask cluster."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

import typer

from studykit.core.errors import InputError

Workers = Annotated[
    int | None, typer.Option(min=1, help="Processes; as many as there are cores if not given.")
]
Dask = Annotated[
    str | None, typer.Option("--dask", help="Address of a Dask scheduler, such as tcp://10.0.0.5:8786.")
]


def processes() -> int:
    """Count the cores that may be used."""
    from joblib import cpu_count

    return int(cpu_count())


@contextmanager
def workforce(dask: str | None, workers: int | None) -> Iterator[int | None]:
    """Let joblib's work go to a Dask cluster while this lasts, or say how many processes do it here.

    Raises
    ------
    InputError
        If Dask is not installed or no scheduler answers.
    """
    if dask is None:
        yield workers or processes()
        return
    try:
        from distributed import Client
    except ImportError:
        remedy = "install it: pip install 'dask[distributed]'"
        raise InputError("Dask is not installed", where="--dask", remedy=remedy) from None
    from joblib import parallel_config

    try:
        client = Client(dask, timeout=10)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"no scheduler answers at {dask}", where="--dask", remedy="check its address"
        ) from error
    with client, parallel_config(backend="dask"):
        yield None
