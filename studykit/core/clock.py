"""Time as an argument: whoever needs the time is given a clock."""

from __future__ import annotations

from typing import Protocol


class Clock(Protocol):
    """Something that knows the time and can wait.

    Times are seconds on one monotonic scale that starts with the recording; `utc_anchor` says, once,
    which moment of the calendar its zero was (ISO 8601, UTC).
    """

    utc_anchor: str

    def now_s(self) -> float:
        """Give the time, in seconds since the clock's zero."""
        ...

    async def sleep_until(self, time_s: float) -> None:
        """Wait, as a device does, until a moment."""
        ...

    async def pass_until(self, time_s: float) -> None:
        """Let time pass, as the person in charge does, until a moment.

        On a real clock this is waiting. On a simulated clock it is what moves time on: every device that
        sleeps until an earlier moment is woken in order first.
        """
        ...
