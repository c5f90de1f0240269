"""The same work on many things, on as many processes or machines as there are."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from contextlib import contextmanager
from typing import Any, TypeVar

from studykit.core.errors import InputError

Result = TypeVar("Result")


def spread(
    work: Callable[..., Result], jobs: Iterable[tuple[Any, ...]], *, workers: int | None = None
) -> Generator[Result, None, None]:
    """Do the same work on many things and give the results in their order, as they come.

    Parameters
    ----------
    work : function
        Can be imported by its name; on a cluster, on every machine of it.
    jobs : iterable of tuple
        What it is called with; only a few are taken ahead of those that are done.
    workers : int, optional
        Processes; if not given, what joblib's `parallel_config` says, for example a Dask cluster.

    Raises
    ------
    InputError
        If a process was ended from outside; what the work itself raises is raised here.
    """
    from concurrent.futures.process import BrokenProcessPool

    from joblib import Parallel, delayed

    try:
        yield from Parallel(n_jobs=workers, return_as="generator")(delayed(work)(*job) for job in jobs)
    except BrokenProcessPool as error:
        raise InputError(
            "a process was ended from outside, perhaps for lack of memory",
            where="--workers",
            remedy="run the same again with fewer processes: it goes on where it was",
        ) from error


@contextmanager
def one_core() -> Generator[None, None, None]:
    """Let linear algebra use one core while this lasts.

    Sums are rounded otherwise where their parts are taken on several cores. One core gives the same bytes on
    machines with any number of them, and processes that run side by side do not get into each other's way.
    """
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=1, user_api="blas"):
        yield
