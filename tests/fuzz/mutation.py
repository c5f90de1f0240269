"""Changes that turn a good file into one that a careless, unlucky or hostile person might have.

Every function takes a seeded generator first, so that an input can be made again from its seed.
"""

from __future__ import annotations

import gzip
import io
import lzma
import pickle
import pickletools
import re
import warnings
import zipfile
import zlib
from collections.abc import Callable
from functools import cache
from itertools import pairwise

import numpy as np

LARGEST = 1 << 18
"""Bytes of an input before packing; the bound on time is one for small files."""

WORDS = [
    *(b"nan NaN inf -inf Infinity 1e308 -1e308 1e-308 1e154 1e7 1e5 1e999 -1 0 1 2 0.0 -0".split()),
    *(b"99999999999999999999 9223372036854775807 2147483648 0x10 1_000 1,5 1.0.0 -- None True 1e 1j".split()),
    b"9" * 5000,
    b"",
    b"-",
    b"\0",
    b"\xff\xfe",
    b"\x1a",
    "é".encode(),
    "\N{ARABIC-INDIC DIGIT THREE}".encode(),
    "\N{FULLWIDTH DIGIT ONE}".encode(),
    "\N{LINE SEPARATOR}".encode(),
    "\N{NEXT LINE}".encode(),
    "\N{ZERO WIDTH NO-BREAK SPACE}".encode(),
]
_SPACE = re.compile(rb"([ \t\r\n,:=\"\[\]{}()]+)")


def pick(rng: np.random.Generator, options: list) -> object:
    """Choose one (NumPy's own choice would make an array of them)."""
    return options[int(rng.integers(len(options)))]


def bytes_changed(rng: np.random.Generator, data: bytes, other: bytes = b"") -> bytes:
    """Flip bits, cut, repeat, splice; once or a few times."""
    for _ in range(1 + int(rng.geometric(0.5))):
        data = pick(rng, _BYTE_CHANGES)(rng, data, other)[:LARGEST]
    return data


def _span(rng: np.random.Generator, data: bytes) -> tuple[int, int]:
    start = int(rng.integers(len(data) + 1))
    if rng.random() < 0.5:  # headers are where it hurts
        start = min(start, int(rng.integers(400)))
    return start, min(len(data), start + int(rng.geometric(pick(rng, [0.3, 0.02, 0.002]))))


def _flipped(rng: np.random.Generator, data: bytes, _: bytes) -> bytes:
    changed = bytearray(data)
    for _ in range(int(rng.geometric(0.4))):
        if changed:
            changed[_span(rng, data)[0] % len(changed)] ^= 1 << int(rng.integers(8))
    return bytes(changed)


def _overwritten(rng: np.random.Generator, data: bytes, _: bytes) -> bytes:
    start, stop = _span(rng, data)
    fill = pick(rng, [b"\0", b"\xff", b"\x7f", b"9", b"-", b" ", b"\n", rng.bytes(1)])
    return data[:start] + fill * (stop - start) + data[stop:]


def _without(rng: np.random.Generator, data: bytes, _: bytes) -> bytes:
    start, stop = _span(rng, data)
    return data[:start] + data[stop:]


def _with_noise(rng: np.random.Generator, data: bytes, _: bytes) -> bytes:
    start, stop = _span(rng, data)
    return data[:start] + rng.bytes(stop - start) + data[pick(rng, [start, stop]) :]


def _repeated(rng: np.random.Generator, data: bytes, _: bytes) -> bytes:
    start, stop = _span(rng, data)
    return data[:stop] + data[start:stop] * int(rng.integers(1, 60)) + data[stop:]


def _cut(rng: np.random.Generator, data: bytes, _: bytes) -> bytes:
    return data[: int(rng.integers(len(data) + 1))]


def _spliced(rng: np.random.Generator, data: bytes, other: bytes) -> bytes:
    return data[: _span(rng, data)[0]] + other[_span(rng, other)[0] :]


def _with_word(rng: np.random.Generator, data: bytes, _: bytes) -> bytes:
    start = _span(rng, data)[0]
    return data[:start] + pick(rng, WORDS) + data[start:]


_BYTE_CHANGES = [
    _flipped,
    _flipped,
    _overwritten,
    _without,
    _with_noise,
    _repeated,
    _cut,
    _spliced,
    _with_word,
]


