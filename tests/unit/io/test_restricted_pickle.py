"""Pickles: what recordings need comes out right; nothing in a hostile one runs, hangs or fills the memory."""

from __future__ import annotations

import collections
import contextlib
import gzip
import lzma
import os
import pickle
import struct
import tracemalloc
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse
from hypothesis import given, settings
from hypothesis import strategies as st

from studykit.core.errors import InputError
from studykit.io import restricted_pickle
from studykit.io.restricted_pickle import read_pickle

_frombuffer = np.zeros(2).__reduce_ex__(5)[0]
PROTOCOLS = range(pickle.HIGHEST_PROTOCOL + 1)


def written(folder: Path, data: bytes, name: str = "take.pkl") -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


class Calls:
    """Pickles as a call of a function."""

    def __init__(self, function: object, *arguments: object, state: object = None) -> None:
        self.reduced = (function, arguments) if state is None else (function, arguments, state)

    def __reduce__(self) -> object:
        return self.reduced


# --- what recordings need ----------------------------------------------------------------------------------

ARRAYS = {
    "doubles": np.arange(6.0).reshape(2, 3),
    "singles by column": np.asfortranarray(np.arange(6, dtype=np.float32).reshape(2, 3)),
    "big-endian": np.arange(4, dtype=">f8"),
    "every second": np.arange(24).reshape(4, 6)[:, ::2],
    "empty": np.zeros((0, 72)),
    "truth": np.array([True, False]),
    "text": np.array(["male", "é"]),
    "bytes": np.array([b"male"]),
    "one": np.array(93.5),
    "complex": np.array([1j]),
}
VALUES = {
    "number": np.float64(93.5),
    "whole": 10**30,
    "text": "gBR é",
    "bytes": b"\xff\x00",
    "pair": (1, 2.5),
    "list": [1, [2, None], True, False],
    "set": {1, 2},
    "complex": 1 + 2j,
    "nested": {"meta": {"orig_start": 3, 4: "x"}},
    "ordered": collections.OrderedDict(a=1, b=2),
}


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_arrays_come_out_as_they_went_in(tmp_path: Path, protocol: int) -> None:
    read = read_pickle(written(tmp_path, pickle.dumps(ARRAYS, protocol)))
    assert list(read) == list(ARRAYS)
    for name, array in ARRAYS.items():
        np.testing.assert_array_equal(read[name], array, err_msg=name)
        assert read[name].dtype == array.dtype, name


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_plain_values_come_out_as_they_went_in(tmp_path: Path, protocol: int) -> None:
    assert read_pickle(written(tmp_path, pickle.dumps(VALUES, protocol))) == VALUES


@pytest.mark.parametrize("protocol", PROTOCOLS)
@pytest.mark.parametrize("kind", ["csc", "csr", "coo"])
def test_sparse_matrices_come_out_full(tmp_path: Path, protocol: int, kind: str) -> None:
    full = np.random.default_rng(1).normal(size=(4, 7)) * (np.arange(28).reshape(4, 7) % 3 == 0)
    sparse = getattr(scipy.sparse, f"{kind}_matrix")(full)
    np.testing.assert_array_equal(read_pickle(written(tmp_path, pickle.dumps(sparse, protocol))), full)


def test_names_of_other_releases_are_understood(tmp_path: Path) -> None:
    data = pickle.dumps(ARRAYS["doubles"], 2)
    old, new = (name + b"multiarray" for name in (b"cnumpy.core.", b"cnumpy._core."))
    assert new in data or old in data
    for one in (old, new):
        path = written(tmp_path, data.replace(new, one).replace(old, one))
        np.testing.assert_array_equal(read_pickle(path), ARRAYS["doubles"])


@pytest.mark.parametrize("kind", ["<f8", "<f4"])
def test_an_array_with_its_axes_in_another_order(tmp_path: Path, kind: str) -> None:
    array = np.arange(24.0).reshape(2, 3, 4).astype(kind)
    # As NumPy 2.3 writes array.transpose(1, 2, 0): the shape stored, and the order of its axes.
    literal = Calls(_frombuffer, array.tobytes(), array.dtype, (2, 3, 4), "K", (1, 2, 0))
    for value, expected in (
        (literal, array.transpose(1, 2, 0)),
        (array.swapaxes(0, 1), array.swapaxes(0, 1)),
        (array.swapaxes(0, 1).astype(np.float32), array.swapaxes(0, 1)),
    ):
        np.testing.assert_array_equal(read_pickle(written(tmp_path, pickle.dumps(value, 5))), expected)


