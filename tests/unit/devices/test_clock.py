from __future__ import annotations

import asyncio

import pytest

from studykit.devices.clock import RealClock, SimulatedClock


def test_sleepers_are_woken_in_the_order_of_time_and_ties_in_the_order_of_arrival() -> None:
    woken: list[tuple[str, float]] = []

    async def sleeper(clock: SimulatedClock, name: str, times: list[float]) -> None:
        for time_s in times:
            await clock.sleep_until(time_s)
            woken.append((name, clock.now_s()))

    async def run() -> SimulatedClock:
        clock = SimulatedClock()
        async with asyncio.TaskGroup() as group:
            group.create_task(sleeper(clock, "a", [1.0, 2.0, 5.0]))
            group.create_task(sleeper(clock, "b", [1.5, 2.0, 2.5]))
            await clock.pass_until(3.0)
            assert clock.now_s() == 3.0
            await clock.pass_until(10.0)
        return clock

    clock = asyncio.run(run())
    assert woken == [("a", 1.0), ("b", 1.5), ("a", 2.0), ("b", 2.0), ("b", 2.5), ("a", 5.0)]
    assert clock.now_s() == 10.0


def test_time_stands_still_while_a_woken_task_works() -> None:
    seen: list[float] = []

    async def busy(clock: SimulatedClock) -> None:
        await clock.sleep_until(1.0)
        for _ in range(5):
            await asyncio.sleep(0)
            seen.append(clock.now_s())

    async def run() -> None:
        clock = SimulatedClock()
        task = asyncio.create_task(busy(clock))
        await clock.pass_until(2.0)
        assert task.done()

    asyncio.run(run())
    assert seen == [1.0] * 5


def test_a_cancelled_sleeper_holds_nobody_up_and_time_never_goes_back() -> None:
    async def run() -> float:
        clock = SimulatedClock(start_s=4.0)
        task = asyncio.create_task(clock.sleep_until(5.0))
        await asyncio.sleep(0)
        task.cancel()
        await clock.pass_until(6.0)
        await clock.pass_until(1.0)
        return clock.now_s()

    assert asyncio.run(run()) == 6.0


def test_the_real_clock_goes_on_from_an_earlier_recording() -> None:
    first = RealClock()
    second = RealClock(utc_anchor=first.utc_anchor, not_before_s=100.0)
    assert second.utc_anchor == first.utc_anchor
    assert second.now_s() >= 100.0
    assert first.now_s() < 50.0


def test_the_real_clock_waits() -> None:
    async def run() -> float:
        clock = RealClock()
        await clock.pass_until(clock.now_s() - 1.0)
        await clock.sleep_until(0.02)
        return clock.now_s()

    assert asyncio.run(run()) == pytest.approx(0.02, abs=1.0)
