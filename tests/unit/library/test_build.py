"""A library holds what was danced, cut, cleaned and measured as its modules say."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_file
from studykit.io.bvh import read_bvh
from studykit.io.datasets.read import files_in, find_recipe, read_takes
from studykit.io.datasets.take import Take, TakeSource
from studykit.io.skeleton_map import to_smpl
from studykit.library.build import build, write_library
from studykit.motion import energy, features, kinematics
from studykit.motion.motion import Motion
from studykit.motion.resampling import resampled


def test_takes_are_read_in_order_without_the_frames_to_skip(takes_folder: Path) -> None:
    recipe = find_recipe(takes_folder)
    takes = [
        take for path in files_in(takes_folder, recipe) for take in read_takes(path, takes_folder, recipe)
    ]
    assert [take.name for take in takes] == ["tango", "waltz/01", "waltz/02"]
    assert [len(take.motion) for take in takes] == [800, 960, 750]
    assert [take.motion.frame_rate_hz for take in takes] == pytest.approx([59.94, 60.0, 60.0], rel=1e-5)
    assert takes[1].source == TakeSource(
        data_set="three-takes",
        performer="Ada",
        genre="waltz",
        licence="CC0-1.0",
        is_synthetic=False,
        sha256=sha256_of_file(takes_folder / "waltz" / "01.bvh"),
    )


def test_whole_clean_segments_are_kept(built) -> None:
    # 13.3 s, 16 s and 12.5 s: the glitch after 4.5 s of the second costs one segment of four.
    table = built.segments
    assert table.groupby("take", sort=False)["start_s"].apply(list).to_dict() == {
        "tango": [0.0, 4.0, 8.0],
        "waltz/01": [0.0, pytest.approx(137 / 30), pytest.approx(257 / 30)],
        "waltz/02": [0.0, 4.0, 8.0],
    }
    assert table["id"].tolist() == list(range(9))
    assert set(table["genre"]) == {"tango", "waltz"}
    assert not built.is_synthetic
    assert len(built) == 9


def test_what_became_of_every_take_is_written_down(built_folder: Path) -> None:
    rows = pd.read_csv(built_folder / "yield.csv").set_index("take")
    assert rows["segments_possible"].to_dict() == {"tango": 3, "waltz/01": 4, "waltz/02": 3}
    assert rows["segments_kept"].to_dict() == {"tango": 3, "waltz/01": 3, "waltz/02": 3}
    assert rows["duration_s"].to_dict() == pytest.approx(
        {"tango": 800 / 59.94, "waltz/01": 16.0, "waltz/02": 12.5}, rel=1e-5
    )
    assert rows.loc["waltz/01", ["frames_speed", "frames_acceleration"]].tolist() == [2, 3]
    assert rows.loc["waltz/02", ["frames_speed", "frames_acceleration"]].tolist() == [0, 0]
    manifest = json.loads((built_folder / "manifest.json").read_text())
    assert manifest["segments"] == 9
    assert manifest["takes"] == 3
    assert manifest["genres"] == {"tango": 3, "waltz": 6}
    assert manifest["performers"] == {"Ada": 6, "Ben": 3}
    assert manifest["licences"] == {"CC0-1.0": 9}
    assert manifest["noise_rule"] == "robust"
    assert manifest["is_synthetic"] is False


def test_every_row_is_measured_on_its_own_120_poses(built, takes_folder: Path) -> None:
    take = to_smpl(read_bvh(takes_folder / "waltz" / "02.bvh.xz"), "smpl", units_m=0.01)
    whole = resampled(
        Motion(
            skeleton=take.skeleton,
            rotations=take.rotations[4:],
            root_positions=take.root_positions[4:],
            frame_rate_hz=60.0,
        ),
        30.0,
    )
    positions = kinematics.centred_positions(whole.skeleton, whole.rotations)
    row, frames = 7, slice(120, 240)
    assert built.linear_energies[row] == pytest.approx(energy.linear_energy(positions[frames], 30.0))
    assert built.rotational_energies[row] == pytest.approx(
        energy.rotational_energy(whole.rotations[frames], 30.0)
    )
    # Features know what came before and after; energies do not.
    assert built.features[row] == pytest.approx(
        features.pose_features(positions, 30.0)[frames], rel=1e-5, abs=1e-6
    )
    assert built.features[row][0, :72] != pytest.approx(
        features.pose_features(positions[frames], 30.0)[0, :72], rel=1e-3, abs=1e-9
    )


def test_segments_and_boundary_poses_look_ahead(built) -> None:
    for row in range(len(built)):
        motion = built.motion(row)
        positions = kinematics.joint_positions(motion)
        assert len(motion) == 120
        assert kinematics.facing(positions[0]) == pytest.approx(0.0, abs=1e-6)
        assert motion.root_positions[0, [0, 2]] == pytest.approx([0.0, 0.0], abs=1e-6)
        assert -0.25 < positions[..., 1].min() < 0.05  # the floor is at 0
        for pose, frame in ((built.first_poses[row], 0), (built.last_poses[row], -1)):
            assert kinematics.facing(pose) == pytest.approx(0.0, abs=1e-9)
            assert np.linalg.norm(pose, axis=-1) == pytest.approx(
                np.linalg.norm(positions[frame] - positions[frame, 0], axis=-1), abs=1e-6
            )


def test_walking_costs_nothing_by_itself(tmp_path: Path) -> None:
    # A statue carried through the room at 2 m/s: positions count from the pelvis.
    takes = [a_statue("one"), a_statue("two")]
    library = write_library(takes, tmp_path / "statues", name="statues")
    assert len(library) == 8
    assert library.linear_energies.sum() == pytest.approx(0.0, abs=1e-12)
    assert library.rotational_energies.sum() == pytest.approx(0.0, abs=1e-12)


def a_statue(name: str) -> Take:
    from studykit.motion import rotation
    from studykit.motion.skeleton import NEUTRAL_BODY

    return Take(
        name=name,
        motion=Motion(
            skeleton=NEUTRAL_BODY,
            rotations=rotation.identity(480, 24),
            root_positions=np.arange(480)[:, None] / 30.0 * np.array([2.0, 0.0, 0.0]),
            frame_rate_hz=30.0,
        ),
        source=TakeSource(
            data_set="made", performer="x", genre="none", licence="CC0-1.0", is_synthetic=True, sha256="0"
        ),
    )


def test_the_paper_s_rule_keeps_less(takes_folder: Path, built_folder: Path, tmp_path: Path) -> None:
    rows = pd.read_csv(built_folder / "yield.csv")
    assert rows["segments_paper"].sum() < rows["segments_kept"].sum()
    with pytest.raises(InputError, match=r"^three-takes: (no segment is left|\d segments)"):
        build({takes_folder: find_recipe(takes_folder)}, tmp_path / "paper", noise_rule="paper")
    assert list(tmp_path.iterdir()) == []


def test_the_same_takes_give_the_same_bytes(takes_folder: Path, built_folder: Path, tmp_path: Path) -> None:
    build({takes_folder: find_recipe(takes_folder)}, tmp_path / "again", seed=5)
    names = sorted(path.name for path in built_folder.iterdir())
    assert names == sorted(path.name for path in (tmp_path / "again").iterdir())
    for name in names:
        assert (tmp_path / "again" / name).read_bytes() == (built_folder / name).read_bytes(), name


@pytest.mark.parametrize("frames", [1, 2, 30])
def test_a_take_of_hardly_a_frame_gives_nothing(frames, tmp_path: Path) -> None:
    short = a_statue("short")
    short = Take(
        name="short",
        motion=Motion(
            skeleton=short.motion.skeleton,
            rotations=short.motion.rotations[:frames],
            root_positions=short.motion.root_positions[:frames],
            frame_rate_hz=30.0,
        ),
        source=short.source,
    )
    library = write_library([short, a_statue("one"), a_statue("two")], tmp_path / "out", name="statues")
    assert library.segments["take"].unique().tolist() == ["one", "two"]


class TestBadInput:
    """One sentence that names the place and the remedy, and nothing left behind."""

    @pytest.fixture
    def folder(self, takes_folder: Path, tmp_path: Path) -> Path:
        folder = tmp_path / "takes"
        folder.mkdir()
        for path in (takes_folder / "library.toml", takes_folder / "tango.bvh"):
            (folder / path.name).write_bytes(path.read_bytes())
        return folder

    @staticmethod
    def refusal(folder: Path, out: Path) -> str:
        before = sorted(path for path in out.parent.rglob("*") if path.exists())
        with pytest.raises(InputError) as caught:
            build({folder: find_recipe(folder)}, out)
        assert sorted(path for path in out.parent.rglob("*") if path.exists()) == before
        assert str(caught.value).endswith(".")
        assert "\n" not in str(caught.value)
        return str(caught.value)

    def test_no_takes(self, folder: Path, tmp_path: Path) -> None:
        (folder / "tango.bvh").unlink()
        assert self.refusal(folder, tmp_path / "out").startswith(f"{folder}: no take to read (BVH text")

    def test_a_folder_that_vanished(self, folder: Path, tmp_path: Path) -> None:
        with pytest.raises(InputError, match="there is no such folder"):
            files_in(tmp_path / "gone", find_recipe(folder))

    def test_one_take_alone(self, folder: Path, tmp_path: Path) -> None:
        assert self.refusal(folder, tmp_path / "out") == (
            "three-takes: 3 segments of 1 takes are too few to calibrate; "
            "give at least 8 segments (32 s) from two takes."
        )

    def test_a_broken_take_after_good_ones(self, folder: Path, tmp_path: Path) -> None:
        text = (folder / "tango.bvh").read_text()
        (folder / "zouk.bvh").write_text(text[:-500])
        said = self.refusal(folder, tmp_path / "out")
        assert said.startswith(f"{folder / 'zouk.bvh'}, line ")
        assert said.endswith("export the take again.")

    def test_a_take_with_nothing_but_frames_to_skip(self, folder: Path, tmp_path: Path) -> None:
        head, frames = (folder / "tango.bvh").read_text().split("Frames: 804\n")
        rows = frames.splitlines()[:6]
        take = folder / "tango.bvh"
        take.write_text(head + "Frames: 5\n" + "\n".join(rows) + "\n")
        assert self.refusal(folder, tmp_path / "out") == (
            f"{take}: has 5 frames, 4 are to be skipped; remove the file or lower skip_frames."
        )

    @pytest.mark.parametrize("kind", ["file", "folder"])
    def test_something_is_there_already(self, folder: Path, tmp_path: Path, kind: str) -> None:
        out = tmp_path / "out"
        if kind == "file":
            out.write_text("mine")
        else:
            out.mkdir()
            (out / "mine.txt").write_text("mine")
        assert self.refusal(folder, out) == (
            f"{out}: there is something already; choose another folder or remove it."
        )

    def test_a_place_that_cannot_be_written(self, folder: Path, tmp_path: Path) -> None:
        (tmp_path / "file").write_text("mine")
        said = self.refusal(folder, tmp_path / "file" / "out")
        assert said.startswith(f"{tmp_path / 'file' / 'out'}: cannot be written (")
        assert said.endswith("choose another folder.")
        assert (tmp_path / "file").read_text() == "mine"


def test_two_folders_make_one_library_and_rates_may_be_corrected(takes_folder: Path, tmp_path: Path) -> None:
    recipe = find_recipe(takes_folder)
    copy = tmp_path / "copy"
    shutil.copytree(takes_folder, copy)
    slower = recipe.model_copy(update={"data_set": "slower", "frame_rates_hz": {"*": 15.0}})
    both = build({takes_folder: recipe, copy: slower}, tmp_path / "both")
    assert both.name == f"{recipe.data_set}+slower"
    names = both.segments.groupby("data_set")["take"].unique()
    assert all(name.startswith("slower/") for name in names["slower"])
    counts = both.segments["data_set"].value_counts()
    assert counts["slower"] > counts[recipe.data_set]
