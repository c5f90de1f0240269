"""Every real recording that lies beside the project is read as what it is: how long, whose, which side."""

from __future__ import annotations

import csv
import shutil
import tarfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io.asf_amc import read_asf, read_asf_amc
from studykit.io.bvh import read_bvh
from studykit.io.datasets.known import DATASETS
from studykit.io.datasets.read import find_recipe, named_recipe, plain_path, read_takes
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.take import Take
from studykit.io.skeletal_take import SkeletalTake
from studykit.io.skeleton_map import skeleton_map, to_smpl
from studykit.motion import kinematics, rotation
from studykit.motion.plausibility import implausible
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY

UNIT_M = 0.0254 / 0.45
BANDAI = "bandai-namco-1-nc/data.tar.xz::data/"
ONE_OF_EACH = (
    "cmu-bvh-acrnn/salsa/16.bvh.xz",
    "cmu-bvh-acrnn/indian/13.bvh.xz",
    "cmu-bvh-acrnn/martial/04.bvh.xz",
    "cmu-fbx-keijiro/bvh/85_12.bvh.xz",
    "cmu-fbx-keijiro/bvh/85_14.bvh.xz",
    "cmu-asfamc-samples/11_01.amc.xz",
    "cmu-asfamc-samples/01_01.bvh.xz",
    "aistpp-edge-positions/true_gBR_sBM_cAll_d04_mBR0_ch02_slice0.csv",
    "aistpp-edge-positions/groundTruthMatch.dc10374.csv",
    "mocaptoolbox-demo/walk1.tsv.xz",
    f"{BANDAI}dataset-1_kick_normal_001.bvh",
    f"{BANDAI}dataset-1_bow_active_001.bvh",
)
PERFORMERS = {  # where the index has words of its own
    "Bandai Namco actor (1 of 3, not told)": "Bandai Namco (one of three)",
}
GENRES = {  # AIST's own words
    "aistpp-edge-positions": {
        "breakdance": "break",
        "street-jazz": "street jazz",
        "hip-hop": "LA hip-hop",
        "unknown": "not stated",
    },
}


class Found(NamedTuple):
    """Where a row of the index lies, and how it is read."""

    path: Path
    folder: Path
    recipe: Recipe


@pytest.fixture(scope="session")
def motion(shared_data: Callable[[str], Path]) -> Path:
    return shared_data("motion")


@pytest.fixture(scope="session")
def index(motion: Path) -> dict[str, dict[str, str]]:
    with (motion / "INDEX.csv").open(newline="") as file:
        return {row["path"]: row for row in csv.DictReader(file)}


