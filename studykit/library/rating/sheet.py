"""The sheet on which raters' answers are kept: safe against power cuts, and nothing is ever erased."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final

from studykit.core.errors import InputError
from studykit.library.rating.plan import PLAN_COLUMNS, SCALES

if TYPE_CHECKING:
    import pandas as pd

_COLUMNS: Final = ("event", "rater", "window", "segments", "intensity", "variety")
_OF: Final = " of "  # between the rows of a window and the library that they are rows of
_LARGEST_BYTES = 16_000_000
_HEADER = (",".join(_COLUMNS) + "\n").encode()


@dataclass(slots=True)
class _Content:
    """What a sheet says: the answers that stand, in the order given, and where its last whole line ends."""

    answers: dict[tuple[str, int], tuple[str, str]] = field(default_factory=dict)
    end: int = 0
    is_terminated: bool = True


class RatingSheet:
    """A CSV file of answers to which lines are only ever added.

    Each line is `event` ("rated" or "withdrawn"), `rater`, `window`, its `segments`, and the answers
    `intensity` and `variety`. An answer is on the disk when `record` returns. Opening a sheet again goes on
    where it ended; half a line left at the end by a power cut, which was never confirmed to the rater, is
    dropped with the next answer.

    Parameters
    ----------
    path : str or Path
        The file; it is made with the first answer.
    plan : DataFrame
        What is to be rated; see `rating_plan`.

    Raises
    ------
    InputError
        If the plan is none, or the file is there and is no sheet of this plan: names file and line.
    """

    def __init__(self, path: str | Path, plan: pd.DataFrame) -> None:
        self.path = Path(path)
        if not set(PLAN_COLUMNS) <= set(plan.columns) or plan.empty:
            raise InputError("this is no plan of ratings", where="plan", remedy="make one with rating_plan")
        self._orders: dict[str, list[int]] = {}
        self._segments: dict[int, str] = {}
        ordered = plan.sort_values("order", kind="stable")
        for rater, window, segments, library in zip(
            *(ordered[name] for name in ("rater", "window", "segments", "library")), strict=True
        ):
            self._orders.setdefault(str(rater), []).append(int(window))
            self._segments[int(window)] = f"{' '.join(map(str, segments))}{_OF}{library}"
        self._read()

    def remaining(self, rater: str) -> tuple[int, ...]:
        """Give the windows that a rater has still to rate, in the order of showing."""
        order = self._order(rater)
        answers = self._read().answers
        return tuple(window for window in order if (rater, window) not in answers)

    def record(self, *, rater: str, window: int, intensity: str, variety: str) -> None:
        """Write down one answer and return once the disk has it.

        Parameters
        ----------
        rater, window : str, int
            Who answers about what, as in the plan.
        intensity : {"light", "intense"}
        variety : {"easy", "hard"}

        Raises
        ------
        InputError
            If the plan has no such rater or window, the answer is none, the window was rated already, or the
            file cannot be written.
        """
        if window not in self._order(rater):
            raise InputError(
                f"{rater} is not asked about window {window}",
                where=self.path,
                remedy="rate the windows of the plan",
            )
        for scale, answer in (("intensity", intensity), ("variety", variety)):
            _check_answer(scale, answer, self.path)
        content = self._read()
        if (rater, window) in content.answers:
            raise InputError(
                f"{rater} has rated window {window} already",
                where=self.path,
                remedy="withdraw that answer first",
            )
        self._append(content, ("rated", rater, window, self._segments[window], intensity, variety))

    def undo(self, rater: str) -> int:
        """Withdraw a rater's last answer, and give its window; the sheet keeps both lines.

        Raises
        ------
        InputError
            If there is no answer to withdraw, or the file cannot be written.
        """
        self._order(rater)
        content = self._read()
        own = [window for who, window in content.answers if who == rater]
        if not own:
            raise InputError(
                f"{rater} has no answer to withdraw", where=self.path, remedy="rate a window first"
            )
        self._append(content, ("withdrawn", rater, own[-1], self._segments[own[-1]], "", ""))
        return own[-1]

    def ratings(self) -> pd.DataFrame:
        """Give the answers that stand, one row each: `rater`, `window`, `intensity`, `variety`."""
        import pandas as pd

        rows = [(*key, *answers) for key, answers in self._read().answers.items()]
        return pd.DataFrame(rows, columns=["rater", "window", "intensity", "variety"])

    def _order(self, rater: str) -> Sequence[int]:
        if rater not in self._orders:
            raise InputError(
                f'the plan has no rater "{rater}"', where=self.path, remedy=f"use {', '.join(self._orders)}"
            )
        return self._orders[rater]

    def _append(self, content: _Content, fields: tuple[str | int, ...]) -> None:
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerow(fields)
        line = text.getvalue().encode()
        if content.end == 0:
            line = _HEADER + line
        elif not content.is_terminated:
            line = b"\n" + line
        is_new = not self.path.exists()
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("ab", buffering=0) as file:
                file.truncate(content.end)  # half a line that a power cut left
                while line:
                    line = line[file.write(line) :]
                os.fsync(file.fileno())
            if is_new and os.name == "posix":
                folder = os.open(self.path.parent, os.O_RDONLY)
                try:
                    os.fsync(folder)
                finally:
                    os.close(folder)
        except OSError as error:
            raise InputError(
                f"the answer cannot be written ({(error.strerror or str(error)).lower()})",
                where=self.path,
                remedy="choose another folder or free some space",
            ) from error

    def _read(self) -> _Content:
        try:
            if not self.path.exists():
                return _Content()
            with self.path.open("rb") as file:
                data = file.read(_LARGEST_BYTES + 1)
        except OSError as error:
            raise InputError(
                f"the sheet cannot be read ({(error.strerror or str(error)).lower()})",
                where=self.path,
                remedy="choose another file",
            ) from error
        if len(data) > _LARGEST_BYTES:
            raise InputError("this is no rating sheet", where=self.path, remedy="choose another file")
        if not data.startswith(_HEADER):
            if _HEADER.startswith(data):
                return _Content()  # power was cut while the first line was being written
            raise InputError(
                "this is no rating sheet", where=f"{self.path}, line 1", remedy="choose another file"
            )
        content = _Content(end=len(_HEADER))
        *lines, torn = data[len(_HEADER) :].split(b"\n")
        for number, line in enumerate(lines, start=2):
            self._take_in(content, line, f"{self.path}, line {number}")
            content.end += len(line) + 1
        if torn:
            with suppress(InputError):  # half a line; a whole one lacks no more than its end
                self._take_in(content, torn, "")
                content.end += len(torn)
                content.is_terminated = False
        return content

    def _take_in(self, content: _Content, line: bytes, where: str) -> None:
        remedy = "restore this line of the sheet, or begin another sheet"
        try:
            (fields,) = csv.reader([line.decode().rstrip("\r")], strict=True)
            event, rater, number, segments, intensity, variety = fields
            window = int(number)
        except (ValueError, csv.Error) as error:
            raise InputError("this line is no answer", where=where, remedy=remedy) from error
        key = (rater, window)
        if window not in self._orders.get(rater, ()) or self._segments[window] != segments:
            raise InputError("this answer is not about the plan", where=where, remedy="give its own plan")
        is_withdrawal = event == "withdrawn"
        if event not in ("rated", "withdrawn") or (key in content.answers) is not is_withdrawal:
            raise InputError("this answer does not follow from the lines before", where=where, remedy=remedy)
        if is_withdrawal:
            if intensity or variety:
                raise InputError("a withdrawal holds an answer", where=where, remedy=remedy)
            del content.answers[key]
            return
        _check_answer("intensity", intensity, where)
        _check_answer("variety", variety, where)
        content.answers[key] = (intensity, variety)


def plan_of_sheet(path: str | Path) -> pd.DataFrame:
    """Give the part of a plan that a sheet of answers tells of: enough to turn the answers into targets.

    Parameters
    ----------
    path : str or Path
        What a `RatingSheet` wrote.

    Raises
    ------
    InputError
        If there is no such file, or it is no sheet.
    """
    import pandas as pd

    remedy = "give the file that the rating widget saved"
    try:
        with Path(path).open("rb") as file:
            data = file.read(_LARGEST_BYTES)
        whole, end, last = data.rpartition(b"\n")
        if last.endswith((b",easy", b",hard")):  # an answer that lacks no more than its end
            end += last
        table = pd.read_csv(
            io.BytesIO(whole + end), usecols=["rater", "window", "segments"], dtype=str, keep_default_na=False
        ).drop_duplicates(["rater", "window"], ignore_index=True)
        windows = [int(number) for number in table["window"]]
        parts = [words.split(_OF) for words in table["segments"]]
        segments = [tuple(int(number) for number in rows.split()) for rows, _ in parts]
    except FileNotFoundError as error:
        raise InputError("there is no such file", where=path, remedy=remedy) from error
    except (OSError, ValueError) as error:
        raise InputError("this is no rating sheet", where=path, remedy=remedy) from error
    if table.empty:
        raise InputError("nothing is rated yet", where=path, remedy=remedy)
    order = table.groupby("rater").cumcount() + 1
    libraries = [library for _, library in parts]
    return table.assign(window=windows, segments=pd.Series(segments), library=libraries, order=order)


def _check_answer(scale: str, answer: str, where: str | Path) -> None:
    if answer not in SCALES[scale]:
        raise InputError(
            f'"{answer}" is no answer about {scale}', where=where, remedy=f"use {' or '.join(SCALES[scale])}"
        )