@pytest.mark.parametrize("axes", [None, (0, 1), (0, 0, 1), (0, 1, 3), (0, 1, 2.0), (-1, 0, 1), "012"])
def test_axes_in_no_order_are_refused(tmp_path: Path, axes: object) -> None:
    value = Calls(_frombuffer, bytes(24), np.dtype("u1"), (2, 3, 4), "K", axes)
    with pytest.raises(InputError, match="an array has its axes in no order"):
        read_pickle(written(tmp_path, pickle.dumps(value, 5)))


def test_literal_text_of_python_2(tmp_path: Path) -> None:
    # As Python 2.7 and NumPy 1 wrote {'smpl_scaling': array([93.])}, protocol 0: text with escapes.
    data = (
        b"(dp0\nS'smpl_scaling'\np1\ncnumpy.core.multiarray\n_reconstruct\np2\n(cnumpy\nndarray\np3\n(I0\ntp4\n"
        b"S'b'\np5\ntp6\nRp7\n(I1\n(I1\ntp8\ncnumpy\ndtype\np9\n(S'f8'\np10\nI0\nI1\ntp11\nRp12\n(I3\nS'<'\np13\n"
        b"NNNI-1\nI-1\nI0\ntp14\nbI00\nS'\\x00\\x00\\x00\\x00\\x00@W@'\np15\ntp16\nbs."
    )
    assert read_pickle(written(tmp_path, data))["smpl_scaling"].tolist() == [93.0]
    assert pickle.loads(data, encoding="latin1")["smpl_scaling"].tolist() == [93.0]


def test_literal_bytes_of_python_2(tmp_path: Path) -> None:
    binary = (
        b"\x80\x02}q\x00U\x05transq\x01cnumpy.core.multiarray\n_reconstruct\nq\x02cnumpy\nndarray\nq\x03K\x00\x85"
        b"q\x04U\x01bq\x05\x87q\x06Rq\x07(K\x01K\x02\x85q\x08cnumpy\ndtype\nq\tU\x02f8q\nK\x00K\x01\x87q\x0bRq\x0c"
        b"(K\x03U\x01<q\rNNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x00tq\x0eb\x89U\x10"
        + struct.pack("<dd", 1.0, -2.5)
        + b"q\x0ftq\x10bs."
    )  # fmt: skip
    assert read_pickle(written(tmp_path, binary))["trans"].tolist() == [1.0, -2.5]


@pytest.mark.parametrize(("ending", "pack"), [(".xz", lzma.compress), (".gz", gzip.compress)])
def test_packed_pickles_are_read(tmp_path: Path, ending: str, pack: object) -> None:
    path = written(tmp_path, pack(pickle.dumps(VALUES)), f"take.pkl{ending}")
    assert read_pickle(path) == VALUES


@settings(max_examples=60, deadline=None)
@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text() | st.binary(),
        lambda inner: st.lists(inner) | st.tuples(inner, inner) | st.dictionaries(st.text(), inner),
        max_leaves=20,
    ),
    st.sampled_from(list(PROTOCOLS)),
)
def test_any_plain_value_comes_out_as_it_went_in(tmp_path_factory, value: object, protocol: int) -> None:
    path = tmp_path_factory.mktemp("p") / "take.pkl"
    path.write_bytes(pickle.dumps(value, protocol))
    assert read_pickle(path) == value


# --- what hostile ones try ---------------------------------------------------------------------------------


class Sly(np.ndarray):
    """An array that is made by a call."""

    def __reduce__(self) -> object:
        return (os.system, ("touch marker",))


def module_level_function() -> None:
    """Would be named in a pickle."""


