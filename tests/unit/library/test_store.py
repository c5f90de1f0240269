"""A library folder appears whole or not at all, and a broken one is named."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.library import open_library, store
from studykit.library.shard import SegmentRows


def test_arrays_stay_on_disk(built) -> None:
    assert isinstance(built.rotations, SegmentRows)
    assert isinstance(built.features, SegmentRows)
    assert not built.linear_energies.flags.owndata
    assert not built.linear_energies.flags.writeable
    assert built.features.shape == (9, 120, 97)
    assert built.rotations.dtype == built.features.dtype == np.float32


def test_every_file_is_compared_with_its_digest(built_folder: Path, tmp_path: Path) -> None:
    store.require_intact(built_folder)
    names = [
        path.relative_to(built_folder)
        for path in sorted(built_folder.rglob("*"))
        if path.suffix in {".npy", ".parquet", ".npz", ".csv"} and ".small" not in path.name
    ]
    assert len(names) >= 10
    for name in names:
        copy = tmp_path / "copy"
        shutil.copytree(built_folder, copy)
        data = bytearray((copy / name).read_bytes())
        data[-1] ^= 1
        (copy / name).write_bytes(data)
        with pytest.raises(InputError, match=rf"{re.escape(name.as_posix())}: is not what was written"):
            store.require_intact(copy)
        shutil.rmtree(copy)


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def empty(path: Path) -> None:
    path.write_bytes(b"")


def junk(path: Path) -> None:
    path.write_bytes(b"no library file at all")


@pytest.mark.parametrize("harm", [cut, empty, junk, Path.unlink])
@pytest.mark.parametrize(
    "name",
    ["manifest.json", "segments.parquet", "calibration.npz", "shards.json", "linear_energies.npy", "a shard"],
)
def test_a_broken_library_is_named(built_folder: Path, tmp_path: Path, name: str, harm) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(built_folder, copy)
    found = sorted(path for path in copy.rglob(f"{name}*") if path.is_file())
    harm(found[0] if found else min((copy / "takes").glob("?*[0-9a-f].npy")))
    with pytest.raises(InputError) as caught:
        open_library(copy)
    said = str(caught.value)
    assert said.startswith(f"{copy}: ")
    assert said.endswith("build it again.") or "build one with" in said or "run the same build" in said
    assert "\n" not in said


@pytest.mark.parametrize(
    ("manifest", "message"),
    [
        ({}, "not a dance library; build one"),
        ([], "not a dance library; build one"),
        (
            {"version": 99},
            r"manifest\.json: a library of version 99, this studykit reads 3; remove the library and build",
        ),
    ],
)
def test_a_manifest_of_something_else(built_folder: Path, tmp_path: Path, manifest, message: str) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(built_folder, copy)
    (copy / "manifest.json").write_text(json.dumps(manifest))
    with pytest.raises(InputError, match=message):
        open_library(copy)


def test_arrays_of_different_length_are_refused(built_folder: Path, tmp_path: Path) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(built_folder, copy)
    poses = store.index_folder(copy) / "first_poses.npy"
    np.save(poses, np.load(poses)[:-1])
    with pytest.raises(InputError, match=r"broken library \(arrays of different length\); build it again\."):
        open_library(copy)


@pytest.mark.parametrize("name", ["first_poses", "peak_speeds", "successors"])
def test_arrays_that_make_no_sense_are_refused(built_folder: Path, tmp_path: Path, name: str) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(built_folder, copy)
    path = store.index_folder(copy) / f"{name}.npy"
    array = np.load(path)
    array[2] = -1 if name == "successors" else np.nan
    np.save(path, array)
    what = (
        "a successor is no segment" if name == "successors" else f"segment 2 has {name} that are no numbers"
    )
    with pytest.raises(InputError, match=rf"copy: broken library \({what}\); build it again\.$"):
        open_library(copy)


def test_calibration_and_scaler_come_back_as_they_were(built, tmp_path: Path) -> None:
    store.write_calibration(tmp_path / "saved.npz", built.scaler, built.calibration)
    scaler, calibration = store.read_calibration(tmp_path / "saved.npz")
    assert np.array_equal(scaler.means, built.scaler.means)
    assert np.array_equal(calibration.join_displacements, built.calibration.join_displacements)
    assert calibration.median_distance == built.calibration.median_distance
