"""Text files are read plain and packed, and broken ones are named."""

from __future__ import annotations

import gzip
import lzma

import pytest

from studykit.core.errors import InputError
from studykit.io.packed import files_ending, read_bytes, read_text

TEXT = "HIERARCHY\nROOT Hüfte\n"
PACKED = {
    "a.bvh": TEXT.encode(),
    "a.bvh.xz": lzma.compress(TEXT.encode()),
    "a.bvh.gz": gzip.compress(TEXT.encode(), mtime=0),
}


@pytest.mark.parametrize("name", PACKED)
def test_the_text_is_the_same_however_it_is_packed(tmp_path, name) -> None:
    (tmp_path / name).write_bytes(PACKED[name])
    assert read_text(tmp_path / name) == TEXT


def test_what_macos_leaves_beside_files_is_no_take(tmp_path) -> None:
    base = tmp_path / "__MACOSX"  # a folder that the user names is read, whatever it is called
    for name in ("b/01.bvh", "b/._01.bvh", "__MACOSX/b/01.bvh", "__MACOSX/._b.bvh", "A.BVH.xz", "a.txt"):
        (base / name).parent.mkdir(parents=True, exist_ok=True)
        (base / name).write_text(TEXT)
    assert files_ending(base, ".bvh") == [base / "A.BVH.xz", base / "b" / "01.bvh"]


@pytest.mark.parametrize("encoding", ["utf-8-sig", "latin-1"])
def test_text_of_other_programs(tmp_path, encoding) -> None:
    (tmp_path / "a.bvh").write_bytes(TEXT.encode(encoding))
    assert read_text(tmp_path / "a.bvh") == TEXT


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("cut.bvh.xz", PACKED["a.bvh.xz"][:-9]),
        ("empty.bvh.xz", b""),
        ("plain.bvh.xz", TEXT.encode()),
        ("cut.bvh.gz", PACKED["a.bvh.gz"][:-9]),
        ("flipped.bvh.gz", PACKED["a.bvh.gz"][:12] + b"\xff\xff\xff" + PACKED["a.bvh.gz"][15:]),
        ("plain.bvh.gz", TEXT.encode()),
    ],
    # Bytes in the name of a test may differ between the processes that run the tests.
    ids=["cut xz", "empty xz", "plain xz", "cut gz", "flipped gz", "plain gz"],
)
def test_a_broken_packing_is_named(tmp_path, name, data) -> None:
    (tmp_path / name).write_bytes(data)
    with pytest.raises(InputError, match=rf"{name}: broken \.\w\w file .*; copy it again\.$"):
        read_text(tmp_path / name)


def test_a_missing_file_is_named(tmp_path) -> None:
    with pytest.raises(InputError, match=r"none\.bvh: cannot be read .*; check the path"):
        read_text(tmp_path / "none.bvh")
    with pytest.raises(InputError, match="cannot be read"):
        read_text(tmp_path)


@pytest.mark.parametrize(("ending", "pack"), [(".xz", lzma.compress), (".gz", gzip.compress)])
def test_what_unpacks_to_far_more_than_a_recording_is_refused(tmp_path, ending, pack) -> None:
    path = tmp_path / f"a.bvh{ending}"
    path.write_bytes(pack(b"0 " * 2**20))  # 2 MiB: as small as a take that is nothing but a T-pose
    assert len(read_bytes(path)) == 2**21
    path.write_bytes(pack(b"0 " * 2**21))
    with pytest.raises(InputError, match=r"a\.bvh\.\w\w: holds more than 2 MiB"):
        read_bytes(path)
