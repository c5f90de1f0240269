"""Goals in time (Eq. 14): blocks of a dance that differ in intensity and variety."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from studykit.core.errors import InputError
from studykit.protocol.condition import Intensity, Variety

BLOCK_S = 32.0


@dataclass(frozen=True, kw_only=True, slots=True)
class BlockPlan:
    """What one stretch of a dance shall be like.

    Parameters
    ----------
    duration_s : float
        A multiple of 4 s.
    intensity : {"light", "intense"} or float
        A word of the protocol, or a percentile of the library's random dances, 0 to 100.
    variety : {"easy", "hard"} or float
        A word of the protocol, or a share of the median distance of unrelated segments.
    """

    duration_s: float = BLOCK_S
    intensity: Intensity | float = "light"
    variety: Variety | float = "easy"


Schedule = tuple[BlockPlan, ...]
"""Blocks, one after the other."""


def hiit(*, rounds: int = 2, block_s: float = BLOCK_S, variety: Variety | float = "easy") -> Schedule:
    """Alternate intense bursts and light recovery, as in high-intensity interval training (Figure 10a).

    Examples
    --------
    >>> [block.intensity for block in hiit()]
    ['intense', 'light', 'intense', 'light']
    """
    levels: tuple[Intensity, Intensity] = ("intense", "light")
    return tuple(
        BlockPlan(duration_s=block_s, intensity=level, variety=variety)
        for _ in range(rounds)
        for level in levels
    )


def variety_waves(
    *, rounds: int = 2, block_s: float = BLOCK_S, intensity: Intensity | float = "light"
) -> Schedule:
    """Alternate stretches that are easy and hard to remember (Figure 10b)."""
    levels: tuple[Variety, Variety] = ("easy", "hard")
    return tuple(
        BlockPlan(duration_s=block_s, intensity=intensity, variety=level)
        for _ in range(rounds)
        for level in levels
    )


def warm_up(*, work_s: float = 2 * BLOCK_S) -> Schedule:
    """Warm up, work, cool down: light and easy at both ends, intense and varied between."""
    gentle = BlockPlan(intensity="light", variety="easy")
    return (gentle, BlockPlan(duration_s=work_s, intensity="intense", variety="hard"), gentle)


def heart_rate_profile(
    heart_rates_bpm: Sequence[float],
    *,
    light_bpm: float,
    intense_bpm: float,
    block_s: float = BLOCK_S,
    variety: Variety | float = "easy",
) -> Schedule:
    """Follow a heart-rate curve, block by block, for a person whose heart is known in two dances.

    Parameters
    ----------
    heart_rates_bpm : sequence of float
        The heart rate wanted at the end of each block.
    light_bpm, intense_bpm : float
        What the person's heart rate settles at in light and in intense dances (the 25th and the 75th
        percentile of the library); between and beyond, percentiles follow a straight line.
    block_s : float
        Length of each block.
    variety : {"easy", "hard"} or float
        Of every block.

    Raises
    ------
    InputError
        If light dances do not have the lower heart rate, or a heart rate lies beyond what dances of the
        library can ask for.

    Examples
    --------
    >>> [block.intensity for block in heart_rate_profile([100, 120, 140], light_bpm=100, intense_bpm=140)]
    [25.0, 50.0, 75.0]
    """
    if not 0.0 < light_bpm < intense_bpm < math.inf:
        raise InputError(
            f"light dances at {light_bpm:g} and intense ones at {intense_bpm:g} beats a minute",
            where="light_bpm",
            remedy="give what the heart settles at in either, the light one lower",
        )
    bpm_each = (intense_bpm - light_bpm) / 50.0
    blocks = []
    for number, bpm in enumerate(heart_rates_bpm):
        percentile = 25.0 + (bpm - light_bpm) / bpm_each
        if not 0.0 <= percentile <= 100.0:
            low, high = light_bpm - 25.0 * bpm_each, intense_bpm + 25.0 * bpm_each
            raise InputError(
                f"{bpm:g} beats a minute are beyond these dances",
                where=f"block {number + 1}",
                remedy=f"ask for {low:g} to {high:g}",
            )
        blocks.append(BlockPlan(duration_s=block_s, intensity=float(percentile), variety=variety))
    return tuple(blocks)


SCHEDULES: dict[str, Callable[[], Schedule]] = {
    "hiit": hiit,
    "waves": variety_waves,
    "warm-up": warm_up,
}
"""Ready-made schedules by name."""


def schedule(name: str) -> Schedule:
    """Give a ready-made schedule.

    Raises
    ------
    InputError
        If there is none of this name.
    """
    if name not in SCHEDULES:
        raise InputError(
            f'there is no schedule "{name}"', where="schedule", remedy=f"choose from {', '.join(SCHEDULES)}"
        )
    return SCHEDULES[name]()
