"""What a pickle may name, and the values that come of it: numbers, text, containers and nothing that acts."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import NDArray

LARGEST_COUNT = 20_000_000
"""Values that one pickle may stand for once everything that it mentions twice is written out."""
DEEPEST = 100
"""Containers within containers; recordings have three or four."""
_PER_KEY = 16
"""Values that weigh in memory as much as an entry of a dictionary or set."""

_NUMBERS = re.compile(r"\?|b1|[iu][1248]|f[248]|c(8|16)|[SU]\d{1,6}")
_ORDER = ("<", ">", "=", "|")


class RefusedError(ValueError):
    """A pickle says something that a recording has no need to say."""

    def __init__(self, problem: str, *, hostile: bool = False) -> None:
        super().__init__(problem)
        self.hostile = hostile


@dataclass(slots=True)
class Budget:
    """What a pickle may still have made of it: a short one could have one long text copied again and again.

    Parameters
    ----------
    left : int
        In values of 8 bytes.
    """

    left: int = LARGEST_COUNT

    def spend(self, values: int) -> None:
        """Count what is about to be made.

        Raises
        ------
        RefusedError
            If that is too much, taken together with all that was made before.
        """
        self.left -= values
        if self.left < 0:
            raise RefusedError(f"stands for more than {LARGEST_COUNT:,} values")


@dataclass(frozen=True, slots=True)
class Name:
    """A class or function that a pickle mentions: never looked up, only known by what it stands for."""

    kind: str
    text: str


@dataclass(slots=True, eq=False)
class Made:
    """Something a pickle would have called into being: what of, and what with."""

    name: Name
    arguments: Any
    state: Any = None


_KINDS = {
    "numpy.core.multiarray._reconstruct": "array",
    "numpy.core.multiarray.scalar": "scalar",
    "numpy.core.numeric._frombuffer": "buffer",
    "numpy.ndarray": "ndarray",
    "numpy.dtype": "dtype",
    "_codecs.encode": "encode",
    "collections.OrderedDict": "dict",
    "copyreg._reconstructor": "object of",
    "copyreg.__newobj__": "object of",
    "builtins.object": "object",
    "builtins.dict": "dict",
    "builtins.set": "set",
    "builtins.frozenset": "set",
    "builtins.list": "list",
    "builtins.complex": "complex",
    "builtins.bytes": "bytes",
    "builtins.bytearray": "bytes",
}
_RENAMED = (("numpy._core.", "numpy.core."), ("__builtin__.", "builtins."), ("copy_reg.", "copyreg."))
_SPARSE = re.compile(r"scipy\.sparse\.(?:\w+\.)?(csc|csr|coo)_(?:matrix|array)")


def named(module: str, name: str) -> Name:
    """Take a name that a pickle mentions, if recordings and body models have use for it.

    Raises
    ------
    RefusedError
        If it is anything else: unpickled in the usual way, the file could run code.
    """
    text = f"{module}.{name}"
    for prefix, today in _RENAMED:
        if text.startswith(prefix):
            text = today + text.removeprefix(prefix)
    sparse = _SPARSE.fullmatch(text)
    if sparse:
        return Name(sparse[1], text)
    if module.split(".", maxsplit=1)[0] == "chumpy":
        return Name("chumpy", text)
    if text not in _KINDS:
        shown = f"{module}.{name}"[:80]
        raise RefusedError(f"this pickle would run code (it names {shown!r})", hostile=True)
    return Name(_KINDS[text], text)


def made(name: Any, arguments: Any, budget: Budget) -> Any:
    """Note what a pickle wants made; a dictionary is made at once, since more is put into it."""
    if not isinstance(name, Name) or not isinstance(arguments, tuple):
        raise RefusedError("this pickle would run code (it calls a value)", hostile=True)
    if name.kind == "object of":
        name, arguments = (arguments[0] if arguments else None), ()
        if not isinstance(name, Name):
            raise RefusedError("this pickle would run code (it makes an object of a value)", hostile=True)
    if name.kind == "dict":
        pairs = _list(budget, *arguments[:1])
        budget.spend(_PER_KEY * len(pairs))
        return {key_of(key): value for key, value in pairs}
    return Made(name, arguments)


def key_of(value: Any) -> Any:
    """Let text and plain numbers be keys; nested keys can be made to take for ever."""
    if value is None or isinstance(value, str | bytes) or (isinstance(value, int) and abs(value) < 2**63):
        return value
    raise RefusedError("a key is neither text nor a number")


class Values:
    """Turns what a pickle says into values, each once, counting what they add up to."""

    def __init__(self, budget: Budget) -> None:
        self._budget = budget
        self._known: dict[int, tuple[Any, int] | None] = {}
        self._kept: list[Any] = []
        """What was met, so that no other item can have its identity."""

    def of(self, item: Any, depth: int = 0) -> Any:
        """Give the value of an item.

        Raises
        ------
        RefusedError
            If it contains itself, goes too deep, adds up to too much or makes no sense.
        """
        return self._counted(item, depth)[0]

    def _counted(self, item: Any, depth: int) -> tuple[Any, int]:
        if not isinstance(item, dict | list | tuple | set | Made | Name):
            return item, 1
        if depth > DEEPEST:
            raise RefusedError(f"nests more than {DEEPEST} deep")
        known = self._known.get(id(item), (None, 0))
        if known is None:
            raise RefusedError("something in it contains itself")
        if known[1]:
            return known
        self._known[id(item)] = None
        self._kept.append(item)
        result = self._value(item, depth + 1)
        if result[1] > LARGEST_COUNT:
            raise RefusedError(f"stands for more than {LARGEST_COUNT:,} values")
        self._known[id(item)] = result
        return result

    def _value(self, item: Any, depth: int) -> tuple[Any, int]:
        if isinstance(item, dict):
            counted = [self._counted(value, depth) for value in item.values()]
            values = {key: value for key, (value, _) in zip(item, counted, strict=True)}
            return values, 1 + sum(count for _, count in counted)
        if isinstance(item, list | tuple):
            counted = [self._counted(value, depth) for value in item]
            return type(item)(value for value, _ in counted), 1 + sum(count for _, count in counted)
        if isinstance(item, Made):
            return self._made(item, depth), 1
        if isinstance(item, Name):
            raise RefusedError(f"has the class {item.text} where a value should be")
        return item, 1 + len(item)

    def _made(self, item: Made, depth: int) -> Any:
        kind, arguments = item.name.kind, item.arguments
        if kind in ("csc", "csr", "coo"):
            return self._full_matrix(kind, self._attributes(item.state, depth))
        if kind == "chumpy":
            state = self._attributes(item.state, depth)
            return state.get("x", state)
        if kind == "array":
            return self._array(item.state, depth)
        if item.state is not None and kind != "dtype":
            raise RefusedError(f"gives {item.name.text} a state that it does not have")
        if kind == "dtype":
            return _dtype(arguments, item.state)
        if kind not in _MAKERS:
            raise RefusedError(f"makes something of {item.name.text}, which is no value")
        return _MAKERS[kind](self._budget, *(self.of(part, depth) for part in arguments))

    def _attributes(self, state: Any, depth: int) -> dict[str, Any]:
        """Attributes of an object; some come as a pair of plain and slotted ones."""
        parts = state if isinstance(state, tuple) else (state,)
        merged: dict[str, Any] = {}
        for part in parts:
            if isinstance(part, dict):
                self._budget.spend(2 * _PER_KEY * len(part))  # here, and with their values
                merged |= part
            elif part is not None:
                raise RefusedError("an object has no attributes")
        values: dict[str, Any] = self.of(merged, depth)
        return values

    def _array(self, state: Any, depth: int) -> NDArray[Any]:
        if not isinstance(state, tuple) or len(state) not in (4, 5):
            raise RefusedError("an array has no content")
        shape, dtype, by_column, raw = (self.of(part, depth) for part in state[-4:])
        return _filled(self._budget, raw, dtype, shape, by_column=bool(by_column))

    def _full_matrix(self, kind: str, state: dict[str, Any]) -> NDArray[Any]:
        shape = state.get("_shape", state.get("shape"))
        if not isinstance(shape, tuple) or len(shape) != 2:
            raise RefusedError("a sparse matrix has no shape")
        self._budget.spend(_size(shape))
        for part in (*state.values(), *(state.get("coords") or ())):
            self._budget.spend(part.size if isinstance(part, np.ndarray) else 0)
        rows, columns = _places(kind, state)
        data = _numbers(state, "data")
        full = np.zeros(shape)
        if len(rows) != len(data) or len(columns) != len(data):
            raise RefusedError("a sparse matrix has not one place for each number")
        inside = [
            np.all((place >= 0) & (place < length))
            for place, length in zip((rows, columns), shape, strict=True)
        ]
        if not all(inside):
            raise RefusedError("a sparse matrix has numbers outside its shape")
        np.add.at(full, (rows, columns), data)
        return full


def _places(kind: str, state: dict[str, Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Rows and columns of the numbers of a sparse matrix."""
    if kind == "coo":
        coords = state.get("coords")
        named_places = state if coords is None else dict(zip(("row", "col"), coords, strict=True))
        return _numbers(named_places, "row", whole=True), _numbers(named_places, "col", whole=True)
    inner = _numbers(state, "indices", whole=True)
    counts = np.diff(_numbers(state, "indptr", whole=True))
    if np.any(counts < 0) or counts.sum() != len(inner):
        raise RefusedError("the index of a sparse matrix is broken")
    outer = np.repeat(np.arange(len(counts)), counts)
    return (inner, outer) if kind == "csc" else (outer, inner)


