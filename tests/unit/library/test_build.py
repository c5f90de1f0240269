"""A library holds what was danced, cut, cleaned and measured as its modules say."""

from __future__ import annotations

import json
import lzma
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studykit.choreography.dance_library import DanceLibrary, distances
from studykit.choreography.neighbours import successors
from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_file, sha256_of_value
from studykit.io.bvh import read_bvh
from studykit.io.datasets.read import files_in, find_recipe, read_takes
from studykit.io.datasets.take import Take, TakeSource
from studykit.io.skeleton_map import to_smpl
from studykit.library import index, make_sample, open_library, shard, store
from studykit.library.build import build, build_from
from studykit.library.measure import Settings
from studykit.library.origin import Origin
from studykit.motion import energy, features, kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.resampling import resampled
from studykit.motion.skeleton import NEUTRAL_BODY


def takes_of(library: Path) -> pd.DataFrame:
    return pd.read_csv(store.index_folder(library) / store.TAKES).set_index("take")


def content(library: Path) -> dict[str, bytes]:
    """Give every file of a library by its path."""
    return {
        path.relative_to(library).as_posix(): path.read_bytes()
        for path in sorted(library.rglob("*"))
        if path.is_file()
    }


@dataclass(frozen=True)
class Made:
    """A source whose take is at hand."""

    take: Take

    @property
    def name(self) -> str:
        return self.take.name

    @property
    def data_set(self) -> str:
        return self.take.source.data_set

    def digest(self) -> str:
        return sha256_of_value([self.name, self.take.motion.rotations.tolist()])

    def takes(self) -> list[Take]:
        return [self.take]


def library_of(takes: list[Take], out: Path) -> DanceLibrary:
    return build_from([Made(take) for take in takes], out, Origin(name="statues"))


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
        "tango": pytest.approx([0.0, 240 / 59.94, 480 / 59.94]),
        "waltz/01": [0.0, pytest.approx(137 / 30), pytest.approx(257 / 30)],
        "waltz/02": [0.0, 4.0, 8.0],
    }
    assert table["id"].tolist() == list(range(9))
    assert set(table["genre"]) == {"tango", "waltz"}
    assert not built.is_synthetic
    assert len(built) == 9


def test_what_became_of_every_take_is_written_down(built_folder: Path) -> None:
    rows = takes_of(built_folder)
    assert rows["status"].to_dict() == {"tango": "kept", "waltz/01": "kept", "waltz/02": "kept"}
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


def test_peaks_are_those_of_the_poses_that_are_danced(built) -> None:
    for row in range(len(built)):
        motion = built.motion(row)
        steps = [
            (rotation.log(rotation.multiply(rotation.inverse(one), other)))
            for one, other in pairwise(motion.rotations)
        ]
        speeds = 30.0 * np.linalg.norm(steps, axis=-1).max(axis=0)
        angles = np.linalg.norm(rotation.log(motion.rotations), axis=-1).max(axis=0)
        # To the last digit, so that a limit set at a segment's own peak lets it pass.
        assert built.peak_speeds[row] == pytest.approx(speeds, rel=1e-9, abs=1e-9)
        assert built.peak_angles[row][1:] == pytest.approx(angles[1:], rel=1e-9, abs=1e-9)
        assert built.peak_angles[row][0] == 0.0
    assert built.peak_speeds.max() > 1.0


def test_successors_are_kept_with_the_library(built) -> None:
    assert np.array_equal(built.successors, successors(built.first_poses, built.last_poses))
    assert built.successors.shape == (len(built), len(built) - 1)
    first = [built.displacement(row, int(after[0])) for row, after in enumerate(built.successors)]
    last = [built.displacement(row, int(after[-1])) for row, after in enumerate(built.successors)]
    assert np.all(np.array(first) < np.array(last))


