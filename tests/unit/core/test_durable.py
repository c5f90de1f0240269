"""A file is there whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from studykit.core import durable


def test_a_file_is_put_in_its_place_with_its_folder(tmp_path: Path) -> None:
    path = tmp_path / "new" / "file.txt"
    durable.put(path, "Hüfte\n")
    assert path.read_bytes() == "Hüfte\n".encode()
    durable.put(path, b"\x00\x01")
    assert path.read_bytes() == b"\x00\x01"
    assert [one.name for one in path.parent.iterdir()] == ["file.txt"]


def test_the_older_file_stays_when_the_new_one_cannot_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "file.txt"
    durable.put(path, "older")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        durable.put(path, "newer")
    assert path.read_text() == "older"
    assert [one.name for one in tmp_path.iterdir()] == ["file.txt"]


def test_arrays_are_plain_npy_files(tmp_path: Path) -> None:
    array = np.arange(6.0).reshape(2, 3)
    durable.put_array(tmp_path / "array.npy", array)
    assert np.array_equal(np.load(tmp_path / "array.npy", allow_pickle=False), array)
    with pytest.raises(ValueError, match="Object arrays cannot be saved"):
        durable.put_array(tmp_path / "objects.npy", np.array([object()]))
    assert not (tmp_path / "objects.npy").exists()
    durable.settle(tmp_path)
