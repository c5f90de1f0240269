"""What every device can do."""

from __future__ import annotations

from typing import Protocol, TypeVar

Sample_co = TypeVar("Sample_co", covariant=True)


class Device(Protocol[Sample_co]):
    """Something that gives timed samples, real or simulated.

    Samples carry `time_s`, on the clock that the device was given, and never go back in time.
    """

    name: str
    simulated: bool

    async def open(self) -> None:
        """Connect and begin to measure."""
        ...

    async def read(self) -> Sample_co:
        """Wait for the next sample."""
        ...

    async def close(self) -> None:
        """Stop and disconnect; closing twice does no harm."""
        ...
