"""Pickles read without unpickling: numbers are taken out of them, nothing in them is ever run.

A pickle is a small program. Python's own reader imports what the program names and calls it; this one knows
only the instructions that put data together, and has no way to import or to call.
"""

from __future__ import annotations

import codecs
import io
import pickletools
import struct
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from studykit.core.errors import InputError
from studykit.io.packed import read_bytes
from studykit.io.pickled_objects import (
    LARGEST_COUNT,
    Budget,
    Made,
    Name,
    RefusedError,
    Values,
    key_of,
    made,
    named,
)

LARGEST_BYTES = 170 * 2**20
"""Twenty million numbers and some; what holds more is no take."""
MOST_STEPS = 1_000_000
"""Instructions; a recording needs some hundreds, since an array is one."""

_OPCODES = {opcode.code: opcode for opcode in pickletools.opcodes}
_FAULTS = (
    ArithmeticError,
    AttributeError,
    LookupError,
    MemoryError,
    RecursionError,
    TypeError,
    ValueError,
    struct.error,
)


def read_pickle(path: Path, *, largest_bytes: int = LARGEST_BYTES) -> Any:
    """Read the numbers, texts and arrays of a pickle file, plain or packed (.xz, .gz).

    Parameters
    ----------
    path : Path
        The file, of any protocol; texts of Python 2 are taken for Latin-1.
    largest_bytes : int
        What holds more is refused.

    Returns
    -------
    object
        Plain values and NumPy arrays. Sparse SciPy matrices come as full arrays, and objects of the chumpy
        package as the array that they hold.

    Raises
    ------
    InputError
        If the pickle would run code, is broken, or stands for more than a recording can be.
    """
    data = read_bytes(path, largest_bytes=largest_bytes)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about escapes that mean nothing
            # What a file has in it may be made once; more than that is made of what it mentions twice.
            budget = Budget(LARGEST_COUNT + len(data) // 8)
            return Values(budget).of(_Machine(data, budget).result())
    except RefusedError as refusal:
        remedy = "do not open it; get it again from where it is published" if refusal.hostile else ""
        raise InputError(
            str(refusal), where=path, remedy=remedy or "it holds no recording, or must be copied again"
        ) from refusal
    except _FAULTS as error:
        reason = " ".join(str(error).split())[:120] or type(error).__name__
        raise InputError(f"broken pickle ({reason})", where=path, remedy="copy it again") from error


class _Machine:
    """Follows the instructions of a pickle on a stack of its own."""

    def __init__(self, data: bytes, budget: Budget) -> None:
        self.budget = budget
        self.file = io.BytesIO(data)
        self.stack: list[Any] = []
        self.marks: list[int] = []
        self.memo: dict[int, Any] = {}

    def result(self) -> Any:
        """Follow the instructions to the end; give what is left on the stack."""
        for _ in range(MOST_STEPS):
            code = self.file.read(1)
            if not code:
                raise ValueError("it ends in the middle")
            opcode = _OPCODES.get(code.decode("latin-1"))
            if opcode is None:
                raise ValueError(f"no pickle has the byte {code!r} at {self.file.tell() - 1}")
            if opcode.name == "STOP":
                return self.stack.pop()
            step = _STEPS.get(opcode.name)
            if step is None:
                raise RefusedError(f"this pickle would run code (instruction {opcode.name})", hostile=True)
            step(self, self._argument(opcode))
        raise RefusedError(f"has more than {MOST_STEPS:,} instructions")

    def _argument(self, opcode: pickletools.OpcodeInfo) -> Any:
        if opcode.arg is None:
            return None
        if opcode.name == "STRING":
            return _quoted(self.file.readline())
        return opcode.arg.reader(self.file)

    def popped(self, count: int) -> tuple[Any, ...]:
        """Take the topmost items."""
        if len(self.stack) < count:
            raise ValueError("it takes more than it has")
        items = tuple(self.stack[-count:])
        del self.stack[-count:]
        return items

    def since_mark(self) -> list[Any]:
        """Take everything above the last mark."""
        start = self.marks.pop()
        items = self.stack[start:]
        del self.stack[start:]
        return items

    def into(self, kind: type, items: list[Any]) -> None:
        """Put items into the container on top."""
        target = self.stack[-1]
        if type(target) is not kind:
            raise RefusedError("this pickle would run code (it fills a value)", hostile=True)
        if isinstance(target, list):
            target.extend(items)
        elif isinstance(target, set):
            target.update(key_of(item) for item in items)
        elif isinstance(target, dict):
            target.update(_dict(items))

    def build(self) -> None:
        """Give an object its state."""
        target, state = self.popped(2)
        if not isinstance(target, Made) or target.state is not None:
            raise RefusedError("this pickle would run code (it gives a value a state)", hostile=True)
        target.state = state
        self.stack.append(target)

    def name(self, module: Any, name: Any) -> None:
        """Mention a class or function."""
        if not isinstance(module, str) or not isinstance(name, str):
            raise RefusedError("this pickle would run code (it makes up a name)", hostile=True)
        self.stack.append(named(module, name))

    def call(self, name: Any, arguments: Any) -> None:
        """Note what is to be made by a call."""
        self.stack.append(made(name, arguments, self.budget))

    def new(self, name: Any, arguments: Any) -> None:
        """Note an object to be made."""
        if not isinstance(name, Name):
            raise RefusedError("this pickle would run code (it makes an object of a value)", hostile=True)
        self.call(name, arguments)


def _quoted(line: bytes) -> str:
    """Text of Python 2 in quotes, with escapes."""
    text = line.strip()
    if not line.endswith(b"\n") or len(text) < 2 or text[:1] not in (b"'", b'"') or text[-1:] != text[:1]:
        raise ValueError("a text has no quotes")
    return codecs.escape_decode(text[1:-1])[0].decode("latin-1")


def _dict(items: list[Any]) -> dict[Any, Any]:
    if len(items) % 2:
        raise ValueError("a key has no value")
    return {key_of(key): value for key, value in zip(items[::2], items[1::2], strict=True)}


def _push(machine: _Machine, argument: Any) -> None:
    machine.stack.append(argument)


def _pass(machine: _Machine, argument: Any) -> None:
    """Do nothing: how the bytes are framed has no meaning here."""


def _put(machine: _Machine, argument: Any) -> None:
    machine.memo[argument] = machine.stack[-1]


def _get(machine: _Machine, argument: Any) -> None:
    machine.stack.append(machine.memo[argument])


_ARGUMENTS = """INT BININT BININT1 BININT2 LONG LONG1 LONG4 FLOAT BINFLOAT STRING BINSTRING SHORT_BINSTRING
UNICODE SHORT_BINUNICODE BINUNICODE BINUNICODE8 SHORT_BINBYTES BINBYTES BINBYTES8 BYTEARRAY8"""

_STEPS: dict[str, Callable[[_Machine, Any], None]] = {
    **dict.fromkeys(_ARGUMENTS.split(), _push),
    **dict.fromkeys(("PROTO", "FRAME"), _pass),
    **dict.fromkeys(("PUT", "BINPUT", "LONG_BINPUT"), _put),
    **dict.fromkeys(("GET", "BINGET", "LONG_BINGET"), _get),
    "MEMOIZE": lambda machine, _: _put(machine, len(machine.memo)),
    "NONE": lambda machine, _: machine.stack.append(None),
    "NEWTRUE": lambda machine, _: machine.stack.append(True),
    "NEWFALSE": lambda machine, _: machine.stack.append(False),
    "MARK": lambda machine, _: machine.marks.append(len(machine.stack)),
    "POP": lambda machine, _: _pass(machine, machine.popped(1)),
    "POP_MARK": lambda machine, _: _pass(machine, machine.since_mark()),
    "DUP": lambda machine, _: machine.stack.append(machine.stack[-1]),
    "EMPTY_LIST": lambda machine, _: machine.stack.append([]),
    "EMPTY_TUPLE": lambda machine, _: machine.stack.append(()),
    "EMPTY_DICT": lambda machine, _: machine.stack.append({}),
    "EMPTY_SET": lambda machine, _: machine.stack.append(set()),
    "LIST": lambda machine, _: machine.stack.append(machine.since_mark()),
    "TUPLE": lambda machine, _: machine.stack.append(tuple(machine.since_mark())),
    "TUPLE1": lambda machine, _: machine.stack.append(machine.popped(1)),
    "TUPLE2": lambda machine, _: machine.stack.append(machine.popped(2)),
    "TUPLE3": lambda machine, _: machine.stack.append(machine.popped(3)),
    "DICT": lambda machine, _: machine.stack.append(_dict(machine.since_mark())),
    "FROZENSET": lambda machine, _: machine.stack.append({key_of(item) for item in machine.since_mark()}),
    "APPEND": lambda machine, _: machine.into(list, list(machine.popped(1))),
    "APPENDS": lambda machine, _: machine.into(list, machine.since_mark()),
    "ADDITEMS": lambda machine, _: machine.into(set, machine.since_mark()),
    "SETITEM": lambda machine, _: machine.into(dict, list(machine.popped(2))),
    "SETITEMS": lambda machine, _: machine.into(dict, machine.since_mark()),
    "GLOBAL": lambda machine, words: machine.name(*words.split(" ", 1)),
    "STACK_GLOBAL": lambda machine, _: machine.name(*machine.popped(2)),
    "REDUCE": lambda machine, _: machine.call(*machine.popped(2)),
    "NEWOBJ": lambda machine, _: machine.new(*machine.popped(2)),
    "BUILD": lambda machine, _: machine.build(),
}
"""What each instruction does. Those missing here (persistent ids, extensions, INST, OBJ, outside buffers) are
refused: no recording has them."""
