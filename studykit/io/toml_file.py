"""TOML files written by people: read strictly, with errors that name the line and the remedy."""

from __future__ import annotations

import json
import re
import tomllib
from bisect import bisect_left
from difflib import get_close_matches
from functools import lru_cache
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from studykit.core.errors import InputError, nearest

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

Model = TypeVar("Model", bound=BaseModel)
FieldPath = tuple[str | int, ...]
LINE_LENGTH = 110
_LONGEST_INDEX = 10  # digits; longer ones are a name
_MOST_CHARACTERS = 300_000
"""Read to find a line; a file in which that takes more is none that a person wrote."""
_MOST_PROBLEMS = 10
"""Looked up to find the first; who has more sees the others next."""


def read_model(path: Path | str, model: type[Model]) -> Model:
    """Read a file of settings and check every one of them.

    Parameters
    ----------
    path : Path or str
        A TOML file (UTF-8).
    model : type of pydantic model
        What the file must contain.

    Returns
    -------
    Model

    Raises
    ------
    InputError
        For the first thing that is wrong, in one sentence: file, line, field, remedy. A misspelt field is
        reported before the field that is missing because of it.
    """
    path = Path(path)
    text = _text(path)
    data = _parsed(text, path)
    try:
        values = json.dumps(data, default=str)
    except (ValueError, RecursionError):
        raise _too_much(path) from None
    try:
        return model.model_validate_json(values, strict=True)
    except ValidationError as error:
        raise _first_problem(error, model, data, text, path) from None


def line_of(text: str, field: FieldPath) -> int | None:
    r"""Give the line on which a field of a TOML text is set.

    Parameters
    ----------
    text : str
        Valid TOML.
    field : tuple of str or int
        The way to the field; numbers count the entries of lists from 0.

    Returns
    -------
    int or None
        The first line of the setting, counted from 1. For an entry inside a list of values or an inline
        table this is the line of the setting that holds it; None if the text does not set the field.

    Examples
    --------
    >>> line_of("a = 1\n[dance]\nb = [\n  2,\n]\nc.d = 3", ("dance", "c", "d"))
    6
    """
    # A setting is there as soon as the text up to the end of some setting has it. No second parser could
    # disagree with the first.
    ends = _ends(text)
    found = bisect_left(ends, 1, key=lambda stop: int(_is_set(_beginning(text, stop), field)))
    return None if found == len(ends) else ([0, *ends])[found] + 1


def model_text(model: BaseModel) -> str:
    """Write settings as TOML, with the explanation of every field beside it.

    Parameters
    ----------
    model : pydantic model
        The settings; the descriptions of its fields become the comments.

    Returns
    -------
    str
        A text that :func:`read_model` reads back to an equal model.
    """
    explained: set[str] = set()
    return "\n".join(_table_lines(model, "", explained)).strip() + "\n"


def _text(path: Path) -> str:
    try:
        # Editors of some systems put a byte-order mark first; it means nothing here.
        return path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        names = sorted(file.name for file in path.parent.glob("*.toml")) if path.parent.is_dir() else []
        close = get_close_matches(path.name, names, n=1, cutoff=0.8)
        remedy = f"use {path.parent / close[0]} if that was meant" if close else "check the path"
        raise InputError("there is no such file", where=path, remedy=remedy) from None
    except UnicodeDecodeError:
        raise InputError("the file is not text", where=path, remedy="save it as UTF-8 text") from None
    except ValueError:
        raise InputError("no file can be called that", where=str(path), remedy="check the path") from None
    except OSError as error:
        reason = (error.strerror or "unknown reason").lower()
        raise InputError(
            f"the file cannot be read ({reason})", where=path, remedy="name a readable file"
        ) from None


