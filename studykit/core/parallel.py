"""The same work on many things, on as many processes or machines as there are."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from threading import Event, Lock
from typing import Any, TypeVar

from studykit.core.errors import InputError

Result = TypeVar("Result")
Thing = TypeVar("Thing")


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


def side_by_side(
    work: Callable[[Thing], Result], things: Iterable[Thing], *, stop: Event
) -> Generator[Result, None, None]:
    """Do the same work on many things in threads, one a core, and give the results in their order.

    Parameters
    ----------
    work : function
        Worth it where most of it is compiled.
    things : iterable
        What it is called with.
    stop : Event
        Set when a piece of work fails or the results are no longer wanted (Ctrl-C): what has begun should
        then end soon; what has not is called off.
    """
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        try:
            yield from pool.map(work, things)
        except BaseException:
            stop.set()
            raise


class _OneCore:
    """Counts who needs one core, since the setting is the whole process's: the last one puts it back."""

    def __init__(self) -> None:
        self.lock = Lock()
        self.users = 0
        self.limits: Any = None

    def enter(self) -> None:
        from threadpoolctl import threadpool_limits

        with self.lock:
            if not self.users:
                self.limits = threadpool_limits(limits=1, user_api="blas")
            self.users += 1

    def leave(self) -> None:
        with self.lock:
            self.users -= 1
            if not self.users:
                self.limits.restore_original_limits()


_ONE_CORE = _OneCore()


@contextmanager
def one_core() -> Generator[None, None, None]:
    """Let linear algebra use one core while this lasts, in any number of threads.

    Sums are rounded otherwise where their parts are taken on several cores. One core gives the same bytes on
    machines with any number of them, and processes that run side by side do not get into each other's way.
    """
    _ONE_CORE.enter()
    try:
        yield
    finally:
        _ONE_CORE.leave()