def _numbers(state: dict[str, Any], name: str, *, whole: bool = False) -> NDArray[Any]:
    array = state.get(name)
    kinds = "iu" if whole else "iuf"
    if not isinstance(array, np.ndarray) or array.ndim != 1 or array.dtype.kind not in kinds:
        raise RefusedError(f"a sparse matrix has no {name}")
    return array.astype(np.int64) if whole else array


def _size(shape: Any) -> int:
    if (
        not isinstance(shape, tuple)
        or len(shape) > 32
        or not all(type(n) is int and 0 <= n < 2**40 for n in shape)
    ):
        raise RefusedError("an array has no shape")
    return math.prod(shape)


def _filled(budget: Budget, raw: Any, dtype: Any, shape: Any, *, by_column: bool = False) -> NDArray[Any]:
    """Make an array of the bytes that are there, never of more."""
    if not isinstance(dtype, np.dtype):
        raise RefusedError("an array has no type")
    content = _bytes(budget, raw) if isinstance(raw, str) else raw
    if not isinstance(content, bytes | bytearray):
        raise RefusedError("an array is not made of plain numbers")
    size = _size(shape)
    if size * dtype.itemsize != len(content):
        raise RefusedError(f"an array of the shape {shape} has {len(content)} bytes")
    flat = np.frombuffer(content, dtype=dtype) if size else np.zeros(0, dtype=dtype)
    return flat.reshape(shape, order="F" if by_column else "C")


