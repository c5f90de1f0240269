"""Movement made by rule: rhythmic figures of a whole body, on the beat and within what joints can do.

Every joint swings in harmonics of a bar of four beats; a phrase of four seconds has a figure of its own, and
phrases are joined smoothly. The steps shift the weight from leg to leg, and the body goes where the foot on
the floor lets it. It stands in for recorded dances where none are at hand and claims to be no more.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from studykit.core.arrays import Floats
from studykit.library import joint_limit
from studykit.motion import energy, kinematics
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY

FRAME_RATE_HZ: Final = 30.0
PHRASE_S: Final = 4.0
"""How long a figure lasts: one segment of a library."""
FASTEST_M_S: Final = 5.8
"""No joint travels faster than this in the world."""
HARDEST_M_S2: Final = 95.0
"""No joint is accelerated more than this in the world."""

_HARMONICS: Final = np.array(
    [1.0, 2.0, 4.0]
)  # per bar of four beats: every bar, every second beat, every beat
_SHARES: Final = np.array([0.5, 1.0, 0.3])  # how much of a swing falls to each of them
_JOIN_S: Final = 1.0  # how long one figure takes to pass into the next
_ATTEMPTS: Final = 8
_CLOSE_ENOUGH: Final = 0.06  # of the logarithm of the gain
_TYPICAL_ENERGY: Final = 0.4  # J/kg in a phrase at gain 1: where the search for the gain starts

_INDEX = NEUTRAL_BODY.index
_LEFT = np.array([joint for joint, name in enumerate(NEUTRAL_BODY.joint_names) if name.startswith("left_")])
_RIGHT = np.array([NEUTRAL_BODY.mirror[joint] for joint in _LEFT])
_FLIP: Final = np.array([1.0, -1.0, -1.0])  # a mirror turns angles about Y and Z round


@dataclass(frozen=True, kw_only=True, slots=True)
class Style:
    """A way of dancing, as how much each part of the body takes part.

    Parameters
    ----------
    name : str
        Says that it is synthetic.
    tempo_bpm : tuple of float
        Slowest and fastest beat.
    arms_deg, elbows_deg, trunk_deg, twist_deg, hips_deg : float
        Typical swing of shoulders, of elbows, of each link of the spine, of the pelvis about the vertical and
        of the weight from side to side.
    raise_deg : float
        How high the arms are held: 0 horizontal, -80 hanging.
    lift_deg, bounce_deg, swing_deg : float
        How high the knees come, how deep every beat bounces and how far the steps go forwards and backwards.
    straightness : float
        Share of straight-legged lifts (kicks), 0 to 1.
    turn_deg : float
        Typical change of direction in a phrase.
    """

    name: str
    tempo_bpm: tuple[float, float]
    arms_deg: float = 25.0
    elbows_deg: float = 25.0
    trunk_deg: float = 4.0
    twist_deg: float = 8.0
    hips_deg: float = 6.0
    raise_deg: float = -35.0
    lift_deg: float = 25.0
    bounce_deg: float = 8.0
    swing_deg: float = 6.0
    straightness: float = 0.2
    turn_deg: float = 40.0


STYLES: Final = (
    Style(name="synthetic-sway", tempo_bpm=(90, 100), hips_deg=10, lift_deg=14, bounce_deg=5, trunk_deg=7),
    Style(
        name="synthetic-bounce", tempo_bpm=(110, 120), bounce_deg=15, lift_deg=20, elbows_deg=32, arms_deg=18
    ),
    Style(name="synthetic-step", tempo_bpm=(100, 115), lift_deg=38, swing_deg=13, arms_deg=18, turn_deg=75),
    Style(name="synthetic-wave", tempo_bpm=(90, 105), arms_deg=38, trunk_deg=7, raise_deg=0, lift_deg=12),
    Style(
        name="synthetic-twist", tempo_bpm=(115, 130), twist_deg=20, bounce_deg=12, lift_deg=12, turn_deg=25
    ),
    Style(
        name="synthetic-kick", tempo_bpm=(100, 112), lift_deg=45, straightness=0.9, swing_deg=8, turn_deg=60
    ),
)
"""The ways of dancing that can be made."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Figures:
    """What is danced, phrase by phrase, before anything is computed at moments of time.

    Parameters
    ----------
    tempo_bpm : float
        Beats a minute.
    held : ndarray, shape (phrase, 24, 3), rad
        Angles about which each joint swings.
    swings : ndarray, shape (phrase, 3, 24, 3), complex, rad
        Amplitude and phase of the harmonics of a bar; the pelvis's Y is its twist about the vertical.
    turns_rad : ndarray, shape (phrase,)
        Change of direction during the phrase.
    """

    tempo_bpm: float
    held: Floats
    swings: NDArray[np.complex128]
    turns_rad: Floats