def hostile(marker: str) -> Iterator[tuple[str, bytes]]:
    """Give pickles that would make a file called marker, or would be a step towards it."""
    command = f"touch {marker}"
    line = f"open({marker!r}, 'w')"
    for protocol in PROTOCOLS:
        calls = {
            "os.system": Calls(os.system, command),
            "eval": Calls(eval, line),
            "exec": Calls(exec, line),
            "open": Calls(open, marker, "w"),
            "getattr": Calls(getattr, os, "system") if protocol > 9 else Calls(getattr, "x", "join"),
            "in a table": {"smpl_poses": np.zeros(3), "meta": {"list": [Calls(os.system, command)]}},
            "array": np.zeros(3).view(Sly),
            "function": module_level_function,
            "load": Calls(np.load, marker),
            "pickle": Calls(pickle.loads, pickle.dumps(Calls(os.system, command))),
            "state": Calls(np.dtype, "f8", state={"__class__": 1}),
        }
        for name, value in calls.items():
            try:
                yield f"{name}, protocol {protocol}", pickle.dumps(value, protocol)
            except (pickle.PicklingError, TypeError):
                continue
    text = command.encode()
    yield "posix.system", b"cposix\nsystem\n(S'" + text + b"'\ntR."
    yield "nt.system", b"cnt\nsystem\n(S'" + text + b"'\ntR."
    yield "Python 2's eval", b"c__builtin__\neval\n(S'1'\ntR."
    yield "dotted name", b"cnumpy\ndtype.__init__.__globals__\n."
    yield "dotted name, by stack", b"\x80\x04\x8c\x05numpy\x8c\x10ndarray.__class__\x93."
    yield "submodule", b"cnumpy.testing._private.utils\nrunstring\n(S'1'\n}tR."
    yield "a chumpy name that calls", b"cchumpy\nsystem\n(S'" + text + b"'\ntRI1\n0b."
    yield "INST", b"(S'" + text + b"'\nios\nsystem\n."
    yield "OBJ", b"(cos\nsystem\nS'" + text + b"'\no."
    yield "EXT1", b"\x80\x02\x82\x01."
    yield "EXT2", b"\x80\x02\x83\x01\x00."
    yield "EXT4", b"\x80\x02\x84\x01\x00\x00\x00."
    yield "persistent id", b"Pmarker\n."
    yield "persistent id, binary", b"\x80\x02U\x01xQ."
    yield "NEWOBJ_EX", b"\x80\x04\x8c\x02os\x8c\x06system\x93)}\x92."
    yield "NEWOBJ of a value", b"\x80\x02]q\x00h\x00)\x81."
    yield "REDUCE of a value", b"\x80\x02]q\x00h\x00)R."
    yield "BUILD of a dictionary", b"\x80\x02}}U\x0c__setstate__U\x01xsb."
    yield "BUILD of a class", b"cnumpy\nndarray\n}S'__reduce__'\nI1\nsb."
    yield "BUILD of a list", b"]}S'__dict__'\n}sb."
    yield "items into a class", b"cnumpy\nndarray\nS'a'\nI1\ns."
    yield "reconstructor of a value", b"ccopy_reg\n_reconstructor\n(S'os'\nc__builtin__\nobject\nNtR."
    yield "outside buffer", b"\x80\x05\x97."
    yield "name that is no text", b"\x80\x04K\x01K\x02\x93."


def test_nothing_in_a_hostile_pickle_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    marker = tmp_path / "marker"
    refused = []
    for name, data in hostile(str(marker)):
        path = written(tmp_path, data)
        with pytest.raises(InputError) as caught:
            pytest.fail(f"{name} gave {read_pickle(path)!r}")
        assert str(path) in str(caught.value), name
        assert (
            "would run code" in str(caught.value)
            or "broken" in str(caught.value)
            or "state" in str(caught.value)
        ), f"{name}: {caught.value}"
        assert not marker.exists(), name
        refused.append(name)
    assert len(refused) > 70


def test_the_same_pickles_do_run_where_they_are_unpickled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    marker = tmp_path / "marker"
    data = dict(hostile(str(marker)))["os.system, protocol 4"]
    pickle.loads(data)
    assert marker.exists()