def text_changed(rng: np.random.Generator, data: bytes, other: bytes, words: list[bytes]) -> bytes:
    """Change words, lines, columns, line ends or the encoding; now and then bytes too."""
    for _ in range(int(rng.geometric(0.6))):
        data = pick(rng, _TEXT_CHANGES)(rng, data, other, [*WORDS, *words])[:LARGEST]
    return bytes_changed(rng, data, other) if rng.random() < 0.15 else data


def _words_changed(rng: np.random.Generator, data: bytes, _: bytes, words: list[bytes]) -> bytes:
    parts = _SPACE.split(data)
    for _ in range(int(rng.geometric(0.4))):
        at = int(rng.integers(len(parts)))
        at = min(at, int(rng.integers(300))) if rng.random() < 0.5 else at
        parts[at] = pick(rng, [pick(rng, words), pick(rng, words), pick(rng, parts), b"", parts[at] * 2])
    return b"".join(parts)


def _numbers_scaled(rng: np.random.Generator, data: bytes, _: bytes, __: list[bytes]) -> bytes:
    """Another unit for all numbers with a point."""
    factor = float(pick(rng, [1e-300, 1e-9, 1e-3, 0.0, -1.0, 0.01, 1.2, 100.0, 1e6, 1e150, 1e300]))
    return re.sub(rb"-?\d+\.\d+", lambda found: f"{float(found[0]) * factor:.9g}".encode(), data)


def _lines_changed(rng: np.random.Generator, data: bytes, other: bytes, __: list[bytes]) -> bytes:
    lines = data.split(b"\n")
    at, to = (int(n) for n in rng.integers(len(lines), size=2))
    kind = int(rng.integers(7))
    if kind == 0:
        del lines[at : at + int(rng.geometric(0.3))]
    elif kind == 1:
        lines[at:at] = lines[at : at + int(rng.geometric(0.3))] * int(pick(rng, [1, 1, 2, 50, 400]))
    elif kind == 2:
        lines[at], lines[to] = lines[to], lines[at]
    elif kind == 3:
        lines[at] += b" " + lines[to]
    elif kind == 4:
        lines[at:to] = sorted(lines[at:to])
    elif kind == 5:
        lines[at] = pick(rng, other.split(b"\n"))
    else:
        lines[at:at] = [b""] * int(pick(rng, [1, 5, 3000]))
    return b"\n".join(lines)


def _columns_changed(rng: np.random.Generator, data: bytes, _: bytes, __: list[bytes]) -> bytes:
    """Lose, swap or double the same column of every long row."""
    at, to = (int(n) for n in rng.integers(60, size=2))
    kind = int(rng.integers(3))
    rows = []
    for line in data.split(b"\n"):
        gap = b"\t" if b"\t" in line.strip() else b"," if b"," in line else b" "
        cells = line.split(gap)
        if len(cells) > max(at, to):
            if kind == 0:
                del cells[at]
            elif kind == 1:
                cells[at], cells[to] = cells[to], cells[at]
            else:
                cells.insert(at, cells[to])
        rows.append(gap.join(cells))
    return b"\n".join(rows)


def _recoded(rng: np.random.Generator, data: bytes, _: bytes, __: list[bytes]) -> bytes:
    text = data.decode("latin-1")
    ways: list[Callable[[], bytes]] = [
        lambda: data.replace(b"\r", b"").replace(b"\n", b"\r\n"),
        lambda: data.replace(b"\n", b"\r"),
        lambda: data.replace(b" ", b"\t"),
        lambda: data.replace(b"\t", b" "),
        lambda: data.replace(b"\n", b"\n\n"),
        lambda: data.replace(b".", b","),
        lambda: data.replace(b"\n", b"\x0b"),
        lambda: b"\xef\xbb\xbf" + data,
        lambda: b"\xef\xbb\xbf\xef\xbb\xbf" + data,
        lambda: text.encode("utf-16"),
        lambda: text.encode("utf-32-be"),
        data.swapcase,
        lambda: data.replace(b"a", b"\xe4").replace(b"o", b"\xf6"),
        data.rstrip,
        lambda: data.replace(b"\n", b""),
        lambda: data + data,
    ]
    return pick(rng, ways)()


_TEXT_CHANGES = [
    *(_words_changed, _words_changed, _words_changed, _lines_changed, _lines_changed),
    *(_columns_changed, _recoded, _numbers_scaled),
]