def _parsed(text: str, path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        found = re.fullmatch(
            r"(.*?) \(at (?:line (\d+), column \d+|end of document)\)", str(error), re.DOTALL
        )
        problem, line = (found[1], found[2]) if found else (str(error), None)
        place = f"{path}, line {line or _unfinished_line(text)}"
        raise InputError(
            f"this is not valid TOML ({problem[:1].lower()}{problem[1:]})",
            where=place,
            remedy="look for a missing quote, bracket, comma or equals sign, or a field that is set twice",
        ) from None
    except (ValueError, RecursionError):  # a number of thousands of digits, thousands of brackets
        raise _too_much(path) from None


def _too_much(path: Path) -> InputError:
    problem = "a number is too long or brackets are nested too deep"
    return InputError(problem, where=path, remedy="write numbers and lists that a person could read")


@lru_cache(maxsize=2)
def _ends(text: str) -> list[int]:
    """Give the lines (from 1) on which a setting, a heading or a comment ends; none after a huge one."""
    lines = list(StringIO(text))
    ends: list[int] = []
    start, left = 0, _MOST_CHARACTERS
    for stop in range(1, len(lines) + 1):
        one = "".join(lines[start:stop])
        left -= len(one)
        if left < 0:
            break
        try:
            tomllib.loads(one)
        except (ValueError, RecursionError):
            continue
        ends.append(stop)
        start = stop
    return ends


@lru_cache(maxsize=64)
def _beginning(text: str, stop: int) -> dict[str, Any]:
    return tomllib.loads("".join(list(StringIO(text))[:stop]))


def _unfinished_line(text: str) -> int:
    """Find the line where the setting begins that the end of the text leaves open."""
    ends = _ends(text)
    good = bisect_left(ends, 1, key=lambda stop: int(not _is_valid(text, stop)))
    return ([0, *ends])[good] + 1


def _is_valid(text: str, stop: int) -> bool:
    try:
        _beginning(text, stop)
    except (ValueError, RecursionError):
        return False
    return True


def _holds(data: Any, part: str | int) -> bool:
    if isinstance(data, list):
        return isinstance(part, int) and part < len(data)
    return isinstance(data, dict) and part in data


def _is_set(data: Any, field: FieldPath) -> bool:
    for position, part in enumerate(field):
        if _holds(data, part):
            data = data[part]
        else:
            # A path that ends inside a plain value belongs to the setting that holds the value.
            return position > 0 and not isinstance(data, dict | list)
    return True


def _first_problem(
    error: ValidationError, model: type[BaseModel], data: dict[str, Any], text: str, path: Path
) -> InputError:
    problems = error.errors(include_url=False)
    # The branches of a union fail together; the one that fits the kind of value tells more.
    fitting = [
        p for p in problems if not (p["type"] == "literal_error" and isinstance(p["input"], list | dict))
    ]

    def place(problem: ErrorDetails) -> tuple[FieldPath, int | None]:
        field = _field(problem, data)
        line = line_of(text, field)
        while line is None and len(field) > 1:
            field = field[:-1]
            line = line_of(text, field)
        return field, line

    def rank(problem: ErrorDetails) -> tuple[bool, float]:
        return problem["type"] != "extra_forbidden", place(problem)[1] or float("inf")

    unknown = [p for p in fitting if p["type"] == "extra_forbidden"]
    first = min((unknown or fitting or problems)[:_MOST_PROBLEMS], key=rank)
    line = place(first)[1]
    name = ".".join(part for part in _field(first, data) if isinstance(part, str))
    where = ", ".join(filter(None, [str(path), f"line {line}" if line else "", name]))
    what, remedy = _sentence(first, model, _field(first, data))
    return InputError(what, where=where, remedy=remedy)


def _field(problem: ErrorDetails, data: Any) -> FieldPath:
    """Keep those parts of an error's place that exist in the file; the rest names branches of unions."""
    field: list[str | int] = []
    place = list(problem["loc"])
    cause = problem.get("ctx", {}).get("error")
    if isinstance(cause, InputError) and cause.where:
        place += [
            int(part) if part.isdecimal() and len(part) < _LONGEST_INDEX else part
            for part in cause.where.split(".")
        ]
    for number, part in enumerate(place):
        if _holds(data, part):
            data = data[part]
            field.append(part)
        elif problem["type"] == "missing" and number == len(place) - 1:
            field.append(part)
    return tuple(field)


def _sentence(problem: ErrorDetails, model: type[BaseModel], field: FieldPath) -> tuple[str, str]:
    """Say what is wrong and what to do."""
    kind, value = problem["type"], problem["input"]
    context = problem.get("ctx", {})
    name = field[-1] if field else ""
    cause = context.get("error")
    if isinstance(cause, InputError):
        return cause.problem, cause.remedy
    if kind == "extra_forbidden":
        known = list(_model_at(model, field[:-1]).model_fields)
        return f'the field "{name}" is unknown', nearest(str(name), known)
    if kind == "missing":
        if isinstance(name, int):
            return f"entry {name + 1} of the list is missing", "add it"
        meaning = _meaning(model, field)
        return f'the field "{name}" is missing', f"add it{meaning}"
    if kind == "literal_error":
        known = re.findall(r"'([^']*)'", context["expected"]) or [context["expected"]]
        return f"{_value_text(value)} is not possible here", nearest(str(value), known)
    what = problem["msg"].removeprefix("Value error, ").replace("Input ", f"{_value_text(value)} ", 1)
    return what, f"correct the value{_meaning(model, field)}"


def _meaning(model: type[BaseModel], field: FieldPath) -> str:
    names = [part for part in field if isinstance(part, str)]
    if not names:
        return ""
    parent = _model_at(model, field[: field.index(names[-1])])
    described = parent.model_fields.get(names[-1])
    return f" ({described.description})" if described and described.description else ""


def _model_at(model: type[BaseModel], field: FieldPath) -> type[BaseModel]:
    """Follow a path through the fields of models, tuples and mappings of models."""
    for part in field:
        if not isinstance(part, str) or part not in model.model_fields:
            continue
        kind: Any = model.model_fields[part].annotation
        inner = [kind, *get_args(kind)]
        model = next((one for one in inner if isinstance(one, type) and issubclass(one, BaseModel)), model)
    return model


def _table_lines(model: BaseModel, name: str, explained: set[str]) -> list[str]:
    settings: list[tuple[str, str]] = []
    tables: list[str] = []
    for key, info in type(model).model_fields.items():
        value = getattr(model, key)
        inner = f"{name}.{key}" if name else key
        if isinstance(value, BaseModel):
            lines = _table_lines(value, inner, explained)
            # A table that holds only tables needs no heading of its own.
            tables += ["", f"[{inner}]", *lines] if not lines or lines[0] else lines
        elif isinstance(value, tuple) and value and isinstance(value[0], BaseModel):
            for entry in value:
                tables += ["", f"[[{inner}]]", *_table_lines(entry, inner, explained)]
        elif value is not None:
            meaning = "" if inner in explained else info.description or ""
            explained.add(inner)
            settings.append((f"{key} = {_value_text(value)}", meaning))
    about = (type(model).__doc__ or "\n").strip().partition("\n")[0] if settings or not name else ""
    first = f"# {about}" if about and name not in explained else ""
    explained.add(name)
    return [line for line in (first, *_setting_lines(settings)) if line] + tables


def _setting_lines(settings: list[tuple[str, str]]) -> list[str]:
    """Put comments behind the settings where they fit, in one column, and above them elsewhere."""
    short = [len(setting) for setting, meaning in settings if len(setting) + len(meaning) + 3 <= LINE_LENGTH]
    column = max((length for length in short if length <= 36), default=0)
    lines: list[str] = []
    for setting, meaning in settings:
        behind = f"{setting:<{column}}  # {meaning}"
        if meaning and len(behind) <= LINE_LENGTH:
            lines.append(behind)
        else:
            lines += [f"# {meaning}", *_wrapped(setting)] if meaning else _wrapped(setting)
    return lines


def _wrapped(setting: str) -> list[str]:
    if len(setting) <= LINE_LENGTH or not setting.endswith("]"):
        return [setting]
    key, values = setting.split(" = ", 1)
    entries = json.loads(values)
    return [f"{key} = [", *(f"    {_value_text(entry)}," for entry in entries), "]"]


def _value_text(value: Any) -> str:
    # JSON's strings, numbers, truth values and lists of these are TOML's too, but for one character.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