def _dtype(arguments: Any, state: Any) -> np.dtype[Any]:
    code = arguments[0] if arguments else None
    if not isinstance(code, str) or not _NUMBERS.fullmatch(code):
        raise RefusedError("an array is not made of plain numbers")
    order = "=" if state is None else state[1] if isinstance(state, tuple) and len(state) > 1 else None
    if order not in _ORDER:
        raise RefusedError("the type of an array has a state that it does not have")
    dtype = np.dtype(code).newbyteorder(cast(Literal["<", ">", "=", "|"], order))
    if dtype.itemsize == 0:
        raise RefusedError("an array is made of nothing")
    return dtype


def _buffer(
    budget: Budget, raw: Any, dtype: Any, shape: Any, order: Any = "C", axes: Any = None
) -> NDArray[Any]:
    """Make an array as protocol 5 has it; with "K", its axes are those stored, in another order."""
    if order != "K":
        return _filled(budget, raw, dtype, shape, by_column=order == "F")
    array = _filled(budget, raw, dtype, shape)
    whole = isinstance(axes, list | tuple) and all(type(axis) is int for axis in axes)
    if not whole or sorted(axes) != list(range(array.ndim)):
        raise RefusedError("an array has its axes in no order")
    return array.transpose(axes)


def _scalar(budget: Budget, dtype: Any, raw: Any = b"") -> Any:
    budget.spend(dtype.itemsize // 8 if isinstance(dtype, np.dtype) else 0)
    return _filled(budget, raw, dtype, ())[()]


def _bytes(budget: Budget, content: Any = b"", encoding: Any = "latin-1") -> bytes:
    """Bytes, which old protocols write as text; never a number of them."""
    if isinstance(content, str | bytes | bytearray):
        budget.spend(len(content) // 8)
    if isinstance(content, str) and encoding in ("latin1", "latin-1"):
        return content.encode("latin-1")
    if isinstance(content, bytes | bytearray):
        return bytes(content)
    raise RefusedError("asks for memory instead of saying what is in it", hostile=True)


def _complex(_: Budget, real: Any, imaginary: Any = 0.0) -> complex:
    if not isinstance(real, float | int) or not isinstance(imaginary, float | int):
        raise RefusedError("a complex number is not made of numbers")
    return complex(real, imaginary)


def _set(budget: Budget, items: Iterable[Any] = ()) -> set[Any]:
    listed = _list(budget, items)
    budget.spend(_PER_KEY * len(listed))
    return {key_of(item) for item in listed}


def _list(budget: Budget, items: Iterable[Any] = ()) -> list[Any]:
    if not isinstance(items, list | tuple | set):
        raise RefusedError("a list is not made of one")
    budget.spend(len(items))
    return list(items)


_MAKERS: dict[str, Callable[..., Any]] = {
    "scalar": _scalar,
    "buffer": _buffer,
    "encode": _bytes,
    "bytes": _bytes,
    "complex": _complex,
    "set": _set,
    "list": _list,
}
