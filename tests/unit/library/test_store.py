"""A library folder appears whole or not at all, and a broken one is named."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.library import open_library, store


def test_rows_are_written_one_after_the_other(tmp_path: Path) -> None:
    writer = store.ArrayWriter(tmp_path / "rows.npy", (2, 3), "<f4")
    rows = np.arange(66, dtype=np.float32).reshape(11, 2, 3)
    for start in (0, 1, 4):
        writer.append(rows[start : {0: 1, 1: 4, 4: 11}[start]])
    writer.close()
    assert np.array_equal(np.load(tmp_path / "rows.npy"), rows)
    assert np.array_equal(np.load(tmp_path / "rows.npy", mmap_mode="r")[5], rows[5])


def test_no_rows_are_an_array_too(tmp_path: Path) -> None:
    store.ArrayWriter(tmp_path / "rows.npy", (4,), "<f8").close()
    assert np.load(tmp_path / "rows.npy").shape == (0, 4)


def test_a_new_folder_appears_only_when_all_went_well(tmp_path: Path) -> None:
    out = tmp_path / "out"

    def interrupted() -> None:
        with store.new_folder(out) as folder:
            (folder / "half").write_text("")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert list(tmp_path.iterdir()) == []
    # What a killed process left behind is no obstacle.
    (tmp_path / "out.partial").mkdir()
    (tmp_path / "out.partial" / "old").write_text("")
    with store.new_folder(out) as folder:
        (folder / "whole").write_text("")
        assert not out.exists()
    assert [path.name for path in out.iterdir()] == ["whole"]
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_what_is_looked_at_rarely_stays_on_disk(built) -> None:
    assert isinstance(built.rotations, np.memmap)
    assert isinstance(built.features, np.memmap)
    assert not isinstance(built.first_poses, np.memmap)
    assert built.features.shape == (9, 120, 97)
    assert built.rotations.dtype == built.features.dtype == np.float32


def test_the_digest_covers_every_row_and_the_calibration(built, built_folder: Path, tmp_path: Path) -> None:
    assert built.sha256 == store.digest(built_folder)
    copy = tmp_path / "copy"
    shutil.copytree(built_folder, copy)
    energies = np.load(copy / "linear_energies.npy")
    energies[3, 3] += 1e-12
    np.save(copy / "linear_energies.npy", energies)
    assert store.digest(copy) != built.sha256
    shutil.copy(built_folder / "linear_energies.npy", copy)
    assert store.digest(copy) == built.sha256
    store.write_calibration(copy, built.scaler, store.UNCALIBRATED)
    assert store.digest(copy) != built.sha256


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def empty(path: Path) -> None:
    path.write_bytes(b"")


def junk(path: Path) -> None:
    path.write_bytes(b"no library file at all")


@pytest.mark.parametrize("harm", [cut, empty, junk, Path.unlink])
@pytest.mark.parametrize(
    "name",
    ["manifest.json", "segments.parquet", "calibration.npz", "features.npy", "linear_energies.npy"],
)
def test_a_broken_library_is_named(built_folder: Path, tmp_path: Path, name: str, harm) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(built_folder, copy)
    harm(copy / name)
    with pytest.raises(InputError) as caught:
        open_library(copy)
    said = str(caught.value)
    assert said.startswith(f"{copy}: ")
    assert said.endswith("build it again.") or "build one with" in said
    assert "\n" not in said


@pytest.mark.parametrize(
    ("manifest", "message"),
    [
        ({}, "not a dance library; build one"),
        ([], "not a dance library; build one"),
        (
            {"version": 99},
            r"manifest\.json: a library of version 99, this studykit reads 1; build it again\.",
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
    np.save(copy / "first_poses.npy", np.load(copy / "first_poses.npy")[:-1])
    with pytest.raises(InputError, match=r"broken library \(arrays of different length\); build it again\."):
        open_library(copy)


def test_calibration_and_scaler_come_back_as_they_were(built, tmp_path: Path) -> None:
    store.write_calibration(tmp_path, built.scaler, built.calibration)
    with np.load(tmp_path / "calibration.npz") as saved:
        assert np.array_equal(saved["means"], built.scaler.means)
        assert np.array_equal(saved["join_displacements"], built.calibration.join_displacements)
        assert float(saved["median_distance"]) == built.calibration.median_distance
