"""A review without its widget: what was flagged, what was decided, and how the last decision is undone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, Protocol

from studykit.core.errors import InputError
from studykit.widgets.player.material import Mark

if TYPE_CHECKING:
    import pandas as pd

    from studykit.io.datasets.take import Take

Decision = Literal["", "keep", "cut"]
DECISIONS: Final[tuple[Decision, ...]] = ("", "keep", "cut")
"""What can be decided on a stretch; an empty word takes a decision back."""
_KINDS: Final[dict[Decision, str]] = {"": "flag", "keep": "keep", "cut": "cut"}
_VERDICTS: Final[dict[Decision, str]] = {"": "", "keep": " (kept)", "cut": " (cut)"}
_SAME_S: Final = 1e-3  # times closer than this are the same: no camera takes 1000 frames a second


class Source(Protocol):
    """Where findings come from and decisions go to: `studykit.library.review`, or one in its place."""

    def findings(self, library: Path) -> pd.DataFrame:
        """Give what was flagged and decided, one row a stretch."""

    def take_again(self, library: Path, name: str) -> Take:
        """Give a take as it was before cleaning."""

    def decide(  # noqa: PLR0913 - the words of one decision
        self,
        library: Path,
        *,
        take: str,
        start_s: float,
        stop_s: float,
        decision: Decision,
        note: str,
        reviewer: str,
    ) -> None:
        """Save a decision."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Stretch:
    """A piece of a take that a rule flagged or a person chose.

    Parameters
    ----------
    take : str
        Which take.
    start_s, stop_s : float, s
        From and to.
    rule, joint : str
        What was flagged, and where on the body; empty for a stretch of one's own.
    decision : {"", "keep", "cut"}
        What was decided; empty while it is open.
    note, reviewer : str
        Why, and by whom.
    """

    take: str
    start_s: float
    stop_s: float
    rule: str = ""
    joint: str = ""
    decision: Decision = ""
    note: str = ""
    reviewer: str = ""

    @property
    def words(self) -> str:
        """What was flagged, in words."""
        return ", ".join(word for word in (self.rule, self.joint) if word) or "chosen by hand"

    @property
    def mark(self) -> Mark:
        """The stretch on a line of time."""
        return self.start_s, self.stop_s, self.words + _VERDICTS[self.decision], _KINDS[self.decision]

    def is_at(self, start_s: float, stop_s: float) -> bool:
        """Whether this stretch has these limits."""
        return abs(self.start_s - start_s) < _SAME_S and abs(self.stop_s - stop_s) < _SAME_S


class Desk:
    """One reviewer's work on one library; every decision is saved at once.

    Parameters
    ----------
    library : Path
        The library's folder.
    reviewer : str
        Who decides; stands beside each decision.
    source : Source
        Where findings come from and decisions go to.
    takes : sequence of str
        Takes that can be reviewed though nothing is flagged in them.

    Raises
    ------
    InputError
        If the reviewer has no name.
    """

    def __init__(self, library: Path, *, reviewer: str, source: Source, takes: Sequence[str] = ()) -> None:
        if not isinstance(reviewer, str) or not reviewer.strip():
            raise InputError(
                "nobody is named", where="reviewer", remedy='name who decides, such as reviewer="MK"'
            )
        self.library, self.reviewer, self._source = Path(library), reviewer.strip(), source
        self._takes = tuple(takes)
        self._before: list[Stretch] = []
        self.read()

    def read(self) -> None:
        """Read the findings again."""
        table = self._source.findings(self.library)
        names = list(Stretch.__dataclass_fields__)
        columns = [table[name].tolist() for name in names]
        self.stretches = [
            Stretch(**{name: _plain(name, value) for name, value in zip(names, row, strict=True)})
            for row in zip(*columns, strict=True)
        ]

    def takes(self) -> list[dict[str, Any]]:
        """Give the takes, with how many stretches each has and how many of them are open."""
        counts = {take: [0, 0] for take in self._takes}
        for stretch in self.stretches:
            count = counts.setdefault(stretch.take, [0, 0])
            count[0] += 1
            count[1] += stretch.decision == ""
        return [{"name": name, "total": count[0], "open": count[1]} for name, count in sorted(counts.items())]

    def of_take(self, take: str) -> list[Stretch]:
        """Give the stretches of a take in the order of time."""
        mine = [stretch for stretch in self.stretches if stretch.take == take]
        return sorted(mine, key=lambda stretch: (stretch.start_s, stretch.stop_s))

    def decided(self) -> list[Stretch]:
        """Give the stretches that were decided."""
        return [stretch for stretch in self.stretches if stretch.decision]

    def play(self, take: str) -> Take:
        """Give a take as it was before cleaning."""
        return self._source.take_again(self.library, take)

    @property
    def can_undo(self) -> bool:
        """Whether anything was decided since the review was opened."""
        return bool(self._before)

    def decide(self, *, take: str, start_s: float, stop_s: float, decision: str, note: str = "") -> None:
        """Save a decision on a stretch, flagged or of one's own.

        Raises
        ------
        InputError
            If the decision is another word or the stretch has no length.
        """
        word = next((each for each in DECISIONS if each == decision), None)
        if word is None:
            raise InputError(
                f"the decision is {decision!r}", where=take, remedy=f"decide one of {list(DECISIONS)}"
            )
        if not 0.0 <= start_s < stop_s:
            raise InputError(
                f"the stretch goes from {start_s:g} s to {stop_s:g} s",
                where=take,
                remedy="choose an end that comes after the beginning",
            )
        same = [stretch for stretch in self.of_take(take) if stretch.is_at(start_s, stop_s)]
        before = same[0] if same else Stretch(take=take, start_s=start_s, stop_s=stop_s)
        self._save(before, word, note)
        self._before.append(before)

    def undo(self) -> Stretch:
        """Give a stretch the decision back that it had before the last one.

        Raises
        ------
        InputError
            If nothing was decided since the review was opened.
        """
        if not self._before:
            raise InputError("there is nothing to undo", where=self.library, remedy="decide something first")
        before = self._before[-1]
        self._save(before, before.decision, before.note)
        self._before.pop()
        return before

    def _save(self, stretch: Stretch, decision: Decision, note: str) -> None:
        self._source.decide(
            self.library,
            take=stretch.take,
            start_s=stretch.start_s,
            stop_s=stretch.stop_s,
            decision=decision,
            note=note,
            reviewer=self.reviewer,
        )
        self.read()


def _plain(name: str, value: Any) -> Any:
    """Give a cell as a number or a word; what is missing is an empty word."""
    if name.endswith("_s"):
        return float(value)
    return value if isinstance(value, str) else ""
