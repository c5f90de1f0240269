"""What was measured of people from moment to moment of a dance: a mean and its interval."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from studykit.core.arrays import Floats, frozen
from studykit.figures.samples import mean_interval

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PeopleCurve:
    """One measure of everybody who danced a dance, over the time of that dance.

    Parameters
    ----------
    label : str
        What the axis says, such as "Heart rate (beats/min)".
    times_s : array_like, shape (time,), s
        From the start of the dance.
    values : array_like, shape (participant, time)
        NaN where unknown.
    """

    label: str
    times_s: Floats
    values: Floats

    def __post_init__(self) -> None:
        times = len(self.times_s)
        object.__setattr__(self, "times_s", frozen(self.times_s, shape=(times,), name="times_s"))
        object.__setattr__(self, "values", frozen(self.values, shape=(None, times), name="values"))


def draw_people(axes: Axes, curve: PeopleCurve, colour: str) -> None:
    """Draw the mean over participants with its 95 % interval."""
    intervals = [mean_interval(column) for column in curve.values.T]
    lows, highs = ([getattr(one, end) for one in intervals] for end in ("low", "high"))
    axes.fill_between(curve.times_s, lows, highs, color=colour, alpha=0.25, linewidth=0.0)
    axes.plot(
        curve.times_s, np.array([one.mean for one in intervals]), color=colour, linewidth=0.8, gid="people"
    )
