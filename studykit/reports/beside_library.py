"""A dance beside the library that it was made of: how good its joins are, how strict its limits."""

from __future__ import annotations

from dataclasses import dataclass
from math import isnan
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.motion.join_quality import join_quality, jolting_share, usual_acceleration
from studykit.reports.numbers import number

if TYPE_CHECKING:
    from studykit.choreography.dance import Dance
    from studykit.choreography.dance_library import DanceLibrary

_ENOUGH = 200
"""Segments, spread over the library, that tell what is usual."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class BesideLibrary:
    """What the dancers of a library do themselves.

    Parameters
    ----------
    library : DanceLibrary
        Theirs.
    acceleration : float, m/s^2
        What joints stay below in 99.9 % of all cases: see `join_quality.usual_acceleration`.
    jolting : float
        Share of stretches as long as a join in which they go beyond it nevertheless.
    """

    library: DanceLibrary
    acceleration: float
    jolting: float

    @classmethod
    def measured(cls, library: DanceLibrary) -> BesideLibrary:
        """Measure what is usual on segments spread over a library, at most 200."""
        rows = np.linspace(0, len(library) - 1, min(len(library), _ENOUGH)).round().astype(int)
        segments = [library.motion(row) for row in rows.tolist()]
        usual = usual_acceleration(segments)
        return cls(library=library, acceleration=usual, jolting=jolting_share(segments, usual))

    def joins(self, dance: Dance) -> dict[str, Any] | None:
        """Tell how good the joins of a dance are; None where it has none.

        Returns
        -------
        dict
            `words`; `hardest`, `usual` (m/s^2); `beyond`, `count` (joins); `share`, `usual_share` (of joins,
            of stretches as long); `sliding`, `join_sliding` (multiples of that in the segments, None where no
            foot is low).
        """
        if len(dance.segments) < 2:
            return None
        found = join_quality([self.library.motion(one.id) for one in dance.segments], dance.motion)
        count, beyond = len(found.accelerations), int((found.accelerations > self.acceleration).sum())
        return {
            "words": f"{self._jolts(beyond, count)}{_slides(found.sliding)}.",
            "hardest": float(found.accelerations.max()),
            "usual": self.acceleration,
            "beyond": beyond,
            "count": count,
            "share": beyond / count,
            "usual_share": self.jolting,
            "sliding": None if isnan(found.sliding) else found.sliding,
            "join_sliding": None if isnan(found.join_sliding) else found.join_sliding,
        }

    def _jolts(self, beyond: int, count: int) -> str:
        usually = f"than dancers do in all but a thousandth of cases ({number(self.acceleration, 0)} m/s²)"
        if not beyond:
            return f"As shown, no join jolts harder {usually}"
        return f"As shown, {beyond} of {count} joins {'jolts' if beyond == 1 else 'jolt'} harder {usually}"


def _slides(multiple: float) -> str:
    if isnan(multiple):
        return ""
    if multiple < 1.005:
        return ", and feet near the floor slide no faster than in the segments"
    return f", and feet near the floor slide {number(multiple, 2)} times as fast as in the segments"
