from __future__ import annotations

import asyncio
from collections.abc import Sequence

import numpy as np
import pytest

from studykit.core.arrays import Floats
from studykit.devices.clock import SimulatedClock
from studykit.devices.depth_camera import CameraFrame
from studykit.devices.heart_rate import HeartRateSample
from studykit.devices.simulated import CameraQuality, SimulatedDepthCamera, SimulatedHeartRateBelt


class Walker:
    """Five joints that move along X at 1 m/s."""

    def positions_at(self, time_s: float) -> Floats:
        return np.full((5, 3), time_s)


class SteadyHeart:
    """A beat every 0.75 s."""

    def __init__(self) -> None:
        self._beats = 0

    def beats_until(self, time_s: float) -> Sequence[float]:
        before, self._beats = self._beats, int(time_s / 0.75)
        return [0.75] * (self._beats - before)


def filmed(seconds: float, quality: CameraQuality | None = None, *, seed: int = 1) -> list[CameraFrame]:
    frames: list[CameraFrame] = []

    async def pump(camera: SimulatedDepthCamera) -> None:
        while True:
            frames.append(await camera.read())

    async def run() -> None:
        clock = SimulatedClock(start_s=10.0)
        camera = SimulatedDepthCamera(clock, Walker(), np.random.default_rng(seed), quality=quality)
        await camera.open()
        task = asyncio.create_task(pump(camera))
        await clock.pass_until(10.0 + seconds)
        task.cancel()
        await camera.close()

    asyncio.run(run())
    return frames


def test_a_perfect_camera_sees_what_is_there() -> None:
    quality = CameraQuality(jitter_s=0.0, noise_m=0.0, frame_loss=0.0, joint_loss=0.0)
    frames = filmed(1.99, quality)
    assert [frame.time_s for frame in frames] == pytest.approx([10.0 + k / 30 for k in range(60)])
    assert all(np.array_equal(f.positions, np.full((5, 3), f.time_s)) for f in frames)


def test_a_usual_camera_is_noisy_jitters_and_loses_frames_and_joints() -> None:
    frames = filmed(60.0)
    times = np.array([frame.time_s for frame in frames])
    errors = np.array([frame.positions - frame.time_s for frame in frames])
    confidence = np.array([frame.confidence for frame in frames])
    assert 0.002 < 1 - len(frames) / 1801 < 0.01
    assert np.all(np.diff(times) > 0)
    assert 0 < np.std(np.diff(times)[np.diff(times) < 0.05]) < 0.002
    assert np.nanstd(errors) == pytest.approx(0.005, rel=0.03)
    hidden = np.isnan(errors).any(axis=-1)
    assert 0.002 < hidden.mean() < 0.012  # about joint_loss x hidden_frames
    assert np.array_equal(hidden, confidence == 0.0)
    assert confidence[~hidden].min() >= 0.8


def test_the_same_seed_gives_the_same_frames_and_another_seed_others() -> None:
    first, again, other = filmed(2.0), filmed(2.0), filmed(2.0, seed=2)
    assert all(
        np.array_equal(a.positions, b.positions, equal_nan=True) for a, b in zip(first, again, strict=True)
    )
    assert not np.array_equal(first[0].positions, other[0].positions)


def test_a_belt_sends_every_beat_once_a_second() -> None:
    samples: list[HeartRateSample] = []

    async def pump(belt: SimulatedHeartRateBelt) -> None:
        while True:
            samples.append(await belt.read())

    async def run() -> None:
        clock = SimulatedClock()
        belt = SimulatedHeartRateBelt(clock, SteadyHeart(), np.random.default_rng(1))
        await belt.open()
        task = asyncio.create_task(pump(belt))
        await clock.pass_until(30.5)
        task.cancel()
        await belt.close()

    asyncio.run(run())
    assert [int(sample.time_s) for sample in samples] == list(range(1, 31))
    assert all(sample.heart_rate_bpm == 80 for sample in samples)
    assert [rr for sample in samples for rr in sample.rr_intervals_s] == [0.75] * 40


def test_a_belt_without_a_beat_has_no_reading() -> None:
    class Silent:
        def beats_until(self, time_s: float) -> Sequence[float]:
            return ()

    belt = SimulatedHeartRateBelt(SimulatedClock(), Silent(), np.random.default_rng(1))
    assert belt.message(1.0) == b"\x00\x00"