def test_the_forbidden_name_is_named(tmp_path: Path) -> None:
    path = written(tmp_path, pickle.dumps(Calls(eval, "1"), 4))
    with pytest.raises(InputError, match=r"take\.pkl: this pickle would run code .*'builtins\.eval'"):
        read_pickle(path)


def dag(kind: bytes, depth: int) -> bytes:
    """Nest pairs so that written out they would be 2 to the power of the depth."""
    step = {b"tuple": b"\x86", b"list": b"\x86"}[kind]
    return b"\x80\x02)" + b"".join(b"q\x00h\x00" + step for _ in range(depth))


BOMBS = {
    "array of an untrue shape": pickle.dumps(np.zeros(2), 2).replace(
        b"(K\x01K\x02\x85", b"(K\x01J\xff\xff\xff\x7f\x85"
    ),
    "bytearray by number": b"cbuiltins\nbytearray\n(I1000000000000\ntR.",
    "bytes by number": b"cbuiltins\nbytes\n(I1000000000000\ntR.",
    "bytearray that is not there": b"\x80\x05\x96" + struct.pack("<Q", 2**40) + b".",
    "bytes that are not there": b"\x80\x04\x8e" + struct.pack("<Q", 2**40) + b".",
    "text that is not there": b"\x80\x04\x8d" + struct.pack("<Q", 2**62) + b".",
    "far place in the memo": b"\x80\x02]r\xff\xff\xff\xff" + b"r\xff\xff\xff\x7f" * 20 + b"0.",
    "pairs of pairs": dag(b"tuple", 60) + b".",
    "pairs of pairs as a key": b"\x80\x02}" + dag(b"tuple", 60)[2:] + b"K\x01s.",
    "a list in itself": b"\x80\x02]q\x00h\x00a.",
    "a dictionary in itself": b"\x80\x02}q\x00U\x01ah\x00s.",
    "deep lists": b"\x80\x02" + b"]" * 200_000 + b"a" * 199_999 + b".",
    "deep pairs": b"\x80\x02)" + b"\x85" * 200_000 + b".",
    "deep calls": b"ccollections\nOrderedDict\n" + b")R" * 3 + b".",
    "numbers that collide": b"}("
    + b"".join(b"L%dL\nN" % (n * (2**61 - 1) * 2**20) for n in range(1, 2000))
    + b"u.",
    "many instructions": b"\x80\x02" + b"N0" * 1_000_000 + b".",
    "a long number": b"L" + b"9" * 1_000_000 + b"L\n.",
    "elements of no size": b"cnumpy\ndtype\n(S'S0'\nI0\nI1\ntR.",
    "objects in an array": pickle.dumps(np.array([{}, []], dtype=object), 2),
    "a table in an array": pickle.dumps(np.zeros(2, dtype=[("a", "f8")]), 2),
    "dates in an array": pickle.dumps(np.zeros(2, dtype="M8[s]"), 2),
    "a huge sparse matrix": pickle.dumps(scipy.sparse.csc_matrix((100_000, 1_000)), 2),
    "many sparse matrices": pickle.dumps([scipy.sparse.csc_matrix((4_000, 1_000)) for _ in range(6)], 2),
}  # fmt: skip


@pytest.mark.parametrize("name", BOMBS)
def test_a_bomb_is_refused(tmp_path: Path, name: str) -> None:
    path = written(tmp_path, BOMBS[name])
    with pytest.raises(InputError, match=r"take\.pkl: "):
        read_pickle(path)


def copied(name: bytes, argument: bytes, times: int) -> bytes:
    """Have one argument, which the pickle holds once, made into something again and again."""
    return b"\x80\x02c" + name + b"\nq\x00" + argument + b"\x85q\x010](" + b"h\x00h\x01R" * times + b"e."


def of(item: bytes, times: int) -> bytes:
    """List one item many times."""
    return item + b"q\x020](" + b"h\x02" * times + b"e"


def text(length: int) -> bytes:
    return b"X" + struct.pack("<I", length) + b"a" * length