def test_a_large_library_keeps_reduced_distances(
    takes_folder: Path, built, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert built.reduced is None
    monkeypatch.setattr(index, "DENSE_LIMIT", 8)
    large = build({takes_folder: find_recipe(takes_folder)}, tmp_path / "large", settings=Settings(seed=5))
    assert large.reduced is not None
    exact = distances(built, "euclidean_z").between(range(9), range(9))
    assert large.reduced.between(range(9), range(9)) == pytest.approx(exact, rel=1e-3, abs=1e-2)


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
    library = library_of(takes, tmp_path / "statues")
    assert len(library) == 8
    assert library.linear_energies.sum() == pytest.approx(0.0, abs=1e-12)
    assert library.rotational_energies.sum() == pytest.approx(0.0, abs=1e-12)


def a_statue(name: str) -> Take:
    return Take(
        name=name,
        motion=Motion(
            skeleton=NEUTRAL_BODY,
            rotations=rotation.identity(480, 24),
            root_positions=np.arange(480)[:, None] / 30.0 * np.array([2.0, 0.0, 0.0]),
            frame_rate_hz=30.0,
        ),
        source=TakeSource(
            data_set="made", performer="x", genre="none", licence="CC0-1.0", is_synthetic=True, sha256=name
        ),
    )


def test_the_paper_s_rule_keeps_less(takes_folder: Path, built_folder: Path, tmp_path: Path) -> None:
    rows = takes_of(built_folder)
    assert rows["segments_paper"].sum() < rows["segments_kept"].sum()
    with pytest.raises(InputError, match=r"^three-takes: (no segment is left|\d segments)"):
        build(
            {takes_folder: find_recipe(takes_folder)},
            tmp_path / "paper",
            settings=Settings(noise_rule="paper"),
        )
    assert list(tmp_path.iterdir()) == []


def test_the_same_takes_give_the_same_bytes(takes_folder: Path, built_folder: Path, tmp_path: Path) -> None:
    again = tmp_path / "again"
    build({takes_folder: find_recipe(takes_folder)}, again, settings=Settings(seed=5), workers=2)
    assert content(again) == content(built_folder)


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
    library = library_of([short, a_statue("one"), a_statue("two")], tmp_path / "out")
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

    def test_a_broken_take_among_good_ones_is_left_out_and_listed(
        self, takes_folder: Path, tmp_path: Path
    ) -> None:
        folder = tmp_path / "takes"
        shutil.copytree(takes_folder, folder)
        (folder / "a-broken.bvh").write_text((folder / "tango.bvh").read_text()[:-500])
        library = build({folder: find_recipe(folder)}, tmp_path / "out")
        assert len(library) == 9
        rows = takes_of(tmp_path / "out")
        assert rows["status"].to_dict() == {
            "a-broken": "refused",
            "tango": "kept",
            "waltz/01": "kept",
            "waltz/02": "kept",
        }
        assert rows.loc["a-broken", "reason"].startswith("a-broken.bvh, line ")
        manifest = store.read_manifest(tmp_path / "out")
        assert (manifest["takes"], manifest["takes_refused"]) == (3, 1)

    def test_nothing_but_broken_takes(self, folder: Path, tmp_path: Path) -> None:
        (folder / "tango.bvh").write_text((folder / "tango.bvh").read_text()[:-500])
        said = self.refusal(folder, tmp_path / "out")
        assert said.startswith(f"{folder / 'tango.bvh'}, line ")
        assert said.endswith("export the take again.")

    def test_a_take_with_nothing_but_frames_to_skip(self, folder: Path, tmp_path: Path) -> None:
        head, frames = (folder / "tango.bvh").read_text().split("Frames: 804\n")
        rows = frames.splitlines()[:6]
        take = folder / "tango.bvh"
        take.write_text(head + "Frames: 5\n" + "\n".join(rows) + "\n")
        assert self.refusal(folder, tmp_path / "out") == (
            f"{take}: has 5 frames, 4 are to be skipped; remove the file or lower skip_frames."
        )

    def test_the_library_of_other_takes_is_not_replaced(self, folder: Path, tmp_path: Path, built) -> None:
        other = tmp_path / "statues"
        library_of([a_statue("one"), a_statue("two")], other)
        before = content(other)
        make_sample(tmp_path / "sample", segments=20, seed=1)
        sampled = content(tmp_path / "sample")
        with pytest.raises(InputError, match=r"sample: holds a library of other takes \(studykit-synthetic"):
            build({folder: find_recipe(folder)}, tmp_path / "sample")
        with pytest.raises(InputError, match="holds a library of other takes"):
            make_sample(tmp_path / "sample", segments=20, seed=2)
        assert content(tmp_path / "sample") == sampled
        assert content(other) == before

    @pytest.mark.parametrize("kind", ["file", "folder"])
    def test_something_is_there_already(self, folder: Path, tmp_path: Path, kind: str) -> None:
        out = tmp_path / "out"
        if kind == "file":
            out.write_text("mine")
        else:
            out.mkdir()
            (out / "mine.txt").write_text("mine")
            (out / "takes").mkdir()
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


def another_like(take: Path, other: Path) -> None:
    """Write a take that differs from another by a hair."""
    text = lzma.decompress(take.read_bytes()).decode()
    rows = text.splitlines()
    rows[-1] = " ".join(["0.001", *rows[-1].split()[1:]])
    other.write_bytes(lzma.compress("\n".join(rows).encode(), preset=0))


class TestBuildingAgain:
    """A second build makes only what is not there yet, and ends as if it were the first."""

    @pytest.fixture
    def folder(self, takes_folder: Path, tmp_path: Path) -> Path:
        shutil.copytree(takes_folder, tmp_path / "takes")
        return tmp_path / "takes"

    @pytest.fixture
    def made(self, monkeypatch: pytest.MonkeyPatch) -> list[str]:
        """List the takes whose shards are written from now on."""
        names: list[str] = []
        write = shard.write

        def told(library: Path, key: str, takes) -> dict:
            names.extend(take.name for take, _ in takes)
            return write(library, key, takes)

        monkeypatch.setattr(shard, "write", told)
        return names

    @staticmethod
    def fresh(folder: Path, out: Path, **options) -> dict[str, bytes]:
        build({folder: find_recipe(folder)}, out, **options)
        return content(out)

    def test_nothing_changed(self, folder: Path, tmp_path: Path, made: list[str]) -> None:
        first = self.fresh(folder, tmp_path / "out")
        times = {path: path.stat().st_mtime_ns for path in (tmp_path / "out").rglob("*")}
        made.clear()
        assert self.fresh(folder, tmp_path / "out") == first
        assert made == []
        assert {path: path.stat().st_mtime_ns for path in (tmp_path / "out").rglob("*")} == times

    def test_a_new_take_rewrites_no_other(self, folder: Path, tmp_path: Path, made: list[str]) -> None:
        kept = tmp_path / "later.bvh"
        (folder / "tango.bvh").rename(kept)
        # Not enough to calibrate with one genre alone? Eight chains of six waltz segments need all.
        with pytest.raises(InputError, match="too few to calibrate"):
            self.fresh(folder, tmp_path / "few")
        another_like(folder / "waltz" / "02.bvh.xz", folder / "waltz" / "03.bvh.xz")
        self.fresh(folder, tmp_path / "out")
        older = {path: path.read_bytes() for path in (tmp_path / "out" / "takes").iterdir()}
        made.clear()
        kept.rename(folder / "tango.bvh")
        grown = self.fresh(folder, tmp_path / "out")
        assert made == ["tango"]
        assert all(path.read_bytes() == data for path, data in older.items())
        assert grown == self.fresh(folder, tmp_path / "anew")

    @pytest.mark.parametrize(
        ("change", "again"),
        [
            (lambda folder: (folder / "tango.bvh").unlink(), []),
            (
                lambda folder: (folder / "library.toml").write_text(
                    (folder / "library.toml").read_text().replace('genre = "tango"', 'genre = "milonga"')
                ),
                ["tango"],
            ),
            (
                lambda folder: (folder / "tango.bvh").write_text((folder / "tango.bvh").read_text() + "\n"),
                ["tango"],
            ),
            (
                lambda folder: (folder / "library.toml").write_text(
                    (folder / "library.toml").read_text().replace("skip_frames = 4", "skip_frames = 5")
                ),
                ["tango", "waltz/01", "waltz/02", "waltz/03"],
            ),
        ],
        ids=["a take is gone", "a rule for one take", "a changed file", "a rule for all"],
    )
    def test_only_what_changed_is_read_again(
        self,
        folder: Path,
        tmp_path: Path,
        made: list[str],
        change: Callable[[Path], object],
        again: list[str],
    ) -> None:
        another_like(folder / "waltz" / "02.bvh.xz", folder / "waltz" / "03.bvh.xz")
        self.fresh(folder, tmp_path / "out")
        change(folder)
        made.clear()
        changed = self.fresh(folder, tmp_path / "out")
        assert made == again
        assert changed == self.fresh(folder, tmp_path / "anew")

    def test_what_an_interrupted_build_left_is_taken_up(
        self, folder: Path, tmp_path: Path, made: list[str], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        whole = self.fresh(folder, tmp_path / "whole")
        out = tmp_path / "out"
        write, count = shard.write, [0]

        def stops(library: Path, key: str, takes) -> dict:
            count[0] += 1
            if count[0] == 3:
                raise KeyboardInterrupt
            return write(library, key, takes)

        monkeypatch.setattr(shard, "write", stops)
        with pytest.raises(KeyboardInterrupt):
            self.fresh(folder, out)
        with pytest.raises(InputError, match="a library that is not finished; run the same build again"):
            open_library(out)
        # What a kill can leave: a file half written, another cut off although its outcome is there.
        (out / "takes" / f".{'ab' * 16}.npy.77.partial").write_bytes(b"half")
        cut_off = next((out / "takes").glob("*.small.npy"))
        cut_off.write_bytes(cut_off.read_bytes()[:-7])
        made.clear()
        monkeypatch.setattr(shard, "write", write)
        assert self.fresh(folder, out) == whole
        assert len(made) == 2


def test_mirrored_segments_are_the_same_dance_with_the_sides_exchanged(
    takes_folder: Path, tmp_path: Path, built
) -> None:
    both = build(
        {takes_folder: find_recipe(takes_folder)}, tmp_path / "both", settings=Settings(seed=5, mirrored=True)
    )
    table = both.segments
    assert len(both) == 18
    assert table["mirrored"].sum() == 9
    plain, other = both.find(mirrored=False), both.find(mirrored=True)
    assert both.linear_energies[plain] == pytest.approx(built.linear_energies)
    same = both.same_movement(np.arange(18)[:, None], np.arange(18))
    assert {(a, b) for a, b in zip(*np.nonzero(same), strict=True) if a < b} == set(
        zip(plain, other, strict=True)
    )
    swap = list(NEUTRAL_BODY.mirror)
    assert both.rotational_energies[other].sum() == pytest.approx(both.rotational_energies[plain].sum(), 0.05)
    turned = np.asarray(both.rotations[plain])[:, :, swap] * np.array([1.0, 1.0, -1.0, -1.0])
    inner = list(range(1, 24))  # the pelvis is turned to face ahead
    assert np.abs(np.sum(turned[:, :, inner] * both.rotations[other][:, :, inner], axis=-1)) == pytest.approx(
        1.0, abs=1e-5
    )


def test_a_stride_lets_segments_overlap(takes_folder: Path, tmp_path: Path) -> None:
    library = build(
        {takes_folder: find_recipe(takes_folder)}, tmp_path / "out", settings=Settings(stride_s=1.0)
    )
    starts = library.segments.query("take == 'waltz/02'")["start_s"].to_numpy()
    assert starts == pytest.approx(np.arange(len(starts)))
    assert len(starts) == 9
    first, second = library.rotations[library.find(take="waltz/02")[:2]]
    assert first[30:, 1:] == pytest.approx(second[:90, 1:], abs=1e-6)


def test_rows_are_read_in_the_order_asked_for(built) -> None:
    everything = np.asarray(built.features[:])
    assert everything.shape == built.features.shape == (9, 120, 97)
    for rows in ([8, 0, 3, 3], slice(2, 7, 2), np.array([5])):
        assert np.array_equal(built.features[rows], everything[rows])
    assert np.array_equal(built.features[4], everything[4])
    assert np.array_equal(built.features[-1], everything[-1])
    with pytest.raises(IndexError):
        built.features[9]


def test_segments_are_found_without_reading_an_array(built, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shard.SegmentRows, "__getitem__", lambda *_: pytest.fail("an array was read"))
    energies = built.segments["linear_energy"].to_numpy()
    middle = float(np.median(energies))
    found = built.find(genre="waltz", linear_energy=(middle, np.inf))
    assert found.tolist() == [
        row for row in range(9) if energies[row] >= middle and built.segments["genre"][row] == "waltz"
    ]
    assert len(built.find(performer="Nobody")) == 0
    with pytest.raises(InputError, match="three-takes: segments have no 'gnere'; choose from id, take"):
        built.find(gnere="waltz")
    assert energies == pytest.approx(built.linear_energies.sum(axis=1))


def test_the_same_recording_twice_counts_once(takes_folder: Path, tmp_path: Path) -> None:
    folder = tmp_path / "takes"
    shutil.copytree(takes_folder, folder)
    shutil.copy(folder / "tango.bvh", folder / "tango-again.bvh")
    library = build(folder, tmp_path / "out")
    assert len(library) == 9
    row = takes_of(tmp_path / "out").loc["tango"]
    assert (row["status"], row["reason"]) == (
        "refused",
        "tango: is the same recording as tango-again; remove one of them.",
    )


def test_two_files_of_one_name_are_told_before_anything_is_read(
    takes_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "takes"
    shutil.copytree(takes_folder, folder)
    (folder / "tango.bvh.xz").write_bytes(lzma.compress((folder / "tango.bvh").read_bytes()))
    monkeypatch.setattr(shard, "write", lambda *_: pytest.fail("a take was read"))
    with pytest.raises(
        InputError, match=r"tango\.bvh and .*tango\.bvh\.xz: two takes are called tango; remove"
    ):
        build([folder], tmp_path / "out")


@pytest.mark.parametrize("out", [".", "takes/library", ".."])
def test_a_library_and_its_takes_lie_apart(
    takes_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, out: str
) -> None:
    # A folder of takes called "takes" once was taken for what an interrupted build had left.
    study = tmp_path / "study"
    shutil.copytree(takes_folder, study / "takes")
    before = content(study)
    monkeypatch.chdir(study)
    with pytest.raises(InputError, match="would lie in one another"):
        build(["takes"], out)
    (study / "elsewhere").mkdir()
    (study / "elsewhere" / "takes").symlink_to(study / "takes")
    with pytest.raises(InputError, match="there is something already"):
        make_sample(study / "elsewhere", segments=20)
    (study / "elsewhere" / "takes").unlink()
    (study / "elsewhere").rmdir()
    assert content(study) == before


def test_what_others_keep_in_a_library_s_folder_is_not_touched(takes_folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    build(takes_folder, out)
    for name in ("takes/mine.bvh", "index-of-mine/notes.txt", "notes.txt"):
        (out / name).parent.mkdir(exist_ok=True)
        (out / name).write_text("mine")
    build(takes_folder, out, settings=Settings(seed=9))
    for name in ("takes/mine.bvh", "index-of-mine/notes.txt", "notes.txt"):
        assert (out / name).read_text() == "mine"


def test_a_failed_build_leaves_its_neighbours(takes_folder: Path, tmp_path: Path) -> None:
    libraries = tmp_path / "new" / "libraries"

    def progress(items, *, label: str, total: int):
        build(takes_folder, libraries / "neighbour")
        yield from ()
        raise InputError("something", where="somewhere", remedy="do it again")

    with pytest.raises(InputError, match="somewhere: something"):
        build(takes_folder, libraries / "mine", progress=progress)
    assert [path.name for path in libraries.iterdir() if path.is_dir()] == ["neighbour"]


def test_two_builds_at_once_do_not_mix(takes_folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"

    def progress(items, *, label: str, total: int):
        with pytest.raises(InputError, match="out: another build is at work on it; wait until it is done"):
            build(takes_folder, out)
        return items

    assert len(build(takes_folder, out, progress=progress)) == 9


@pytest.mark.parametrize("harm", ["flip", "cut", "remove"])
@pytest.mark.parametrize("name", ["segments.parquet", "linear_energies.npy", "shard", "small shard"])
def test_building_again_mends_what_is_broken(
    takes_folder: Path, tmp_path: Path, harm: str, name: str
) -> None:
    out = tmp_path / "out"
    build(takes_folder, out)
    whole = content(out)
    patterns = {"shard": "takes/*[0-9a-f].npy", "small shard": "takes/*.small.npy"}
    path = min(
        path
        for path in out.glob(patterns.get(name, f"index-*/{name}"))
        if "small" in name or ".small" not in path.name
    )
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    changed = {"flip": bytes(data), "cut": bytes(data[:-9]), "remove": None}[harm]
    path.unlink() if changed is None else path.write_bytes(changed)
    with pytest.raises(InputError, match="is not what was written"):
        store.require_intact(out)
    build(takes_folder, out)
    assert content(out) == whole
    store.require_intact(out)


def test_no_place_on_this_machine_is_named_in_a_library(takes_folder: Path, tmp_path: Path) -> None:
    folder = tmp_path / "a very private place"
    shutil.copytree(takes_folder, folder)
    (folder / "broken.bvh").write_text("nonsense")
    build(folder, tmp_path / "out")
    for path, data in content(tmp_path / "out").items():
        assert b"private place" not in data, path
    assert "a very private place" in store.beside(tmp_path / "out", store.SOURCES).read_text()


def test_a_library_moved_or_built_from_a_moved_folder_is_the_same(takes_folder: Path, tmp_path: Path) -> None:
    first = build(takes_folder, tmp_path / "one")
    shutil.copytree(takes_folder, tmp_path / "moved")
    build(tmp_path / "moved", tmp_path / "two")
    assert content(tmp_path / "one") == content(tmp_path / "two")
    (tmp_path / "one").rename(tmp_path / "three")
    assert open_library(tmp_path / "three").sha256 == first.sha256


@pytest.mark.parametrize(
    "settings", [{"stride_s": 0.0}, {"stride_s": 9.0}, {"stride_s": float("nan")}, {"noise_rule": "strict"}]
)
def test_settings_that_make_no_sense(settings) -> None:
    with pytest.raises(InputError, match="say "):
        Settings(**settings)


def test_rows_of_no_or_of_too_many_dimensions(built) -> None:
    assert built.features[[]].shape == (0, 120, 97)
    assert built.standardised(np.zeros(0, dtype=int)).shape == (0, 11_640)
    assert np.array_equal(built.features[np.arange(9) == 4], built.features[[4]])
    with pytest.raises(IndexError):
        built.features[np.zeros((2, 2), dtype=int)]
    assert built.find(genre=["waltz", "tango"]).tolist() == list(range(9))


def test_a_library_built_again_under_a_reader_says_so(takes_folder: Path, tmp_path: Path) -> None:
    folder = tmp_path / "takes"
    shutil.copytree(takes_folder, folder)
    reader = build(folder, tmp_path / "out")
    recipe = folder / "library.toml"
    recipe.write_text(recipe.read_text().replace("skip_frames = 4", "skip_frames = 6"))
    build(folder, tmp_path / "out")
    shard._mapped.cache_clear()  # what was looked at before is still mapped
    with pytest.raises(InputError, match="out: was built again meanwhile; open it again"):
        reader.features[0]


def built_to(folder: Path, out: Path) -> Path:
    build(folder, out)
    return out


def test_a_full_disk_stops_the_build_and_costs_nothing(
    takes_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = content(built_to(takes_folder, tmp_path / "whole"))
    write, count = shard.write, [0]

    def full(library: Path, key: str, takes):
        count[0] += 1
        if count[0] == 2:
            raise OSError(28, "No space left on device")
        return write(library, key, takes)

    monkeypatch.setattr(shard, "write", full)
    with pytest.raises(InputError, match=r"cannot be written \(No space left on device\); make room and run"):
        build(takes_folder, tmp_path / "out")
    assert len(list((tmp_path / "out" / "takes").glob("*.json"))) == 1
    assert content(built_to(takes_folder, tmp_path / "out")) == whole


def test_a_file_that_cannot_be_read_is_left_out(
    takes_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "takes"
    shutil.copytree(takes_folder, folder)
    (folder / "broken.bvh").symlink_to("/proc/self/mem")  # opens, but gives an error when it is read
    build(folder, tmp_path / "out")
    row = takes_of(tmp_path / "out").loc["broken"]
    assert row["status"] == "refused"
    assert "cannot be read" in row["reason"]