@pytest.fixture(scope="session")
def unpacked(motion: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("bandai")
    with tarfile.open(motion / "bandai-namco-1-nc" / "data.tar.xz") as archive:
        archive.extractall(out, filter="data")
    return out / "data"


@pytest.fixture(scope="session")
def find(motion: Path, unpacked: Path) -> Callable[[str], Found]:
    recipes = cache(find_recipe)

    def found(name: str) -> Found:
        if name.startswith(BANDAI):
            folder, path = unpacked, unpacked / name.removeprefix(BANDAI)
        else:
            folder = motion / name.partition("/")[0]
            path = motion / name
        if name == "cmu-asfamc-samples/01_01.bvh.xz":  # another format in the folder of another recipe
            return Found(path, folder, named_recipe("cmu-motionbuilder"))
        return Found(path, folder, recipes(folder))

    return found


@pytest.fixture(scope="session")
def take(find: Callable[[str], Found]) -> Callable[[str], Take]:
    @cache
    def read(name: str) -> Take:
        (one,) = read_takes(*find(name))
        return one

    return read


# --- each of them ----------------------------------------------------------------------------------------


def knees_bent_backwards(positions: np.ndarray) -> float:
    """Give the share of bent knees (over 15 degrees) whose shank goes backwards, seen from the hips."""
    at = {name: positions[:, joint] for joint, name in enumerate(JOINT_NAMES)}
    left = unit(at["left_hip"] - at["right_hip"])
    sines = [
        np.sum(
            np.cross(
                unit(at[f"{side}_knee"] - at[f"{side}_hip"]), unit(at[f"{side}_ankle"] - at[f"{side}_knee"])
            )
            * left,
            axis=1,
        )
        for side in ("left", "right")
    ]
    bent = np.concatenate(sines)
    bent = bent[np.abs(bent) > np.sin(np.radians(15.0))]
    return float(np.mean(bent > 0.0)) if len(bent) else 1.0


def toes_ahead(positions: np.ndarray) -> float:
    """Give the share of frames with toes ahead of the ankles, by left and up of the body."""
    at = {name: positions[:, joint] for joint, name in enumerate(JOINT_NAMES)}
    ahead = np.cross(at["left_hip"] - at["right_hip"], at["neck"] - at["pelvis"])
    toes = at["left_foot"] + at["right_foot"] - at["left_ankle"] - at["right_ankle"]
    return float(np.mean(np.sum(toes * ahead, axis=1) > 0.0))


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def check(name: str, row: dict[str, str], found: Found, one: Take) -> None:
    """Check what is known of one recording against what was read."""
    skipped = found.recipe.skip_frames
    assert len(one.motion) == int(row["frames"]) - skipped, name
    assert one.motion.frame_rate_hz == pytest.approx(float(row["fps_true"]), rel=2e-5), name
    seconds = (len(one.motion) + skipped) / one.motion.frame_rate_hz
    extra = 1 if name.endswith("01_01.bvh.xz") else 0  # the index does not count the T-pose here
    assert seconds == pytest.approx(float(row["seconds"]) + extra / 120.0, abs=0.01), name

    words = GENRES.get(row["source"], {})
    if not name.endswith("01_01.bvh.xz"):
        assert one.source.genre == words.get(row["genre"], row["genre"]), name
        assert one.source.performer == PERFORMERS.get(row["person"], row["person"]), name
    assert row["licence"].split(";")[0].split(" (")[0].replace("CMU free use", "CMU") in one.source.licence
    assert not one.source.is_synthetic

    positions = kinematics.joint_positions(one.motion)
    assert np.all(np.isfinite(positions))
    assert knees_bent_backwards(positions) > 0.99, name
    assert toes_ahead(positions) > 0.65, name  # runners throw their feet back; mirrored: below 0.35
    turns = rotation.between(one.motion.rotations[:-1], one.motion.rotations[1:])
    jump = np.linalg.norm(turns, axis=-1).max(axis=1) * one.motion.frame_rate_hz / 30.0
    assert np.mean(jump > 1.5) < 0.05, name  # rad a frame at 30 Hz; some takes have glitches
    knees = rotation.log(one.motion.rotations[:, [4, 5]]).reshape(-1, 3)
    bent = np.linalg.norm(knees, axis=-1) > np.radians(30.0)
    if bent.sum() > 20:
        axis = unit(knees[bent].mean(axis=0))
        assert axis[0] > 0.93, name  # about the axis from right to left


@pytest.mark.parametrize("name", ONE_OF_EACH)
def test_a_recording_of_each_kind_is_what_it_is(
    index: dict[str, dict[str, str]],
    find: Callable[[str], Found],
    take: Callable[[str], Take],
    name: str,
) -> None:
    check(name, index[name], find(name), take(name))


@pytest.mark.slow
def test_every_recording_is_what_it_is(
    index: dict[str, dict[str, str]], find: Callable[[str], Found], motion: Path
) -> None:
    counts: dict[str, int] = {}
    for name, row in index.items():
        (one,) = read_takes(*find(name))
        check(name, row, find(name), one)
        counts[one.source.data_set] = counts.get(one.source.data_set, 0) + 1
    assert counts == {
        "cmu-dance": 34,
        "cmu-neo": 3,
        "aistpp-positions": 6,
        "mocap-toolbox": 2,
        "cmu-asf-amc": 2,
        "cmu-motionbuilder": 1,
        "bandai-namco": 141,
    }


def test_couples_are_told_of_each_other(take: Callable[[str], Take], motion: Path) -> None:
    recipe = find_recipe(motion / "cmu-bvh-acrnn")
    for lead in (1, 2, 3, 4, 5, 6, 7, 9, 10, 11, 12):
        assert recipe.partners(f"salsa/{lead:02d}") == (f"salsa/{lead + 15:02d}",)
        assert recipe.partners(f"salsa/{lead + 15:02d}") == (f"salsa/{lead:02d}",)
    assert take("cmu-bvh-acrnn/salsa/16.bvh.xz").source.partners == ("salsa/01",)
    assert take("cmu-bvh-acrnn/martial/04.bvh.xz").source.partners == ()


def test_the_recipe_of_each_folder_is_found(find: Callable[[str], Found]) -> None:
    assert {name: find(name).recipe.data_set for name in ONE_OF_EACH} == dict(
        zip(
            ONE_OF_EACH,
            (
                *["cmu-dance"] * 3,
                *["cmu-neo"] * 2,
                "cmu-asf-amc",
                "cmu-motionbuilder",
                *["aistpp-positions"] * 2,
                "mocap-toolbox",
                *["bandai-namco"] * 2,
            ),
            strict=True,
        )
    )


# --- against each other, and against deliberate mistakes ------------------------------------------------


def foreign_positions(take: SkeletalTake, *, thorax: np.ndarray | None = None) -> dict[str, np.ndarray]:
    """Give where the joints of a file's own skeleton are."""
    world = np.array(take.rotations)
    places = np.zeros((*world.shape[:2], 3))
    places[:, 0] = take.root_positions
    for joint, parent in enumerate(take.parents):
        if parent >= 0:
            world[:, joint] = rotation.multiply(world[:, parent], take.rotations[:, joint])
            offset = take.offsets[joint]
            if thorax is not None and take.joint_names[joint] in ("Neck", "LeftShoulder", "RightShoulder"):
                offset = thorax
            step = take.shifts.get(joint, offset)
            places[:, joint] = places[:, parent] + rotation.rotate(world[:, parent], step)
    return {name: places[:, joint] for joint, name in enumerate(take.joint_names)}


def test_an_amc_is_the_bvh_of_the_same_take(motion: Path) -> None:
    # The conversion to BVH lost the thorax (its offset is 0 0 0); with it every joint is where the AMC says.
    folder = motion / "cmu-asfamc-samples"
    amc = read_asf_amc(folder / "01_01.amc.xz", folder / "01.asf")
    bvh = read_bvh(folder / "01_01.bvh.xz")
    skeleton = read_asf(folder / "01.asf")
    thorax = skeleton.offsets[skeleton.names.index("lowerneck")] / UNIT_M
    ours, theirs = foreign_positions(amc), foreign_positions(bvh, thorax=thorax)
    first, second = skeleton_map("cmu-asf").joints, skeleton_map("motionbuilder").joints
    for joint in set(first) - {"left_hand", "right_hand"}:  # the wrists' lengths were lost likewise
        away = np.linalg.norm(ours[first[joint]] - UNIT_M * theirs[second[joint]][1:], axis=-1)
        assert away.max() < 1e-5, joint  # m
    one = to_smpl(amc, "cmu-asf", units_m=1.0)
    other = to_smpl(bvh, "motionbuilder", units_m=UNIT_M)
    turns = rotation.between(one.rotations, other.rotations[1:])
    assert np.linalg.norm(turns, axis=-1).max() < 1e-4


def limb_angles(
    foreign: SkeletalTake, skeleton: str, units_m: float, *, skip: int = 0, carried_by: str = ""
) -> dict[str, float]:
    """Give the median angle, degrees, between whole limbs of a file and of the body it was carried to."""
    joints = skeleton_map(skeleton).joints
    theirs = foreign_positions(foreign)
    ours = kinematics.joint_positions(to_smpl(foreign, carried_by or skeleton, units_m=units_m))
    out = {}
    for first, last in (
        ("left_hip", "left_ankle"),
        ("right_hip", "right_ankle"),
        ("left_shoulder", "left_wrist"),
        ("right_shoulder", "right_wrist"),
    ):
        seen = unit(theirs[joints[last]] - theirs[joints[first]])[skip:]
        got = unit(ours[:, JOINT_NAMES.index(last)] - ours[:, JOINT_NAMES.index(first)])[skip:]
        cosines = np.clip(np.sum(seen * got, axis=1), -1.0, 1.0)
        out[f"{first} {last}"] = float(np.degrees(np.median(np.arccos(cosines))))
    return out


def foreign(find: Callable[[str], Found], motion: Path) -> Iterator[tuple[SkeletalTake, str, float, int]]:
    folder = motion / "cmu-asfamc-samples"
    yield read_asf_amc(folder / "11_01.amc.xz", folder / "11.asf"), "cmu-asf", 1.0, 0
    yield read_bvh(folder / "01_01.bvh.xz"), "motionbuilder", UNIT_M, 1
    for kick in ("kick_normal_001", "dance-short_normal_001"):
        yield read_bvh(find(f"{BANDAI}dataset-1_{kick}.bvh").path), "bandai", 0.01, 0
    yield read_bvh(motion / "cmu-fbx-keijiro" / "bvh" / "85_12.bvh.xz"), "neo", 0.01, 0


def test_limbs_point_where_they_point_in_the_file(find: Callable[[str], Found], motion: Path) -> None:
    for one, skeleton, units_m, skip in foreign(find, motion):
        assert max(limb_angles(one, skeleton, units_m, skip=skip).values()) < 8.0, skeleton


def test_angles_copied_from_a_zero_pose_that_is_no_t_pose_would_be_noticed(
    find: Callable[[str], Found], tmp_path: Path
) -> None:
    # Wrong: the map of the same joints without their turns.
    lines = [f'{smpl} = "{name}"' for smpl, name in skeleton_map("bandai").joints.items()]
    wrong = tmp_path / "wrong.toml"
    wrong.write_text("[joints]\n" + "\n".join(lines))
    kick = read_bvh(find(f"{BANDAI}dataset-1_kick_normal_001.bvh").path)
    assert max(limb_angles(kick, str(wrong), 0.01).values()) > 60.0
    assert implausible(to_smpl(kick, str(wrong), units_m=0.01)) is not None


def test_left_taken_for_right_in_a_map_would_be_noticed(motion: Path, tmp_path: Path) -> None:
    joints = skeleton_map("neo").joints
    other = {name: JOINT_NAMES[NEUTRAL_BODY.mirror[NEUTRAL_BODY.index(name)]] for name in joints}
    wrong = tmp_path / "wrong.toml"
    wrong.write_text("[joints]\n" + "\n".join(f'{name} = "{joints[other[name]]}"' for name in joints))
    one = read_bvh(motion / "cmu-fbx-keijiro" / "bvh" / "135_01.bvh.xz")
    assert max(limb_angles(one, "neo", 0.01, carried_by=str(wrong)).values()) > 25.0


@pytest.mark.parametrize("name", ["85_12", "135_01"])
def test_a_transposed_rotation_is_refused(motion: Path, name: str) -> None:
    one = read_bvh(motion / "cmu-fbx-keijiro" / "bvh" / f"{name}.bvh.xz")
    wrong = replace(one, rotations=rotation.inverse(one.rotations))
    fault = implausible(to_smpl(wrong, "neo", units_m=0.01))
    assert fault is not None
    assert "knees bend forwards" in fault.problem


def dancing_table(motion: Path) -> np.ndarray:
    name = "aistpp-edge-positions/true_gLH_sBM_cAll_d18_mLH4_ch02_slice1.csv"
    return np.loadtxt(motion / name, delimiter=",").reshape(-1, 24, 3)


@pytest.mark.parametrize(
    ("mistake", "said"),
    [
        ("the room mirrored", "knees bend forwards"),
        ("left and right swapped", "knees bend forwards"),
        ("Y up", "on its side"),
        ("millimetres", "units_m"),
        ("joints in another order", "no body fits"),
    ],
)
def test_a_wrong_table_of_joints_is_refused(motion: Path, tmp_path: Path, mistake: str, said: str) -> None:
    table = dancing_table(motion)
    up = "Z"
    if mistake == "the room mirrored":
        table = table * [-1.0, 1.0, 1.0]
    elif mistake == "left and right swapped":
        table = table[:, NEUTRAL_BODY.mirror]
    elif mistake == "Y up":
        up = "Y"
    elif mistake == "millimetres":
        table = 1000.0 * table
    else:
        table = table[:, np.random.default_rng(1).permutation(24)]
    path = tmp_path / "dance.csv"
    np.savetxt(path, table.reshape(len(table), 72), delimiter=",")
    recipe = Recipe(data_set="made-up", format="positions", skeleton="aist", up=up)
    with pytest.raises(InputError, match=said):
        read_takes(path, tmp_path, recipe)


def test_the_clips_of_aist_are_at_30_frames_a_second(motion: Path) -> None:
    # Speeds repeat every two beats: music mBR0 has 80 beats a minute, mLH4 120.
    for clip, beats_a_minute in (
        ("true_gBR_sBM_cAll_d04_mBR0_ch02_slice0", 80.0),
        ("true_gLH_sBM_cAll_d18_mLH4_ch02_slice1", 120.0),
    ):
        folder = motion / "aistpp-edge-positions"
        (one,) = read_takes(folder / f"{clip}.csv", folder, find_recipe(folder))
        positions = kinematics.joint_positions(one.motion)
        speed = np.linalg.norm(np.diff(positions, axis=0), axis=-1).mean(axis=1)
        speed = speed - speed.mean()
        likeness = np.correlate(speed, speed, mode="full")[len(speed) - 1 :]
        lags = np.arange(20, 60)
        best = lags[np.argmax(likeness[lags] / (len(speed) - lags))]
        assert best / one.motion.frame_rate_hz == pytest.approx(2 * 60.0 / beats_a_minute, abs=0.1)


def test_a_clip_is_the_forward_kinematics_it_was_made_by(motion: Path, take: Callable[[str], Take]) -> None:
    # The tables are exact, so the body must be where they say once it is scaled back to its own bones.
    folder = motion / "aistpp-edge-positions"
    for path in sorted(folder.glob("*.csv")):
        recipe = find_recipe(folder)
        (one,) = DATASETS[recipe.format].read(path, recipe)
        table = np.loadtxt(path, delimiter=",").reshape(-1, 24, 3)
        seen = np.stack((table[..., 0], table[..., 2], -table[..., 1]), axis=-1)
        away = np.linalg.norm(kinematics.joint_positions(one.motion) - seen, axis=-1)
        assert away.max() < 1e-5, path.name  # m
        turns = rotation.between(one.motion.rotations[:-1], one.motion.rotations[1:])
        assert np.linalg.norm(turns, axis=-1).max() < 1.0, path.name  # rad between frames at 30 Hz


def test_a_recipe_s_own_map_lies_beside_it(motion: Path, tmp_path: Path) -> None:
    shutil.copy(motion / "cmu-fbx-keijiro" / "bvh" / "85_14.bvh.xz", tmp_path / "a.bvh.xz")
    lines = [f'{smpl} = "{name}"' for smpl, name in skeleton_map("neo").joints.items()]
    (tmp_path / "mine.toml").write_text("[joints]\n" + "\n".join(lines))
    (tmp_path / "library.toml").write_text('data_set = "mine"\nskeleton = "mine.toml"\nunits_m = 0.01\n')
    (one,) = read_takes(tmp_path / "a.bvh.xz", tmp_path, find_recipe(tmp_path))
    (same,) = read_takes(
        *(p := motion / "cmu-fbx-keijiro" / "bvh" / "85_14.bvh.xz", p.parent), named_recipe("cmu-neo")
    )
    np.testing.assert_array_equal(one.motion.rotations, same.motion.rotations)
    assert plain_path(tmp_path / "a.bvh.xz", tmp_path) == "a.bvh"
