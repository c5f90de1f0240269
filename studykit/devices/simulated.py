"""Simulated devices: a camera and a belt that behave like real ones, on an injected clock."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from studykit.core.arrays import Booleans, Floats
from studykit.core.clock import Clock
from studykit.devices.depth_camera import CameraFrame
from studykit.devices.heart_rate import HeartRateSample, encode, parse

_BLOCK = 256  # frames whose noise is drawn at once
_BELT_MEMORY_BEATS = 5  # a belt shows the mean of its last few beats


class Scene(Protocol):
    """Whoever stands before the camera."""

    def positions_at(self, time_s: float) -> Floats:
        """Give where the joints truly are, shape (joint, 3), m."""
        ...


class Heart(Protocol):
    """Whoever wears the belt."""

    def beats_until(self, time_s: float) -> Sequence[float]:
        """Give the RR intervals, s, of the beats since the last call, oldest first."""
        ...


@dataclass(frozen=True, kw_only=True, slots=True)
class CameraQuality:
    """How well a simulated camera sees.

    Parameters
    ----------
    frame_rate_hz : float
        Pictures a second.
    jitter_s : float
        Longest delay of a picture, s; less than the time between pictures.
    noise_m : float
        Standard deviation of each coordinate, m.
    frame_loss : float
        Share of pictures that never arrive.
    joint_loss : float
        Chance, per joint and picture, that the joint is hidden from then on for `hidden_frames` pictures.
    hidden_frames : int
        How long a hidden joint stays hidden.
    """

    frame_rate_hz: float = 30.0
    jitter_s: float = 0.002
    noise_m: float = 0.005
    frame_loss: float = 0.005
    joint_loss: float = 0.001
    hidden_frames: int = 6


class SimulatedDepthCamera:
    """A depth camera that looks at a simulated person.

    Parameters
    ----------
    clock : Clock
        Tells when pictures are due.
    scene : Scene
        Who is seen.
    rng : numpy.random.Generator
        Noise, jitter and losses.
    quality : CameraQuality, optional
        How well it sees.
    """

    name = "simulated depth camera"
    simulated = True

    def __init__(
        self, clock: Clock, scene: Scene, rng: np.random.Generator, *, quality: CameraQuality | None = None
    ) -> None:
        self._clock, self._scene, self._rng = clock, scene, rng
        self._quality = quality or CameraQuality()
        self._start_s = 0.0
        self._frame = 0
        self._block: _Block | None = None

    async def open(self) -> None:
        """Begin to take pictures, the first one now."""
        self._start_s, self._frame, self._block = self._clock.now_s(), 0, None

    async def read(self) -> CameraFrame:
        """Wait for the next picture."""
        while True:
            frame, within = self._frame, self._frame % _BLOCK
            if self._block is None or within == 0:
                self._block = _Block.draw(self._rng, self._quality, self._scene.positions_at(self._start_s))
            self._frame += 1
            block = self._block
            if not block.is_lost[within]:
                break
        due_s = self._start_s + frame / self._quality.frame_rate_hz + block.delays_s[within]
        await self._clock.sleep_until(due_s)
        time_s = self._clock.now_s()
        return CameraFrame(
            time_s=time_s,
            positions=self._scene.positions_at(time_s) + block.noise[within],
            confidence=block.confidence[within],
        )

    async def close(self) -> None:
        """Stop; there is nothing to disconnect."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _Block:
    """What chance does to the next pictures."""

    delays_s: Floats
    is_lost: Booleans
    noise: Floats
    confidence: Floats

    @classmethod
    def draw(cls, rng: np.random.Generator, quality: CameraQuality, positions: Floats) -> _Block:
        joints = len(positions)
        noise = rng.normal(0.0, quality.noise_m, (_BLOCK, joints, 3))
        begins = rng.random((_BLOCK, joints)) < quality.joint_loss
        begun = np.cumsum(begins, axis=0)
        earlier = np.zeros_like(begun)
        earlier[quality.hidden_frames :] = begun[: -quality.hidden_frames]
        is_hidden = begun > earlier
        noise[is_hidden] = np.nan
        return cls(
            delays_s=rng.uniform(0.0, quality.jitter_s, _BLOCK),
            is_lost=rng.random(_BLOCK) < quality.frame_loss,
            noise=noise,
            confidence=np.where(is_hidden, 0.0, rng.uniform(0.8, 1.0, (_BLOCK, joints))),
        )


class SimulatedHeartRateBelt:
    """A chest strap on a simulated person: one message a second, in the bytes that a real one sends.

    Parameters
    ----------
    clock : Clock
        Tells when messages are due.
    heart : Heart
        Whose heart beats.
    rng : numpy.random.Generator
        Delays of the radio.
    """

    name = "simulated heart-rate belt"
    simulated = True

    def __init__(self, clock: Clock, heart: Heart, rng: np.random.Generator) -> None:
        self._clock, self._heart, self._rng = clock, heart, rng
        self._next_s = 0.0
        self._recent: deque[float] = deque(maxlen=_BELT_MEMORY_BEATS)

    async def open(self) -> None:
        """Begin to listen to the heart; the first message comes a second later."""
        self._next_s = self._clock.now_s() + 1.0

    async def read(self) -> HeartRateSample:
        """Wait for the next message."""
        await self._clock.sleep_until(self._next_s + self._rng.uniform(0.0, 0.02))
        self._next_s += 1.0
        time_s = self._clock.now_s()
        return parse(self.message(time_s), time_s)

    def message(self, time_s: float) -> bytes:
        """Give the bytes that the belt sends: the mean rate of its last beats, and the newest beats."""
        beats = tuple(self._heart.beats_until(time_s))
        self._recent.extend(beats)
        bpm = round(60.0 * len(self._recent) / sum(self._recent)) if self._recent else 0
        return encode(bpm, rr_intervals_s=beats)

    async def close(self) -> None:
        """Stop; there is nothing to disconnect."""