def figures(style: Style, phrases: int, rng: np.random.Generator) -> Figures:
    """Think up the figures of one take.

    Parameters
    ----------
    style : Style
        How it is danced.
    phrases : int
        How many figures.
    rng : Generator
        Chooses them.
    """
    swing_deg, held_deg = _typical(style)
    size = rng.lognormal(0.0, 0.45, (phrases, 1, *swing_deg.shape)) * swing_deg
    share = _SHARES[:, None, None] * rng.lognormal(0.0, 0.4, (phrases, 3, *swing_deg.shape))
    swings = np.radians(size * share) * np.exp(2j * np.pi * rng.random((phrases, 3, *swing_deg.shape)))
    held = joint_limit.NEUTRAL + np.radians(held_deg[0] + held_deg[1] * rng.standard_normal((phrases, 24, 3)))

    # The right side mirrors the left in half of the phrases, follows it by a beat in a quarter, else is free.
    manner = rng.random(phrases)
    late = np.where(manner < 0.5, 0.0, 1.0)[:, None] * _HARMONICS * (np.pi / 2.0)
    coupled = manner < 0.75
    shifted = swings * np.exp(-1j * late)[:, :, None, None]
    swings[np.ix_(coupled, np.arange(3), _RIGHT)] = shifted[np.ix_(coupled, np.arange(3), _LEFT)] * _FLIP
    held[np.ix_(coupled, _RIGHT)] = held[np.ix_(coupled, _LEFT)] * _FLIP

    _add_steps(held, swings, style, rng)
    turns = np.radians(style.turn_deg) * rng.standard_normal(phrases)
    return Figures(tempo_bpm=rng.uniform(*style.tempo_bpm), held=held, swings=swings, turns_rad=turns)


def _typical(style: Style) -> tuple[Floats, Floats]:
    """Give typical swings (24, 3), and mean and spread of held angles against neutral (2, 24, 3), degrees."""
    swing, held = np.zeros((24, 3)), np.zeros((2, 24, 3))
    for link in ("spine1", "spine2", "spine3"):
        swing[_INDEX(link)] = np.array([1.0, 1.2, 1.0]) * style.trunk_deg
    swing[_INDEX("neck")] = swing[_INDEX("head")] = (3.0, 5.0, 3.0)
    swing[_INDEX("pelvis")] = (2.0, style.twist_deg, 2.5)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        arm, forearm = _INDEX(f"{side}_shoulder"), _INDEX(f"{side}_elbow")
        swing[_INDEX(f"{side}_collar")] = (0.0, 3.0, 4.0)
        swing[arm] = np.array([0.5, 0.8, 1.0]) * style.arms_deg
        swing[forearm] = np.array([0.5, 1.0, 0.0]) * style.elbows_deg
        swing[_INDEX(f"{side}_wrist")] = (0.0, 5.0, 12.0)
        swing[_INDEX(f"{side}_hand")] = (0.0, 0.0, 6.0)
        raised = np.radians(style.raise_deg) - sign * joint_limit.NEUTRAL[arm, 2]
        held[0, arm, 2] = sign * np.degrees(raised)
        held[0, forearm, 1] = -sign * 20.0
        held[1, arm], held[1, forearm] = (10.0, 18.0, 20.0), (12.0, 22.0, 0.0)
    return swing, held


