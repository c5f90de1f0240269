"""A dance in the player, with its segments on the line of time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from studykit.figures.film import letters
from studykit.motion.kinematics import joint_positions
from studykit.motion.segmentation import SEGMENT_S

if TYPE_CHECKING:
    from studykit.choreography.dance import Dance, DanceSegment
    from studykit.widgets.player.material import Mark
    from studykit.widgets.player.widget import MotionPlayer

_GAP_S = 0.1  # so that neighbours can be told apart


def watch(dance: Dance) -> MotionPlayer:
    """Play a dance in the notebook, from any side, as danced or as in a mirror.

    Parameters
    ----------
    dance : Dance
        As `studykit.choreograph` and `studykit.library.read_dances` give them.

    Returns
    -------
    MotionPlayer
        Show it as the last line of a cell. The marks are the segments; the same letter is the same movement.
    """
    from studykit.widgets.player.widget import MotionPlayer

    return MotionPlayer(
        positions=joint_positions(dance.motion),
        frame_rate_hz=dance.motion.frame_rate_hz,
        title=f"{dance.condition}, {dance.motion.duration_s:g} s, seed {dance.seed}",
        is_synthetic=dance.is_synthetic,
        marks=segment_marks(dance),
    )


def segment_marks(dance: Dance) -> list[Mark]:
    """Mark each segment of a dance with its letter and where it comes from."""
    return [
        (
            SEGMENT_S * place,
            SEGMENT_S * (place + 1) - _GAP_S,
            f"{letter}: {origin(segment)}",
            "note",
        )
        for place, (letter, segment) in enumerate(zip(letters(dance), dance.segments, strict=True))
    ]


def origin(segment: DanceSegment) -> str:
    """Say where a segment comes from."""
    return f"{segment.take}{', mirrored' if segment.mirrored else ''}, from {segment.start_s:.1f} s"
