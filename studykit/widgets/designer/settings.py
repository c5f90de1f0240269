"""What can be set in the designer, checked as it is set."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from studykit.core.errors import InputError
from studykit.motion.segmentation import SEGMENT_S
from studykit.widgets.body_map.spared import checked_speeds, checked_weights

LONGEST_S: Final = 256.0
RANGES: Final[dict[str, tuple[float, float]]] = {
    "duration_s": (SEGMENT_S, LONGEST_S),
    "intensity": (0.0, 100.0),
    "variety": (0.05, 1.5),
}
"""Least and most that can be asked for."""
SCHEDULES: Final = {
    "none": "the same throughout",
    "hiit": "intervals: intense and light in turn (HIIT)",
    "waves": "waves: easy and hard in turn",
    "warm-up": "warm-up, work, cool-down",
}
"""The schedules that a dance can have, with their words."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Settings:
    """What is asked of a dance, in a physiotherapist's words.

    Parameters
    ----------
    duration_s : float, s
        A multiple of 4 s.
    intensity : float, %
        Share of the library's own random dances that ask less of the body.
    variety : float
        Share of the median distance between unrelated segments.
    transition : bool
        Whether joins are searched that are smooth.
    schedule : {"none", "hiit", "waves", "warm-up"}
        Blocks of the dance that differ, if any.
    seed : int
        Other seeds give other dances.
    weights, speed_limits_rad_s : dict of str to float
        The joints to spare; see `SparedJoints`.

    Raises
    ------
    InputError
        If a value cannot be used.
    """

    duration_s: float = 32.0
    intensity: float = 75.0
    variety: float = 0.55
    transition: bool = True
    schedule: str = "none"
    seed: int = 0
    weights: dict[str, float] = field(default_factory=dict)
    speed_limits_rad_s: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in self.__slots__:
            checked(name, getattr(self, name))


def checked(name: str, value: Any) -> Any:
    """Check the value of one setting, and give it as it is kept.

    Raises
    ------
    InputError
        Says what the setting can be.

    Examples
    --------
    >>> checked("duration_s", 64), checked("schedule", "hiit")
    (64.0, 'hiit')
    """
    if name in RANGES:
        return _number(name, value)
    if name == "schedule" and value not in SCHEDULES:
        raise InputError(
            f"there is no schedule {value!r}", where=name, remedy=f"choose from {', '.join(SCHEDULES)}"
        )
    if name == "transition" and not isinstance(value, bool):
        raise InputError(f"the transition is {value!r}", where=name, remedy="say True or False")
    if name == "seed" and (isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**53):
        raise InputError(f"the seed is {value!r}", where=name, remedy="give a whole number, 0 or more")
    if name == "weights":
        return checked_weights(value)
    if name == "speed_limits_rad_s":
        return checked_speeds(value, where=name)
    return value


def _number(name: str, value: Any) -> float:
    least, most = RANGES[name]
    is_number = isinstance(value, int | float) and not isinstance(value, bool) and np.isfinite(value)
    if not is_number or not least <= value <= most:
        raise InputError(f"the value is {value!r}", where=name, remedy=f"give {least:g} to {most:g}")
    if name == "duration_s" and value % SEGMENT_S:
        nearest = max(round(value / SEGMENT_S), 1) * SEGMENT_S
        raise InputError(
            f"{value:g} s is not a multiple of {SEGMENT_S:g} s", where=name, remedy=f"ask for {nearest:g} s"
        )
    return float(value)