def _add_steps(held: Floats, swings: NDArray[np.complex128], style: Style, rng: np.random.Generator) -> None:
    """Add what the legs do together: lifts in turn, bounces, weight shifts, all with level feet.

    A lift is L (1 + sin x)^2 / 4 = L (3/8 + sin(x) / 2 - cos(2 x) / 8), so it needs two harmonics only.
    """
    phrases = len(held)
    lift, bounce, swing, hips = (
        np.radians(typical) * rng.lognormal(0.0, 0.3, phrases)
        for typical in (style.lift_deg, style.bounce_deg, style.swing_deg, style.hips_deg)
    )
    beat = np.exp(1j * rng.uniform(0.0, 2.0 * np.pi, phrases))
    sine = -1j * beat
    bent = np.where(rng.random(phrases) < style.straightness, 0.25, 1.9)  # knee's share of a lift
    swing_way = swing * np.exp(1j * rng.uniform(-0.6, 0.6, phrases)) * sine
    for side, sign in (("left", 1.0), ("right", -1.0)):
        hip, knee, ankle = (_INDEX(f"{side}_{name}") for name in ("hip", "knee", "ankle"))
        lift_2, lift_4 = sign * 0.5 * lift * sine, -0.125 * lift * beat**2
        crouch_4 = 0.5 * bounce * beat**2
        held[:, hip, 0] -= 0.5 * bounce + 0.375 * lift
        held[:, knee, 0] += bounce + 0.375 * bent * lift
        held[:, ankle, 0] += -0.5 * bounce - 0.375 * (bent - 1.0) * lift
        swings[:, 1, hip, 0] += -lift_2 + sign * swing_way
        swings[:, 2, hip, 0] -= crouch_4 + lift_4
        swings[:, 1, knee, 0] += bent * lift_2
        swings[:, 2, knee, 0] += 2.0 * crouch_4 + bent * lift_4
        swings[:, 1, ankle, 0] -= (bent - 1.0) * lift_2 + sign * swing_way
        swings[:, 2, ankle, 0] -= crouch_4 + (bent - 1.0) * lift_4
        swings[:, 1, hip, 2] += hips * sine
        swings[:, 1, ankle, 2] -= hips * sine
        swings[:, :, hip, 1] -= 0.7 * swings[:, :, 0, 1]  # the feet stay while the pelvis twists


def perform(figures: Figures, gains: Floats, frame_rate_hz: float) -> Motion:
    """Dance figures at given gains.

    Parameters
    ----------
    figures : Figures
        What is danced.
    gains : ndarray, shape (phrase,)
        How big each figure is danced; 1 as thought up.
    frame_rate_hz : float
        Frames a second.
    """
    return _perform(figures, gains, frame_rate_hz)[0]


def _perform(figures: Figures, gains: Floats, frame_rate_hz: float) -> tuple[Motion, Floats]:
    """Give the motion and, since they are known by then, the joint positions from the pelvis."""
    phrases = len(figures.held)
    times_s = np.arange(round(phrases * PHRASE_S * frame_rate_hz)) / frame_rate_hz
    shares = _phrase_shares(times_s, phrases)
    bar_phase = 2.0 * np.pi * figures.tempo_bpm / 240.0 * times_s
    carriers = np.exp(1j * bar_phase[:, None] * _HARMONICS)

    held = joint_limit.NEUTRAL + np.sqrt(gains)[:, None, None] * (figures.held - joint_limit.NEUTRAL)
    swings = (shares @ (gains[:, None, None, None] * figures.swings).reshape(phrases, -1)).reshape(-1, 3, 72)
    swung = np.real(np.einsum("fh,fhd->fd", carriers, swings)).reshape(-1, 24, 3)
    angles = joint_limit.within((shares @ held.reshape(phrases, -1)).reshape(-1, 24, 3) + swung)

    starts_s = PHRASE_S * np.arange(phrases)
    turned = _smooth_step((times_s[:, None] - starts_s - 0.5) / (PHRASE_S - 1.0))
    angles[:, 0, 1] = turned @ (np.minimum(gains, 1.0) * figures.turns_rad) + swung[:, 0, 1]
    rotations = joint_limit.rotations(angles)
    centred = kinematics.centred_positions(NEUTRAL_BODY, rotations)
    motion = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotations,
        root_positions=grounded_root(centred, frame_rate_hz),
        frame_rate_hz=frame_rate_hz,
    )
    return motion, centred