COPIED = {
    "bytes": (b"_codecs\nencode", text(2000)),
    "lists": (b"builtins\nlist", of(b"N", 400)),
    "sets": (b"builtins\nset", of(b"K\x01", 400)),
    "tables": (b"collections\nOrderedDict", of(b"K\x01K\x02\x86", 400)),
    "texts as numbers": (b"numpy.core.multiarray\nscalar", b""),
    "objects": (b"chumpy.ch\nCh", b""),
    "sparse matrices": (b"scipy.sparse\ncsc_matrix", b""),
}
SHARED_TEXT = bytes(4000)
SHARED_STATE = {str(number): None for number in range(100)}
SHARED_PLACES = np.zeros(400, dtype=np.int32)


def shared(name: str, times: int) -> bytes:
    """Give a pickle in which one thing is copied so many times."""
    function, argument = COPIED[name]
    if argument:
        return copied(function, argument, times)
    scalar = np.float64(1).__reduce__()[0]
    dtype = np.dtype("U1000")
    matrices = [scipy.sparse.csc_matrix((1, 1)) for _ in range(times)]
    for matrix in matrices:
        matrix.indptr = SHARED_PLACES
    return {
        "texts as numbers": lambda: pickle.dumps([Calls(scalar, dtype, SHARED_TEXT) for _ in range(times)]),
        "objects": lambda: (
            b"\x80\x02" + pickle.dumps(SHARED_STATE, 2)[2:-1] + b"q\xff0]("
            + b"cchumpy.ch\nCh\n)\x81h\xffb" * times + b"e."
        ),
        "sparse matrices": lambda: pickle.dumps(matrices, 2),
    }[name]()  # fmt: skip


@pytest.mark.parametrize("name", COPIED)
def test_what_is_copied_again_and_again_is_counted(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(restricted_pickle, "LARGEST_COUNT", 20_000)
    read_pickle(written(tmp_path, shared(name, 2)))
    with pytest.raises(InputError, match="stands for more than"):
        read_pickle(written(tmp_path, shared(name, 200)))


def test_a_small_file_cannot_fill_the_memory(tmp_path: Path) -> None:
    for name, argument in {
        b"_codecs\nencode": text(2_000_000),
        b"builtins\nlist": of(b"N", 100_000),
        b"collections\nOrderedDict": of(b"K\x01K\x02\x86", 100_000),
    }.items():
        path = written(tmp_path, copied(name, argument, 400))
        tracemalloc.start()
        with pytest.raises(InputError, match="stands for more than"):
            read_pickle(path)
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert most < 300 * 2**20


def test_a_broken_sparse_matrix_is_refused(tmp_path: Path) -> None:
    for name, wrong in {
        "indices": np.array([9, 0], dtype=np.int32),
        "indptr": np.array([0, 5, 2, 2], dtype=np.int32),
        "data": np.array(["a", "b"]),
        "_shape": (3,),
    }.items():
        matrix = scipy.sparse.csc_matrix(np.eye(2, 3))
        matrix.__dict__[name] = wrong
        with pytest.raises(InputError, match="sparse"):
            read_pickle(written(tmp_path, pickle.dumps(matrix, 2)))


def test_truncated_and_junk_pickles_are_refused(tmp_path: Path) -> None:
    whole = pickle.dumps(ARRAYS, 4)
    for length in range(len(whole)):
        with pytest.raises(InputError):
            read_pickle(written(tmp_path, whole[:length]))
    rng = np.random.default_rng(0)
    for size in (0, 1, 7, 300):
        with pytest.raises(InputError):
            read_pickle(written(tmp_path, rng.bytes(size)))


@settings(max_examples=300, deadline=None)
@given(st.integers(0, 10_000), st.integers(0, 255))
def test_a_changed_byte_gives_a_value_or_an_input_error(tmp_path_factory, place: int, byte: int) -> None:
    data = bytearray(pickle.dumps(ARRAYS | VALUES, 2 + place % 4))
    data[place % len(data)] = byte
    path = tmp_path_factory.mktemp("p") / "take.pkl"
    path.write_bytes(data)
    with contextlib.suppress(InputError):
        read_pickle(path)


def test_too_large_a_file_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, lzma.compress(bytes(3_000_000)), "take.pkl.xz")
    with pytest.raises(InputError, match="holds more than 2 MiB"):
        read_pickle(path, largest_bytes=2 * 2**20)
