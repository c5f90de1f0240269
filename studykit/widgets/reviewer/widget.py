"""The widget for reviewing takes; imported only when one is made."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import traitlets

from studykit.core.errors import InputError
from studykit.motion.kinematics import joint_positions
from studykit.widgets.player.material import thinned
from studykit.widgets.player.widget import MotionPlayer
from studykit.widgets.reviewer.desk import Desk, Source, Stretch

if TYPE_CHECKING:
    from studykit.io.datasets.take import Take

BUILD_AGAIN = "To apply it, build the library again: run `studykit library build ...`."
_SHOWN_DECISIONS = 200


def review(library_folder: str | Path, *, reviewer: str, source: Source | None = None) -> Reviewer:
    """See again what was flagged in the takes of a library, and decide what is kept and what is cut.

    Parameters
    ----------
    library_folder : str or Path
        The library's folder.
    reviewer : str
        Who decides; stands beside each decision.
    source : Source, optional
        Where findings come from and decisions go to; the library itself if not given.

    Returns
    -------
    Reviewer
        Show it as the last line of a cell.

    Raises
    ------
    InputError
        If the folder cannot be reviewed or nobody is named.
    """
    folder = Path(library_folder)
    takes: tuple[str, ...] = ()
    if source is None:
        from studykit.library import review as own

        source, takes = own, _takes(folder)
    return Reviewer(Desk(folder, reviewer=reviewer, source=source, takes=takes))


def _takes(library: Path) -> tuple[str, ...]:
    """Name all takes of a library, also those in which nothing was flagged."""
    import pandas as pd

    from studykit.library import store

    table = pd.read_csv(store.index_folder(library) / store.TAKES, keep_default_na=False)
    return tuple(table.loc[table["status"] != "refused", "take"].astype(str))


class Reviewer(MotionPlayer):
    """A player with the flagged stretches of takes.

    Parameters
    ----------
    desk : Desk
        The review itself.
    """

    takes = traitlets.List(traitlets.Dict()).tag(sync=True)
    take = traitlets.Unicode().tag(sync=True)
    stretches = traitlets.List(traitlets.Dict()).tag(sync=True)
    chosen = traitlets.Int(-1).tag(sync=True)
    decisions = traitlets.List(traitlets.Unicode()).tag(sync=True)
    decided = traitlets.Int().tag(sync=True)
    can_undo = traitlets.Bool().tag(sync=True)
    status = traitlets.Unicode().tag(sync=True)

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self.set_trait("room", "reviewer")
        super().__init__(is_looping=False)
        self.on_msg(lambda _, message, __: self._heed(message))
        self._refresh()
        if not self.takes:
            self.status = "There is no take to review in this library."
            return
        first = next((take for take in self.takes if take["open"]), self.takes[0])
        self._try(lambda: self.open_take(first["name"]))

    def open_take(self, name: str) -> None:
        """Play a take from the start of what was cleaned.

        Raises
        ------
        InputError
            If the library has no such take or its recording is no longer there.
        """
        if name not in {take["name"] for take in self.takes}:
            raise InputError(
                f"there is no take {name!r} to review",
                where=self._desk.library,
                remedy="choose one of the takes that are listed",
            )
        take = self._desk.play(name)
        positions, rate_hz = thinned(joint_positions(take.motion), take.motion.frame_rate_hz)
        partner, trouble = self._partner(name, take)
        with self.hold_sync():
            self.take, self.chosen, self.status = name, -1, trouble
            self._refresh()
            self.show(
                positions,
                ghost=partner,
                frame_rate_hz=rate_hz,
                title=f"{name} ({take.source.data_set}), as recorded",
                is_synthetic=take.source.is_synthetic,
                is_playing=False,
            )

    def _partner(self, name: str, take: Take) -> tuple[Any, str]:
        """Give the movement of the dancer who danced along, and what stands against showing it."""
        known, prefix = {each["name"] for each in self.takes}, name.removesuffix(take.name)
        for partner in (prefix + each for each in take.source.partners):
            if partner not in known:
                continue
            try:
                other = self._desk.play(partner).motion
            except (InputError, OSError) as error:
                return None, f"The partner cannot be shown. {error}"
            if other.frame_rate_hz == take.motion.frame_rate_hz:
                return thinned(joint_positions(other), other.frame_rate_hz)[0], ""
            return None, f"The partner {partner} was recorded at another rate and cannot be shown."
        return None, ""

    def decide(self, start_s: float, stop_s: float, decision: str, *, note: str = "") -> None:
        """Save a decision on a stretch of the take that plays: "keep", "cut", or "" to take it back.

        Raises
        ------
        InputError
            If the stretch or the decision cannot be used.
        """
        if not self.take:
            raise InputError("no take is open", where=self._desk.library, remedy="open a take first")
        self._desk.decide(take=self.take, start_s=start_s, stop_s=stop_s, decision=decision, note=note)
        self._refresh()
        self.chosen = next(
            (k for k, each in enumerate(self._desk.of_take(self.take)) if each.is_at(start_s, stop_s)), -1
        )
        self.status = f"Saved. {BUILD_AGAIN}"

    def undo(self) -> None:
        """Take the last decision back and show the take that it was about.

        Raises
        ------
        InputError
            If nothing was decided since the review was opened.
        """
        stretch = self._desk.undo()
        self._refresh()
        if stretch.take != self.take and stretch.take in {take["name"] for take in self.takes}:
            self.open_take(stretch.take)
        self.status = f"Taken back: {_sentence(stretch)}. {BUILD_AGAIN}"

    def _refresh(self) -> None:
        mine, decided = self._desk.of_take(self.take), self._desk.decided()
        with self.hold_sync():
            self.takes = self._desk.takes()
            self.stretches = [
                {
                    "start_s": each.start_s,
                    "stop_s": each.stop_s,
                    "words": each.words,
                    "decision": each.decision,
                    "note": each.note,
                }
                for each in mine
            ]
            self.marks = [each.mark for each in mine]
            self.decided = len(decided)
            self.decisions = [_sentence(each) for each in decided[-_SHOWN_DECISIONS:]]
            self.can_undo = self._desk.can_undo

    def _heed(self, message: Any) -> None:
        """Act on what was pressed in the browser."""
        match message:
            case {"deed": "take", "take": str(name)}:
                self._try(lambda: self.open_take(name))
            case {
                "deed": "decide",
                "start_s": float() | int() as start_s,
                "stop_s": float() | int() as stop_s,
                "decision": str(decision),
                "note": str(note),
            } if np.isfinite([start_s, stop_s]).all():
                self._try(lambda: self.decide(start_s, stop_s, decision, note=note))
            case {"deed": "undo"}:
                self._try(self.undo)
            case _:
                self.status = "The browser asked for something that a review does not know."

    def _try(self, deed: Any) -> None:
        try:
            deed()
        except (InputError, OSError) as error:
            self.status = f"Not done. {error}"


def _sentence(stretch: Stretch) -> str:
    verdict = {"keep": "kept", "cut": "cut", "": "open"}[stretch.decision]
    who = f" by {stretch.reviewer}" if stretch.reviewer else ""
    why = f": {stretch.note}" if stretch.note else ""
    return (
        f"{stretch.take}, {stretch.start_s:.2f}–{stretch.stop_s:.2f} s, {stretch.words}: {verdict}{who}{why}"
    )