def _smooth_step(share: Floats) -> Floats:
    """Go from 0 to 1 with no jump up to the second derivative (6 x^5 - 15 x^4 + 10 x^3)."""
    x = np.clip(share, 0.0, 1.0)
    return np.asarray(x**3 * (x * (6.0 * x - 15.0) + 10.0))


def _phrase_shares(times_s: Floats, phrases: int) -> Floats:
    """Give how much each figure counts at each moment, shape (frame, phrase); rows add up to 1."""
    edges = np.ones((len(times_s), phrases + 1))
    edges[:, -1] = 0.0
    inner = PHRASE_S * np.arange(1, phrases)
    edges[:, 1:-1] = _smooth_step((times_s[:, None] - inner) / _JOIN_S + 0.5)
    return np.asarray(edges[:, :-1] - edges[:, 1:])


def grounded_root(centred: Floats, frame_rate_hz: float) -> Floats:
    """Give the way of the pelvis that lets the foot on the floor stay where it is.

    Parameters
    ----------
    centred : ndarray, shape (frame, 24, 3), m
        Joint positions from the pelvis.
    frame_rate_hz : float
        Frames a second.

    Returns
    -------
    ndarray, shape (frame, 3), m
        The lowest of heels and toes stays about at height 0; the pelvis moves against the feet, each as far
        as it bears weight, and drifts back to the middle of the room.
    """
    from scipy.signal import lfilter

    blur_m, memory_s, sole_m, ball_m = 0.03, 5.0, 0.075, 0.02
    soles = centred[:, [_INDEX(name) for name in ("left_ankle", "right_ankle", "left_foot", "right_foot")]]
    heights = soles[..., 1] - np.array([sole_m, sole_m, ball_m, ball_m])
    lowest = heights.min(axis=1, keepdims=True)
    bearing = np.exp((lowest - heights) / blur_m)
    root = np.zeros((len(centred), 3))
    root[:, 1] = blur_m * np.log(bearing.mean(axis=1)) - lowest[:, 0]
    bearing /= bearing.sum(axis=1, keepdims=True)
    velocity = -np.einsum("fs,fsk->fk", bearing, np.gradient(soles[..., [0, 2]], axis=0)) * frame_rate_hz
    step_s = 1.0 / frame_rate_hz
    root[:, [0, 2]] = lfilter([step_s], [1.0, step_s / memory_s - 1.0], velocity, axis=0)
    return root


def dance(figures: Figures, energies: Floats) -> Motion:
    """Dance figures as hard as asked, each phrase on its own, at 30 frames a second.

    Parameters
    ----------
    figures : Figures
        What is danced.
    energies : ndarray, shape (phrase,), J per kg of body mass
        Wished linear energy of each phrase, summed over its poses.

    Returns
    -------
    Motion
        Energies are met to a few per cent, save where a joint would become too fast.
    """
    gains = np.sqrt(energies / _TYPICAL_ENERGY)
    motion, centred = _perform(figures, gains, FRAME_RATE_HZ)
    for _ in range(_ATTEMPTS):
        reached, room = _effort(motion, centred, len(energies))
        change = np.minimum(np.sqrt(energies / reached), 0.97 * room)
        if np.all(room > 1.0) and np.all(np.abs(np.log(change)) < _CLOSE_ENOUGH):
            break
        gains = gains * change
        motion, centred = _perform(figures, gains, FRAME_RATE_HZ)
    return motion


def _effort(motion: Motion, centred: Floats, phrases: int) -> tuple[Floats, Floats]:
    """Give the linear energy of each phrase and by what factor its joints could still become faster."""
    steps = np.diff(centred + motion.root_positions[:, None, :], axis=0)
    changes = np.diff(steps, axis=0)
    speed = np.sqrt(np.einsum("fjk,fjk->fj", steps, steps).max(axis=1)) * FRAME_RATE_HZ
    acceleration = np.sqrt(np.einsum("fjk,fjk->fj", changes, changes).max(axis=1)) * FRAME_RATE_HZ**2
    room = np.minimum(FASTEST_M_S / speed[1:], HARDEST_M_S2 / acceleration)
    poses = len(motion) // phrases
    starts = np.arange(0, len(motion), poses)
    energies = [energy.linear_energy(centred[start : start + poses], FRAME_RATE_HZ).sum() for start in starts]
    return np.array(energies), np.minimum.reduceat(room, starts)