_ODD_NUMBERS = [np.nan, np.inf, -np.inf, 1e308, -1e308, 1e-308, 1e154, 1e6, 1e5, 400.0, -1.0, 0.0, 7.0]
_DTYPES = [
    *("?", "i1", "u1", "<i2", "<i4", "<i8", "<u8", ">i8", "<f2", "<f4", "<f8", ">f8", "<f16", "<c8", "<c16"),
    *("S8", "U8", "S1", "U1"),
]


def array_changed(rng: np.random.Generator, array: np.ndarray) -> np.ndarray:
    """Change numbers, kind, shape, axes or unit of an array; the same array if that cannot be done."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return np.asarray(pick(rng, _ARRAY_CHANGES)(rng, array))
        except (ValueError, TypeError, IndexError, OverflowError):
            return array


def _some(rng: np.random.Generator, array: np.ndarray) -> np.ndarray:
    changed = np.array(array)
    flat = changed.reshape(-1)
    places = rng.integers(flat.size, size=int(pick(rng, [1, 1, 2, 50])))
    flat[places] = pick(rng, _ODD_NUMBERS)
    return changed


def _one_frame(rng: np.random.Generator, array: np.ndarray) -> np.ndarray:
    changed = np.array(array)
    changed[int(rng.integers(len(changed)))] = pick(rng, _ODD_NUMBERS)
    return changed


_ARRAY_CHANGES: list[Callable[[np.random.Generator, np.ndarray], object]] = [
    _some,
    _some,
    _some,
    _one_frame,
    lambda rng, a: np.full(a.shape, pick(rng, _ODD_NUMBERS)),
    lambda rng, a: a * pick(rng, [0.0, -1.0, 0.001, 0.01, 2.54, 57.29578, 1000.0, 1e-300, 1e300]),
    lambda rng, a: a + pick(rng, [*_ODD_NUMBERS, 1e6, -100.0]),
    lambda rng, a: a.astype(pick(rng, _DTYPES)),
    lambda rng, a: a.astype(pick(rng, _DTYPES)),
    lambda rng, a: a.T,
    lambda rng, a: a[..., ::-1],
    lambda rng, a: np.roll(a, 1, axis=-1),
    lambda rng, a: rng.permutation(a, axis=int(rng.integers(a.ndim))),
    lambda rng, a: a.reshape(-1),
    lambda rng, a: a[None],
    lambda rng, a: a[..., None],
    lambda rng, a: a.reshape((1,) * int(rng.integers(30, 33 - a.ndim + 1)) + a.shape),
    lambda rng, a: a[:0],
    lambda rng, a: a[..., :0],
    lambda rng, a: a[: int(rng.integers(len(a)))],
    lambda rng, a: a[..., : int(rng.integers(a.shape[-1]))],
    lambda rng, a: a[..., :1] * np.ones(int(rng.integers(1, 400))),
    lambda rng, a: np.concatenate([a] * int(rng.integers(2, 9)), axis=int(rng.integers(a.ndim))),
    lambda rng, a: a.reshape(-1)[0],
    lambda rng, a: np.array(pick(rng, ["male", b"female", "", "neutral", "x" * 300, "1.5", "\N{NEXT LINE}"])),
    lambda rng, a: a * 1j,
    lambda rng, a: rng.normal(size=a.shape),
    lambda rng, a: np.asfortranarray(a),
]


def values_changed(rng: np.random.Generator, values: dict) -> dict:
    """Rename, remove, double or replace entries of a table of arrays, or change the arrays."""
    changed = dict(values)
    for _ in range(int(rng.geometric(0.6))):
        if not changed:
            break
        name = pick(rng, list(changed))
        kind = int(rng.integers(12))
        if kind == 0:
            del changed[name]
        elif kind == 1:
            changed[pick(rng, [f"{name} ", str(name).upper(), f"{name}s", b"x", 3, None, ""])] = changed.pop(
                name
            )
        elif kind == 2:
            changed[name] = changed[pick(rng, list(changed))]
        elif kind == 3:
            odd = [
                None,
                1,
                -1.5,
                "text",
                b"bytes",
                [],
                {},
                (1, 2),
                [[0.0] * 72] * 3,
                {"x": 1},
                True,
                10**400,
                1j,
            ]
            changed[name] = pick(
                rng, [*odd, set(), np.float64(3), np.str_("a"), float("nan"), {name: changed[name]}]
            )
        elif kind == 4:
            changed[pick(rng, ["smpl_orients", "keypoints3d", "poses", "gender", "root_orient"])] = changed[
                name
            ]
        elif isinstance(changed[name], np.ndarray):
            changed[name] = array_changed(rng, changed[name])
    return changed


def pickled(rng: np.random.Generator, values: object) -> bytes:
    """Pickle by any protocol."""
    return pickle.dumps(values, int(rng.integers(pickle.HIGHEST_PROTOCOL + 1)))


GADGETS = [
    b"cos\nsystem\n(S'touch marker'\ntR",
    b"cposix\nsystem\n(S'touch marker'\ntR",
    b"cbuiltins\nopen\n(S'marker'\nS'w'\ntR",
    b'c__builtin__\neval\n(S\'open("marker","w")\'\ntR',
    b"(S'touch marker'\nios\nsystem\n",
    b"(cos\nsystem\nS'touch marker'\no",
    b"csubprocess\nPopen\n(lS'touch'\naS'marker'\natR",
    b"cthis\ns\n",
    b"cnumpy\nload\n(S'marker'\ntR",
    b"ccopyreg\n__newobj__\n(cos\nsystem\nS'touch marker'\ntR",
    b"ccopyreg\n_reconstructor\n(cos\nsystem\ncbuiltins\nobject\nNtR",
    b"cbuiltins\ngetattr\n(cbuiltins\ndict\nS'get'\ntR",
    b"cnumpy\nndarray.__class__\n",
    b"cbuiltins\nbytearray\n(I4000000000\ntR",
    b"cnumpy.core.numeric\n_frombuffer\n(C\x01xcnumpy\ndtype\n(S'f8'\ntR(I4000000000\ntS'C'\ntR",
    b"Pmarker\n",
    b"\x82\x01",
    b"\x83\x01\x00",
    b"N)\x81",
    b"N)}\x92",
    b"\x97\x98",
    b"N}b",
    b"cchumpy\nsystem\n)R}b",
    b"(lp5\ng5\na",
    b"}q\x09U\x01ah\x09s",
]


@cache
def _boundaries(data: bytes) -> tuple[int, ...]:
    return tuple(place for _, _, place in pickletools.genops(data))


def instructions_changed(rng: np.random.Generator, data: bytes, other: bytes) -> bytes:
    """Lose, double, move or add whole instructions of a good pickle."""
    places = [*_boundaries(data), len(data)]
    steps = [data[start:stop] for start, stop in pairwise(places)]
    foreign = [*_boundaries(other), len(other)]
    for _ in range(int(rng.geometric(0.6))):
        at, to = (int(n) for n in rng.integers(len(steps), size=2))
        kind = int(rng.integers(6))
        if kind == 0:
            steps[at] = b""
        elif kind == 1:
            steps[at] *= int(pick(rng, [2, 3, 1000]))
        elif kind == 2:
            steps[at], steps[to] = steps[to], steps[at]
        elif kind == 3:
            gadget = pick(rng, GADGETS)
            steps[at] += pick(rng, [gadget, gadget + b"0", b"0" + gadget])
        elif kind == 4:
            first = int(rng.integers(len(foreign) - 1))
            steps[at] += other[foreign[first] : foreign[first + 1]]
        else:
            steps[at] += pick(
                rng, list(b"0(NRb.de]}l)t\x85\x86\x87a su2q\x00h\x00".replace(b" ", b""))
            ).to_bytes(1, "big")
    return b"".join(steps)[:LARGEST]


def npy(array: np.ndarray) -> bytes:
    """Write an array as .npy."""
    file = io.BytesIO()
    np.lib.format.write_array(file, array, allow_pickle=True)
    return file.getvalue()


def npy_lying(rng: np.random.Generator, data: bytes) -> bytes:
    """Let the header of a .npy file promise something else, or be no header."""
    length = int.from_bytes(data[8:10], "little")
    shapes = "() (-1,) (0,) (2**62,) (1099511627776, 3) (3, 1099511627776) (1e3,) (True, 3) ('a',) [3] 3 None"
    huge = f"({', '.join(['2'] * 70)},)"
    dtypes = "'<f8' '|O' '<M8[s]' '|V8' '|S0' '<U0' '<f3' 'f' '' 3 [('a','<f8')] [('a','O')] '<f8,<f8' None"
    dtype = pick(rng, ["'<f8'", *dtypes.split()])
    order = pick(rng, ["False", "True", "1", "None", "'a'"])
    first, *rest = shapes.split(" (")
    shape = pick(rng, [first, *(f"({one}" for one in rest), "(4, 315)", huge])
    header = f"{{'descr': {dtype}, 'fortran_order': {order}, 'shape': {shape}, }}"
    text = pick(
        rng,
        [header, header, header, "(" * 3000, "{" * 90, "-" * 5000 + "1", "1+" * 2000 + "1", "\0", "{}", "[]"],
    )
    text = text.encode() + pick(rng, [b"\n", b"", b" " * 20_000])
    version = pick(rng, [b"\x01\0", b"\x01\0", b"\x02\0", b"\x03\0", b"\x07\x09"])
    size = pick(rng, [len(text), len(text), 0, 2**16 - 1, length]) % 2**16
    return (
        data[:6] + version + size.to_bytes(2 if version[0] == 1 else 4, "little") + text + data[10 + length :]
    )


def npz(members: dict[str, bytes], rng: np.random.Generator | None = None, *, method: int = 0) -> bytes:
    """Write an archive; with a generator, one as no NumPy writes it."""
    file = io.BytesIO()
    kinds = [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA]
    with warnings.catch_warnings(), zipfile.ZipFile(file, "w") as archive:
        warnings.simplefilter("ignore")  # about doubled names
        for name, data in members.items():
            if rng is None:
                archive.writestr(zipfile.ZipInfo(name), data, method)
                continue
            places = [name] * 12 + [
                f"/{name}",
                f"../{name}",
                f"C:\\{name}",
                f"{name}/",
                name.upper(),
                f"{name}\0x",
                "é",
            ]
            info = zipfile.ZipInfo(pick(rng, places))
            info.compress_type = pick(rng, [kinds[0], *kinds[:2] * 3, *kinds])
            info.external_attr = pick(rng, [0, 0, 0, 0o120777 << 16])
            archive.writestr(info, data)
            if rng.random() < 0.1:
                archive.writestr(zipfile.ZipInfo(info.filename), pick(rng, [b"", data, data[:100]]))
    return file.getvalue()


def npz_lying(rng: np.random.Generator, data: bytes) -> bytes:
    """Let a field of a header in an archive say something else: checksum, sizes, flags, method, place."""
    changed = bytearray(data)
    for magic, fields in (
        (b"PK\x01\x02", [8, 10, 16, 20, 24, 28, 42]),
        (b"PK\x03\x04", [6, 8, 14, 18, 22, 26]),
    ):
        starts = [found.start() for found in re.finditer(re.escape(magic), data)]
        if starts and rng.random() < 0.7:
            place = pick(rng, starts) + pick(rng, fields)
            changed[place : place + 2] = pick(
                rng, [b"\0\0", b"\xff\xff", b"\x01\0", b"\x09\0", b"\x63\0", rng.bytes(2)]
            )
    return bytes(changed)


@cache
def bomb(packing: str, size: int, fill: bytes) -> bytes:
    """Pack very much of nothing."""
    data = fill * (size // len(fill))
    return lzma.compress(data, preset=0) if packing == ".xz" else gzip.compress(data, 1, mtime=0)


def packed(rng: np.random.Generator, data: bytes) -> tuple[str, bytes]:
    """Pack a file as .xz or .gz, well or badly; give the ending and the bytes."""
    ending = str(pick(rng, [".xz", ".gz"]))
    pack = {
        ".xz": lambda one: lzma.compress(one, preset=0),
        ".gz": lambda one: gzip.compress(one, 1, mtime=0),
    }[ending]
    whole = pack(data)
    ways: list[Callable[[], bytes]] = [
        lambda: whole,
        lambda: whole[: int(rng.integers(len(whole)))],
        lambda: bytes_changed(rng, whole),
        lambda: bytes_changed(rng, whole),
        lambda: pack(bytes_changed(rng, data)),
        lambda: data,
        lambda: whole + rng.bytes(30),
        lambda: whole + whole,
        lambda: whole + bytes(64),
        lambda: pack(whole),
        lambda: zlib.compress(data),
        lambda: lzma.compress(data, format=lzma.FORMAT_ALONE, preset=0),
        lambda: gzip.compress(data, 1, mtime=0),
        lambda: b"",
    ]
    return ending, pick(rng, ways)()
