"""Every device does what the runner counts on."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from studykit.core.arrays import Floats
from studykit.core.clock import Clock
from studykit.devices.clock import SimulatedClock
from studykit.devices.device import Device
from studykit.devices.simulated import SimulatedDepthCamera, SimulatedHeartRateBelt


class Somebody:
    def positions_at(self, time_s: float) -> Floats:
        return np.full((24, 3), time_s)

    def beats_until(self, time_s: float) -> Sequence[float]:
        return (0.75,)


DEVICES: dict[str, Callable[[Clock], Device[Any]]] = {
    "simulated camera": lambda clock: SimulatedDepthCamera(clock, Somebody(), np.random.default_rng(1)),
    "simulated belt": lambda clock: SimulatedHeartRateBelt(clock, Somebody(), np.random.default_rng(1)),
}


@pytest.fixture(params=DEVICES.values(), ids=list(DEVICES))
def make(request: pytest.FixtureRequest) -> Callable[[Clock], Device[Any]]:
    made: Callable[[Clock], Device[Any]] = request.param
    return made


def read_for(make: Callable[[Clock], Device[Any]], seconds: float, *, openings: int = 1) -> list[Any]:
    samples: list[Any] = []

    async def pump(device: Device[Any]) -> None:
        while True:
            samples.append(await device.read())

    async def run() -> None:
        clock = SimulatedClock(start_s=7.0)
        device = make(clock)
        for _ in range(openings):
            await device.open()
            task = asyncio.create_task(pump(device))
            await clock.pass_until(clock.now_s() + seconds)
            task.cancel()
            await device.close()
            await device.close()

    asyncio.run(run())
    return samples


def test_it_says_what_it_is(make: Callable[[Clock], Device[Any]]) -> None:
    device = make(SimulatedClock())
    assert device.name
    assert device.simulated is True


def test_samples_carry_times_of_its_clock_that_never_go_back(make: Callable[[Clock], Device[Any]]) -> None:
    times = [sample.time_s for sample in read_for(make, 20.0)]
    assert len(times) >= 19
    assert times[0] >= 7.0
    assert times[-1] <= 27.0
    assert np.all(np.diff(times) > 0.0)


def test_it_can_be_opened_again(make: Callable[[Clock], Device[Any]]) -> None:
    times = [sample.time_s for sample in read_for(make, 5.0, openings=2)]
    assert np.all(np.diff(times) > 0.0)
    assert any(time_s > 13.0 for time_s in times)


def test_the_same_seed_gives_the_same_samples(make: Callable[[Clock], Device[Any]]) -> None:
    for first, again in zip(read_for(make, 5.0), read_for(make, 5.0), strict=True):
        for name in first.__slots__:
            np.testing.assert_array_equal(getattr(first, name), getattr(again, name))
