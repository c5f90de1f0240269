"""Clocks: the real one, and one on which an hour passes in a second."""

from __future__ import annotations

import asyncio
import heapq
import itertools
import time
from datetime import UTC, datetime
from typing import Any

SIMULATED_ANCHOR = "2000-01-01T00:00:00.000000Z"
"""The moment at which every simulated recording is said to begin."""

_MOST_TURNS = 1000  # of the event loop, given to a woken task before time goes on without it


class RealClock:
    """The time on the wall, counted from the start of a recording.

    Parameters
    ----------
    utc_anchor : str, optional
        The moment that is zero (ISO 8601, UTC): given when an earlier recording goes on; now if not given.
    not_before_s : float, optional
        A time that has already been recorded, s: the clock starts no earlier, even if somebody has put back
        the computer's calendar in between.
    """

    def __init__(self, *, utc_anchor: str | None = None, not_before_s: float = 0.0) -> None:
        now = datetime.now(UTC)  # noqa: TID251 - the one place that looks at the calendar
        anchor = now if utc_anchor is None else datetime.fromisoformat(utc_anchor)
        self.utc_anchor = anchor.isoformat(timespec="microseconds").replace("+00:00", "Z")
        self._zero_s = time.monotonic() - max((now - anchor).total_seconds(), not_before_s)

    def now_s(self) -> float:
        """Give the time, in seconds since the clock's zero."""
        return time.monotonic() - self._zero_s

    async def sleep_until(self, time_s: float) -> None:
        """Wait until a moment."""
        await asyncio.sleep(max(0.0, time_s - self.now_s()))

    async def pass_until(self, time_s: float) -> None:
        """Wait until a moment."""
        await self.sleep_until(time_s)


class SimulatedClock:
    """A clock that stands still until it is told to go on.

    Everybody who sleeps is woken in the order of time, and time stands still while the woken one works. So
    the same programme always gives the same recording, however busy the computer is, and also inside a
    notebook, whose event loop already runs.

    Parameters
    ----------
    start_s : float, optional
        What the clock shows at first, s.
    """

    def __init__(self, *, start_s: float = 0.0) -> None:
        self.utc_anchor = SIMULATED_ANCHOR
        self._now_s = start_s
        self._order = itertools.count()
        self._sleepers: list[tuple[float, int, asyncio.Task[Any] | None, asyncio.Future[None]]] = []
        self._asleep: set[asyncio.Task[Any] | None] = set()

    def now_s(self) -> float:
        """Give the time, in seconds since the clock's zero."""
        return self._now_s

    async def sleep_until(self, time_s: float) -> None:
        """Wait until somebody lets time pass up to a moment."""
        task = asyncio.current_task()
        future: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        heapq.heappush(self._sleepers, (max(time_s, self._now_s), next(self._order), task, future))
        self._asleep.add(task)
        try:
            await future
        finally:
            self._asleep.discard(task)

    async def pass_until(self, time_s: float) -> None:
        """Let time pass: wake everyone who sleeps until then, in order."""
        await asyncio.sleep(0)  # tasks that have just begun reach their first sleep
        while self._sleepers and self._sleepers[0][0] <= time_s:
            wake_s, _, task, future = heapq.heappop(self._sleepers)
            if future.done():  # its owner was cancelled meanwhile
                continue
            self._now_s = wake_s
            future.set_result(None)
            await self._settled(task)
        self._now_s = max(self._now_s, time_s)

    async def _settled(self, task: asyncio.Task[Any] | None) -> None:
        """Yield until the woken task sleeps again or has ended."""
        self._asleep.discard(task)
        for _ in range(_MOST_TURNS):
            await asyncio.sleep(0)
            if task is None or task in self._asleep or task.done():
                return
