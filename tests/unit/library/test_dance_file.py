"""Dances are written for all kinds of readers and read back as they were."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studykit.choreography.choreograph import dance
from studykit.choreography.dance import Dance
from studykit.choreography.preset import STUDYKIT
from studykit.choreography.targets import goal
from studykit.core.durable import put
from studykit.core.errors import InputError
from studykit.io.bvh import read_bvh
from studykit.io.protocol_file import read_protocol
from studykit.io.skeleton_map import to_smpl
from studykit.library import read_dances, write_dances
from studykit.library.dance_file import read_dance
from studykit.motion import kinematics, rotation
from studykit.motion.joint_mask import spare
from studykit.motion.skeleton import NEUTRAL_PELVIS
from studykit.protocol.condition import Condition

PROTOCOL = Path(__file__).parents[3] / "protocols" / "dance-2x2x2.toml"


@pytest.fixture(scope="module")
def made(made_library) -> Dance:
    """Give a first look at a dance of 32 s that spares the right elbow, near its targets or not."""
    plan = read_protocol(PROTOCOL).dance
    library = made_library(12)
    asked = replace(
        goal(plan, Condition.parse("light-easy-on"), library),
        preset=replace(STUDYKIT, is_reached=False),
        mask=spare("right_elbow", weights=0.5),
    )
    return dance(asked, library, seed=3, is_preview=True)


@pytest.fixture(scope="module")
def folder(made, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dances") / "new"
    write_dances({made.condition: made}, folder)
    return folder


def test_a_dance_comes_back_as_it_was(made, folder: Path) -> None:
    again = read_dance(folder, "light-easy-on")
    assert again.to_dict() | {"joints": {}} == made.to_dict() | {"joints": {}}
    assert again.sha256 == made.sha256
    assert again.trace == made.trace
    assert len(again.motion) == 960
    turned = rotation.between(made.motion.rotations, again.motion.rotations)
    assert np.abs(turned).max() < 1e-7
    assert again.motion.root_positions == pytest.approx(made.motion.root_positions, abs=1e-12)
    assert list(read_dances(folder)) == ["light-easy-on"]


def test_the_archive_is_that_of_amass(made, folder: Path) -> None:
    with np.load(folder / "light-easy-on.npz", allow_pickle=False) as saved:
        assert saved["poses"].shape == (960, 156)
        assert saved["dmpls"].shape == (960, 8)
        assert np.array_equal(saved["betas"], np.zeros(16))
        assert str(saved["gender"]) == "neutral"
        assert float(saved["mocap_framerate"]) == 30.0
        # Z is up, and SMPL adds its own rest pelvis to the translation.
        x, y, z = (saved["trans"] + NEUTRAL_PELVIS).T
        assert np.stack((x, z, -y), axis=1) == pytest.approx(made.motion.root_positions)


def test_the_avatar_says_where_it_comes_from(made, folder: Path) -> None:
    data = (folder / "light-easy-on.glb").read_bytes()
    document = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
    assert document["asset"]["extras"] == {
        "condition": "light-easy-on",
        "is_synthetic": True,
        "licences": ["CC0-1.0"],
        "sha256": made.sha256,
    }
    assert document["animations"][0]["name"] == "light-easy-on"
    assert [material["name"] for material in document["materials"]] == [
        "middle",
        "left",
        "right",
        "right spared",
    ]
    assert sum(path.stat().st_size for path in folder.iterdir()) < 4_000_000


def test_tables_of_joints_come_when_asked_for(made, folder: Path, tmp_path: Path) -> None:
    assert sorted(path.suffix for path in folder.iterdir()) == [".bvh", ".glb", ".json", ".npz"]
    write_dances({made.condition: made}, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    write_dances({made.condition: made}, tmp_path, with_joint_tables=True)
    table = (tmp_path / "light-easy-on.csv").read_text().splitlines()
    assert len(table) == 1 + 960
    assert table[0].startswith("time_s,pelvis_x,pelvis_y,pelvis_z,left_hip_x")
    assert all((tmp_path / name).read_bytes() == content for name, content in before.items())


@pytest.mark.parametrize("failing", ["bvh", "glb", "npz", "json"])
def test_a_dance_is_whole_or_not_there(
    made, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: str
) -> None:
    def full(path: Path, content: bytes | str) -> None:
        if path.suffix == f".{failing}":
            raise OSError(28, "No space left on device")
        put(path, content)

    with monkeypatch.context() as patched:
        patched.setattr("studykit.library.dance_file.put", full)
        with pytest.raises(InputError, match=r"cannot be written \(No space left on device\)"):
            write_dances({made.condition: made}, tmp_path)
    with pytest.raises(InputError, match="no dances here"):
        read_dances(tmp_path)
    # What was left is written anew.
    for path in tmp_path.iterdir():
        path.write_bytes(b"old")
    write_dances({made.condition: made}, tmp_path)
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == {
        p.name: p.read_bytes() for p in folder.iterdir()
    }


def test_the_bvh_shows_the_same_dance(made, folder: Path) -> None:
    shown = to_smpl(read_bvh(folder / "light-easy-on.bvh"), "smpl", units_m=0.01)
    difference = kinematics.joint_positions(shown) - kinematics.joint_positions(made.motion)
    assert np.abs(difference).max() < 1e-3
    assert shown.duration_s == pytest.approx(32.0, rel=1e-6)


def test_the_json_holds_every_number(made, folder: Path) -> None:
    said = json.loads((folder / "light-easy-on.json").read_text())
    assert said["condition"] == "light-easy-on"
    assert said["is_synthetic"] is True
    assert set(said["asked"]) == set(said["achieved"]) == set(said["achieved_blended"])
    terms = {"duration", "transition", "variety", "linear", "rotational", "mask"}
    assert set(said["cost"]["terms"]) == set(said["cost"]["weights"]) == terms
    assert list(said["spared"]) == ["right_elbow", "right_wrist", "right_hand"]
    assert len(said["segments"]) == 8
    assert set(said["segments"][0]) == {"id", "take", "start_s", "mirrored", "licence", "spliced_from"}
    assert [join["displacement_m"] for join in said["joins"]] == list(made.displacements_m)
    assert len(said["joints"]) == 24
    elbow = said["joints"]["right_elbow"]
    assert elbow["peak_rad_s"] > elbow["mean_rad_s"] > 0.0
    assert said["library_sha256"] == "0" * 64
    # What the segments ask for is exact; what is shown has its joins blended.
    assert said["achieved_blended"]["linear_energy"] > 0.0
    assert said["achieved"]["duration_s"] == said["achieved_blended"]["duration_s"] == 32.0


def test_the_same_dance_gives_the_same_bytes(made, folder: Path, tmp_path: Path) -> None:
    write_dances({made.condition: made}, tmp_path)
    for path in folder.iterdir():
        assert (tmp_path / path.name).read_bytes() == path.read_bytes()


def test_a_dance_that_is_there_already_stays_and_another_is_refused(
    made, folder: Path, tmp_path: Path
) -> None:
    for path in folder.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    # What was recorded keeps its bytes, even where this version would write them in another way.
    recorded = tmp_path / "light-easy-on.bvh"
    recorded.write_text("as it was shown")
    write_dances({made.condition: made}, tmp_path)
    assert recorded.read_text() == "as it was shown"
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(InputError, match="another dance light-easy-on is there already"):
        write_dances({made.condition: replace(made, library_sha256="1" * 64)}, tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize("suffix", [".npz", ".json"])
@pytest.mark.parametrize("harm", ["gone", "cut", "empty", "{}"])
def test_a_broken_dance_is_named(folder: Path, tmp_path: Path, suffix: str, harm: str) -> None:
    for path in folder.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    path = tmp_path / f"light-easy-on{suffix}"
    if harm == "gone":
        path.unlink()
    else:
        path.write_bytes({"cut": path.read_bytes()[:3000], "empty": b"", "{}": b"{}"}[harm])
    with pytest.raises(InputError) as caught:
        read_dance(tmp_path, "light-easy-on")
    assert str(caught.value).startswith(f"{tmp_path / 'light-easy-on'}: no dance can be read (")
    assert str(caught.value).endswith("; make it again with 'studykit choreograph'.")


def test_a_changed_movement_is_not_taken_for_the_dance(folder: Path, tmp_path: Path) -> None:
    for path in folder.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    archive = tmp_path / "light-easy-on.npz"
    with np.load(archive) as saved:
        arrays = dict(saved)
    np.savez(archive, **(arrays | {"poses": 0.9 * arrays["poses"]}))
    with pytest.raises(InputError, match="not the one that was written"):
        read_dance(tmp_path, "light-easy-on")


def test_a_folder_without_dances(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no dances here; make them with"):
        read_dances(tmp_path)


@pytest.mark.parametrize("name", ["../elsewhere", "a/b", "/elsewhere"])
def test_a_name_that_leads_elsewhere_is_refused(made, tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="is no name of a file; name dances by their conditions"):
        write_dances({name: made}, tmp_path / "dances")
    assert not list(tmp_path.iterdir())


def test_a_place_that_cannot_be_written(made, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    with pytest.raises(InputError, match=r"file/dances: cannot be written \(.*\); choose another folder\."):
        write_dances({made.condition: made}, tmp_path / "file" / "dances")
    assert (tmp_path / "file").read_text() == "mine"
