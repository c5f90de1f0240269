"""The widget for blinded rating; imported only when one is made."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import traitlets

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.errors import InputError
from studykit.library.rating import SCALES, RatingSheet, window_motion
from studykit.library.rating.plan import require_window
from studykit.motion.kinematics import joint_positions
from studykit.widgets.player.widget import MotionPlayer

if TYPE_CHECKING:
    import pandas as pd

_QUESTIONS = {
    "intensity": "How hard would this be for the body?",
    "variety": "How hard would this be to learn and follow?",
}


def rating(library: DanceLibrary, *, plan: pd.DataFrame, sheet: str | Path, rater: str) -> Rater:
    """Let one dancer say of each dance whether it is light or intense, easy or hard, without knowing more.

    Parameters
    ----------
    library : DanceLibrary
        The library that the plan was made for.
    plan : DataFrame
        Which dances are shown to whom; see `studykit.library.rating.rating_plan`.
    sheet : str or Path
        The file of the answers. Every answer is saved at once; opened again, the rating goes on where it
        was left.
    rater : str
        Who answers, as in the plan.

    Returns
    -------
    Rater
        Show it as the last line of a cell.

    Raises
    ------
    InputError
        If the plan has no such rater, is of another library, or the file is no sheet of this plan.
    """
    return Rater(library, plan=plan, sheet=RatingSheet(sheet, plan), rater=rater)


class Rater(MotionPlayer):
    """A player of dances that nothing is told about, and two questions on each.

    Parameters
    ----------
    library : DanceLibrary
        Where the dances are.
    plan : DataFrame
        Which dances are shown to whom.
    sheet : RatingSheet
        Where the answers are kept.
    rater : str
        Who answers.
    """

    questions = traitlets.List(traitlets.Dict(), read_only=True).tag(sync=True)
    total = traitlets.Int(read_only=True).tag(sync=True)
    done = traitlets.Int().tag(sync=True)
    turn = traitlets.Int().tag(sync=True)
    can_undo = traitlets.Bool().tag(sync=True)
    status = traitlets.Unicode().tag(sync=True)

    def __init__(self, library: DanceLibrary, *, plan: pd.DataFrame, sheet: RatingSheet, rater: str) -> None:
        self._library, self._sheet, self._rater = library, sheet, rater
        own = plan[plan["rater"].astype(str) == rater]
        self._segments = {
            int(window): tuple(int(segment) for segment in segments)
            for window, segments in zip(own["window"], own["segments"], strict=True)
        }
        remaining = sheet.remaining(rater)
        for segments in self._segments.values():
            require_window(library, segments)
        self.set_trait("room", "rater")
        self.set_trait("total", len(self._segments))
        self.set_trait(
            "questions",
            [
                {
                    "name": scale,
                    "words": _QUESTIONS[scale],
                    "answers": [[answer, answer.capitalize()] for answer in answers],
                }
                for scale, answers in SCALES.items()
            ],
        )
        super().__init__(is_looping=False, is_synthetic=library.is_synthetic)
        self.on_msg(lambda _, message, __: self._heed(message))
        self._go_on(remaining, is_playing=False)

    @traitlets.validate("speed")
    def _speed_is_as_danced(self, proposal: Any) -> float:
        if proposal["value"] != 1.0:
            raise InputError(
                "a dance at another speed is another dance", where="speed", remedy="rate it as danced"
            )
        return 1.0

    def answer(self, *, intensity: str, variety: str) -> None:
        """Save both answers on the dance that plays, and go on to the next.

        Raises
        ------
        InputError
            If an answer is no answer, all dances are rated, or the answers cannot be saved.
        """
        remaining = self._sheet.remaining(self._rater)
        if not remaining:
            raise InputError(
                "all dances are rated", where=self._sheet.path, remedy="undo the last answer to change it"
            )
        self._sheet.record(rater=self._rater, window=remaining[0], intensity=intensity, variety=variety)
        self._go_on(remaining[1:], is_playing=True)
        self.status = "Saved."

    def undo(self) -> None:
        """Take the last answer back and show its dance again.

        Raises
        ------
        InputError
            If there is no answer to take back.
        """
        self._sheet.undo(self._rater)
        self._go_on(self._sheet.remaining(self._rater), is_playing=False)
        self.status = "The last answer was taken back."

    def _go_on(self, remaining: tuple[int, ...], *, is_playing: bool) -> None:
        """Show the first of the dances that remain; nothing but its movement crosses to the browser."""
        with self.hold_sync():
            self.done = self.total - len(remaining)
            self.can_undo = self.done > 0
            self.turn += 1
            if not remaining:
                self.show(np.zeros((0, len(self.parents), 3)), is_playing=False)
                return
            motion = window_motion(self._library, self._segments[remaining[0]])
            self.show(joint_positions(motion), frame_rate_hz=motion.frame_rate_hz, is_playing=is_playing)

    def _heed(self, message: Any) -> None:
        """Act on what was pressed in the browser."""
        try:
            match message:
                case {"deed": "answer", "turn": int(turn), "answers": {**answers}} if turn == self.turn:
                    self.answer(
                        intensity=str(answers.get("intensity", "")), variety=str(answers.get("variety", ""))
                    )
                case {"deed": "undo"}:
                    self.undo()
                case _:
                    self.status = "Nothing was saved: this dance is no longer the one that is asked about."
        except (InputError, OSError) as error:
            self.status = f"Not done. {error}"
