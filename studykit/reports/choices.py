"""Which of several defensible ways of measuring is taken."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from studykit.analysis.dynamic_time_warping import Definition
from studykit.analysis.heart_rate import Maximum
from studykit.protocol.study_protocol import StudyProtocol

Window = Literal["perform", "perform+30", "watch+perform"]
"""When the heart rate counts."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Choices:
    """How trials are measured; `Choices.of` gives what a protocol says.

    Parameters
    ----------
    window : {"perform", "perform+30", "watch+perform"}
        When the heart rate counts: while dancing, 30 s longer, or from watching the dance on.
    heart_source : {"belt", "beats"}
        What the belt says, or the times between beats after `analysis.beats.corrected`.
    maximum : {"tanaka", "fox", "measured"}
        Where the highest heart rate comes from.
    vigorous_fraction : float
        Exercise is vigorous at or above this share of the maximum.
    longest_gap_s : float
        Where the belt was silent for longer, s, the silence counts for nothing.
    definition : {"mean_joint_distance", "tslearn"}
        What the distance from the guide is; see `align`.
    band_s : float or None
        By how much a dancer may be early or late, s; None for any time.
    repetition : {"last", "first"}
        Which one counts where a condition was danced to its end more than once.
    least_coverage : float
        A trial counts if heart rate and skeleton were seen for at least this share of it, 0 to 1.
    """

    window: Window
    heart_source: Literal["belt", "beats"] = "belt"
    maximum: Maximum
    vigorous_fraction: float
    longest_gap_s: float
    definition: Definition = "mean_joint_distance"
    band_s: float | None
    repetition: Literal["last", "first"] = "last"
    least_coverage: float = 0.0

    @classmethod
    def of(cls, protocol: StudyProtocol) -> Choices:
        """Give the choices that a protocol declares."""
        heart = protocol.heart_rate
        return cls(
            window=heart.window,
            maximum=heart.maximum,
            vigorous_fraction=heart.vigorous_fraction,
            longest_gap_s=heart.longest_gap_s,
            band_s=protocol.movement.band_s,
        )
