"""Tables of wishes: one row for each dance that a cohort shall have."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from math import inf
from pathlib import Path
from typing import Any

from pydantic import Field, ValidationError, field_validator

from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.goal import Goal
from studykit.choreography.request import DEFAULT_S, SPEED_PERCENTILE, requested
from studykit.choreography.targets import limited
from studykit.core.errors import InputError, MistakesError, nearest
from studykit.core.seeding import stream
from studykit.io.toml_file import line_of, read_model
from studykit.motion.joint_mask import JointMask, spare
from studykit.protocol.part import Part

_LONGEST_NAME = 100
_MOST = 2**31


class Wish(Part):
    """One dance that is wished for, and for whom; what is left out is as in `request.requested`."""

    participant: str = Field(default="", description="the folder of the dance")
    name: str = Field(default="", description="the name of its files; its words if not given")
    duration_s: float = Field(default=DEFAULT_S, description="a multiple of 4")
    intensity: str | float = Field(default="light", description="light, intense, or a percentile, 0 to 100")
    variety: str | float = Field(default="easy", description="easy, hard, or a share, such as 0.7")
    transition: str = Field(default="on", description="on or off")
    spare: tuple[str, ...] = Field(default=(), description="joints, separated by spaces or ;")
    speed_percentile: float | None = Field(
        default=None, ge=0.0, le=100.0, description="a percentile of the library, 0 to 100"
    )
    schedule: str | None = Field(default=None, description="hiit, waves or warm-up, instead of one level")
    stage: str | None = Field(default=None, description="width x depth in m, such as 3x2.5")
    seed: int | None = Field(default=None, ge=0, lt=_MOST, description="a whole number; drawn if not given")

    @field_validator("intensity", "variety", mode="before")
    @classmethod
    def _number_if_it_is_one(cls, said: Any) -> Any:
        try:
            return float(said)
        except (TypeError, ValueError):
            return said

    @field_validator("spare", mode="before")
    @classmethod
    def _separate_joints(cls, said: Any) -> Any:
        joints = re.split(r"[\s;]+", said.strip(" ;")) if isinstance(said, str) else said
        return tuple(joints) if isinstance(joints, list) else joints

    @field_validator("participant", "name")
    @classmethod
    def _can_name_a_file(cls, said: str) -> str:
        if re.search(r'[<>:"/\\|?*\x00-\x1f]', said) or said[:1] == "." or said[-1:] in {".", " "}:
            raise InputError(f'no file can be called "{said}"', remedy="use letters, digits, - and _")
        if len(said) > _LONGEST_NAME:
            raise InputError(f"{len(said)} letters are too long for a file", remedy="use a shorter name")
        return said

    @field_validator("stage")
    @classmethod
    def _has_two_sides(cls, said: str | None) -> str | None:
        if said is not None:
            stage_size(said)
        return said

    @property
    def stage_m(self) -> tuple[float, float] | None:
        """Width and depth that the pelvis keeps within, m."""
        return None if self.stage is None else stage_size(self.stage)

    def goal(self, library: DanceLibrary) -> Goal:
        """Say in numbers what is wished for; dances that spare the same joints share one mask.

        Raises
        ------
        InputError
            If a word, joint, schedule or number is none that is known.
        """
        goal = requested(
            library,
            duration_s=self.duration_s,
            intensity=self.intensity,  # type: ignore[arg-type]  # words are checked there
            variety=self.variety,  # type: ignore[arg-type]
            transition=self.transition,  # type: ignore[arg-type]
            schedule=self.schedule,
        )
        if not self.spare:
            return goal
        percentile = SPEED_PERCENTILE if self.speed_percentile is None else self.speed_percentile
        return replace(goal, mask=_mask(library, self.spare, percentile))


@lru_cache(maxsize=8)
def _mask(library: DanceLibrary, joints: tuple[str, ...], percentile: float) -> JointMask:
    """Give one mask for the same joints, by which the search knows what it has prepared."""
    return limited(spare(joints), library, percentile)


def stage_size(text: str) -> tuple[float, float]:
    """Read a stage such as "3x2.5": width and depth, m.

    Raises
    ------
    InputError
        If it is none, or a side is not above 0.
    """
    try:
        width, depth = (float(number) for number in text.lower().split("x"))
    except ValueError:
        width = depth = 0.0
    if not (0.0 < width < inf and 0.0 < depth < inf):
        raise InputError(f"{text!r} is no stage", where="stage", remedy="say width x depth, such as 3x2.5")
    return width, depth


def read_wishes(path: str | Path, library: DanceLibrary, *, seed: int = 0) -> tuple[Wish, ...]:
    """Read a table of wishes and check all of it.

    Parameters
    ----------
    path : str or Path
        A CSV file with a heading, or a TOML file with a `[[dance]]` each; columns and fields are those of
        `Wish`, of which `participant` or `name` is needed. Empty cells are left out.
    library : DanceLibrary
        What the dances shall be made of.
    seed : int
        A wish without a seed gets one that is drawn from this one, the participant and the name, so that
        people with equal wishes dance differently and no row depends on another.

    Returns
    -------
    tuple of Wish
        Each with its name and seed.

    Raises
    ------
    InputError
        If anything is wrong: a line for each mistake (`MistakesError`), with file, line, field and remedy.
    """
    path = Path(path)
    rows = _from_toml(path) if path.suffix.lower() == ".toml" else _from_csv(path)
    if not rows:
        raise InputError("no dance is wished for", where=path, remedy="write a row for each")
    seen: dict[tuple[str, str], int] = {}
    named: list[Wish] = []
    mistakes: list[InputError] = []
    for row in rows:
        wish, wrong = _read(row.said)
        wrong += _wrong_alone(wish, library)
        try:
            if row.is_whole and not wrong:
                named.append(_named(wish, library, seed))
                _refuse_again(named[-1], seen.setdefault(_key(named[-1]), row.line("")), row.line(""))
        except InputError as error:
            wrong.append(error)
        mistakes += [_at(one, f"{path}, line {row.line('')}") for one in row.wrong]
        for one in wrong:
            field = _FIELDS.get(one.where, one.where)
            mistakes.append(_at(one, f"{path}, line {row.line(field)}, {field}"))
    if mistakes:
        raise MistakesError(mistakes)
    return tuple(named)


@dataclass(frozen=True, kw_only=True, slots=True)
class _Row:
    """What a table says of one dance.

    Parameters
    ----------
    said : dict of str to Any
        By field.
    line : callable
        Tells on which line a field is set; "" asks for the line of the whole.
    wrong : sequence of InputError
        What is wrong about the row before any field is read.
    is_whole : bool
        Whether all that it says is known; below a wrong heading it is not.
    """

    said: dict[str, Any]
    line: Callable[[str], int]
    wrong: Sequence[InputError] = ()
    is_whole: bool = True


_FIELDS = {"": "spare", "duration": "duration_s"}
"""Where errors of a request come from, in the words of a wish; a mask speaks of its joints alone."""

_ALONE = ("duration_s", "intensity", "variety", "transition", "spare", "schedule")
"""What can be checked whatever else a wish says, so that no mistake hides another."""


def _at(error: InputError, where: str) -> InputError:
    return InputError(error.problem, where=where, remedy=error.remedy)


def _read(said: dict[str, Any]) -> tuple[Wish, list[InputError]]:
    """Read what can be read of a wish, and tell what cannot."""
    wrong: dict[str, InputError] = {}
    try:
        return Wish.model_validate(said), []
    except ValidationError as error:
        for problem in error.errors(include_url=False):
            field = str(problem["loc"][0])
            wrong.setdefault(field, _unreadable(field, said[field], problem.get("ctx", {}).get("error")))
    return _read({field: value for field, value in said.items() if field not in wrong})[0], [*wrong.values()]


def _unreadable(field: str, value: Any, cause: object) -> InputError:
    if isinstance(cause, InputError):
        return InputError(cause.problem, where=field, remedy=cause.remedy)
    if field not in Wish.model_fields:
        known = nearest(field, Wish.model_fields)
        return InputError(f'the field "{field}" is unknown', where=field, remedy=known)
    meaning = Wish.model_fields[field].description
    return InputError(f"cannot read {value!r}", where=field, remedy=f"write {meaning}")


def _wrong_alone(wish: Wish, library: DanceLibrary) -> Iterator[InputError]:
    """Tell which fields are wrong whatever the others say."""
    for field in _ALONE:
        if field in wish.model_fields_set:
            try:
                Wish.model_validate({field: getattr(wish, field)}).goal(library)
            except InputError as error:
                yield error


def _named(wish: Wish, library: DanceLibrary, seed: int) -> Wish:
    """Check a wish as a whole and give it a name and a seed, where it has none."""
    if not (wish.participant or wish.name):
        raise InputError("nobody is named", where="participant", remedy="give a participant or a name")
    levels = sorted(wish.model_fields_set & {"duration_s", "intensity", "variety"})
    if wish.schedule and levels:
        raise InputError(
            f"a schedule has lengths and levels of its own, not one {' and one '.join(levels)}",
            where="schedule",
            remedy="leave one or the other empty",
        )
    if wish.speed_percentile is not None and not wish.spare:
        raise InputError("no joint is spared", where="speed_percentile", remedy="name one under spare")
    goal = wish.goal(library)
    name = wish.name or goal.condition.replace("schedule", wish.schedule or "schedule")
    drawn = int(stream(seed, "cohort", wish.participant, name).integers(_MOST))
    return wish.model_copy(update={"name": name, "seed": drawn if wish.seed is None else wish.seed})


def _key(wish: Wish) -> tuple[str, str]:
    return wish.participant.casefold(), wish.name.casefold()  # some disks see no capitals


def _refuse_again(wish: Wish, first: int, line: int) -> None:
    if first != line:
        raise InputError(
            f'"{wish.name}" is wished for already on line {first}',
            where="name",
            remedy="give each dance of a participant a name of its own",
        )


class _Wishes(Part):
    """Wishes as a file."""

    dance: tuple[dict[str, Any], ...] = Field(default=(), description="one dance each")


def _from_toml(path: Path) -> list[_Row]:
    def line(number: int, field: str) -> int:
        text = path.read_bytes().decode("utf-8-sig")
        return line_of(text, ("dance", number, field)) or line_of(text, ("dance", number)) or 1

    return [
        _Row(said=said, line=partial(line, number))
        for number, said in enumerate(read_model(path, _Wishes).dance)
    ]


def _from_csv(path: Path) -> list[_Row]:
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(f"cannot be read ({reason})", where=path, remedy="name a readable file") from None
    except UnicodeDecodeError:
        raise InputError("the file is not text", where=path, remedy="save it as CSV in UTF-8") from None
    heading = text.partition("\n")[0]
    table = csv.reader(io.StringIO(text, newline=""), delimiter=max(",;\t", key=heading.count), strict=True)
    rows: list[_Row] = []

    def add(said: dict[str, str], *wrong: InputError) -> None:
        number, is_whole = table.line_num, not any(row.wrong for row in rows[:1]) and not wrong
        rows.append(_Row(said=said, line=lambda _: number, wrong=wrong, is_whole=is_whole))

    try:
        columns = _filled(next(table, []))
        if wrong := [*_wrong_columns(columns)]:
            add({}, *wrong)
        for cells in map(_filled, table):
            if len(cells) > len(columns):
                add({}, _too_many(cells, columns))
            elif cells:
                filled = zip(columns, cells, strict=False)
                add({column: cell for column, cell in filled if cell and column in Wish.model_fields})
    except csv.Error as error:
        add({}, InputError(f"no CSV ({error})", remedy="save the table again"))
    return rows


def _filled(cells: list[str]) -> list[str]:
    """Give the cells of a line without the empty ones that spreadsheets put behind them."""
    stripped = [cell.strip() for cell in cells]
    while stripped and not stripped[-1]:
        stripped.pop()
    return stripped


def _wrong_columns(heading: list[str]) -> Iterator[InputError]:
    for column in dict.fromkeys(heading):
        if column not in Wish.model_fields:
            yield InputError(f'there is no column "{column}"', remedy=nearest(column, Wish.model_fields))
        if heading.count(column) > 1:
            yield InputError(f'the column "{column}" stands twice', remedy="remove one of them")


def _too_many(cells: list[str], columns: list[str]) -> InputError:
    return InputError(
        f"{len(cells)} cells below {len(columns)} columns",
        remedy="write lists such as joints with spaces between, or in quotes",
    )
