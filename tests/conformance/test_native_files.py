"""SMPL data sets: literal files whose meaning is known, real dances there and back, and hostile files.

A reader and a writer can share an error; a literal cannot.
"""

from __future__ import annotations

import importlib.util
import io
import json
import lzma
import pickle
import zipfile
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io import array_files
from studykit.io.bvh import read_bvh
from studykit.io.datasets import smpl_arrays
from studykit.io.datasets.amass import Amass
from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.known import DATASETS
from studykit.io.datasets.read import read_takes
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.smplx_body import SMPLX_BODY
from studykit.io.skeleton_map import to_smpl
from studykit.library.dance_file import write_dances
from studykit.motion import kinematics, rotation
from studykit.motion.coco_body import COCO_JOINTS
from studykit.motion.motion import Motion
from studykit.motion.plausibility import implausible
from studykit.motion.retargeting import leg_length, on_neutral_body
from studykit.motion.skeleton import AIST_BODY, JOINT_NAMES, NEUTRAL_BODY

NATIVE = Path(__file__).parents[1] / "native"
AT = {name: number for number, name in enumerate(JOINT_NAMES)}
SEQUENCE = "motions/gBR_sBM_cAll_d04_mBR0_ch01.pkl"


def native(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"native_{name}", NATIVE / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def read(name: str, path: Path) -> list[Performance]:
    return DATASETS[name].read(path, Recipe(data_set="literal", format=name))


def aist_file(folder: Path, *, name: str = SEQUENCE, **changes: object) -> Path:
    """Write a literal sequence: two frames standing still, two metres along each axis."""
    content = {
        "smpl_poses": np.zeros((2, 72)),
        "smpl_trans": np.full((2, 3), 186.0),
        "smpl_scaling": np.array([93.0]),
        "smpl_loss": 1.0,
    } | changes
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(pickle.dumps({key: value for key, value in content.items() if value is not None}, 2))
    return path


# --- AIST++ ------------------------------------------------------------------------------------------------


def test_the_scaling_of_aistpp_divides_its_translation(tmp_path: Path) -> None:
    (one,) = read("aistpp", aist_file(tmp_path))
    np.testing.assert_allclose(one.motion.root_positions, 2.0, atol=1e-12)
    assert one.motion.frame_rate_hz == 60.0
    assert one.motion.skeleton is AIST_BODY
    assert (one.performer, one.genre, one.dancer) == ("AIST d04", "break", "")


def test_a_bent_knee_of_aistpp_puts_the_foot_behind(tmp_path: Path) -> None:
    poses = np.zeros((2, 72))
    poses[:, 3 * 4] = np.pi / 2  # left knee, about +X
    (one,) = read("aistpp", aist_file(tmp_path, smpl_poses=poses))
    joints = kinematics.joint_positions(one.motion)[0]
    knee, ankle = joints[AT["left_knee"]], joints[AT["left_ankle"]]
    assert ankle[2] < knee[2] - 0.4
    assert abs(ankle[1] - knee[1]) < 0.05
    assert joints[AT["right_ankle"], 1] < joints[AT["right_knee"], 1] - 0.4
    assert joints[AT["left_hand"], 0] > joints[AT["pelvis"], 0] + 0.6 > joints[AT["right_hand"], 0] + 1.2


def test_the_bones_of_aistpp_are_those_of_genuine_clips(tmp_path: Path, shared_data) -> None:
    (one,) = read("aistpp", aist_file(tmp_path, smpl_poses=np.full((2, 72), 0.2)))
    joints = kinematics.joint_positions(one.motion)[0]
    ours = np.linalg.norm(joints[1:] - joints[list(AIST_BODY.parents[1:])], axis=-1)
    for clip in sorted(shared_data("motion/aistpp-edge-positions").glob("*.csv")):
        theirs = np.loadtxt(clip, delimiter=",").reshape(-1, 24, 3)
        lengths = np.linalg.norm(theirs[:, 1:] - theirs[:, list(AIST_BODY.parents[1:])], axis=-1)
        assert np.abs(lengths - ours).max() < 1e-6


@pytest.mark.parametrize(
    ("letters", "genre"),
    [("BR", "break"), ("LH", "LA hip-hop"), ("JB", "ballet jazz"), ("WA", "waack"), ("KR", "krump")],
)
def test_names_of_aistpp_tell_the_genre(tmp_path: Path, letters: str, genre: str) -> None:
    name = f"motions/g{letters}_sFM_cAll_d18_m{letters}4_ch02.pkl"
    (one,) = read("aistpp", aist_file(tmp_path, name=name))
    assert (one.genre, one.performer) == (genre, "AIST d18")


def test_a_genre_that_aist_does_not_have_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="AIST has no genre XX"):
        read("aistpp", aist_file(tmp_path, name="motions/gXX_sBM_cAll_d04_mXX0_ch01.pkl"))


@pytest.mark.parametrize("protocol", [0, 2, 4, 5])
def test_poses_of_aistpp_may_be_flat_or_not(tmp_path: Path, protocol: int) -> None:
    vectors = np.random.default_rng(0).normal(scale=0.3, size=(1, 5, 24, 3))
    dance = {"vectors": vectors, "pelvis": np.zeros((1, 5, 3))}
    for flat in (True, False):
        path = native("aistpp").write(tmp_path / str(flat), dance, protocol=protocol, flat=flat)
        (one,) = read("aistpp", path)
        np.testing.assert_allclose(rotation.log(one.motion.rotations), vectors[0], atol=1e-12)


def test_a_folder_of_motions_packed_or_not_is_read_without_what_is_to_be_ignored(tmp_path: Path) -> None:
    dataset = DATASETS["aistpp"]
    first = aist_file(tmp_path)
    second = aist_file(tmp_path, name=SEQUENCE.replace("ch01", "ch02"))
    packed = second.with_name(f"{second.name}.xz")
    packed.write_bytes(lzma.compress(second.read_bytes()))
    second.unlink()
    aist_file(tmp_path, name=SEQUENCE.replace("ch01", "ch03"))
    (tmp_path / "ignore_list.txt").write_text("gBR_sBM_cAll_d04_mBR0_ch03\r\n\n")
    for folder in (tmp_path, tmp_path / "motions"):
        assert dataset.recognises(folder)
        assert dataset.items(folder) == [first, packed]
    (one,) = read("aistpp", packed)
    assert (one.performer, one.genre) == ("AIST d04", "break")
    np.testing.assert_array_equal(one.motion.root_positions, read("aistpp", first)[0].motion.root_positions)


WRONG = {
    "smpl_poses is no array": {"smpl_poses": [[0.0] * 72] * 2},
    "has no array smpl_poses": {"smpl_poses": None},
    "has no array smpl_trans": {"smpl_trans": None},
    "has no array smpl_scaling": {"smpl_scaling": None},
    "smpl_poses has the shape": {"smpl_poses": np.zeros((2, 71))},
    "smpl_trans has the shape": {"smpl_trans": np.zeros((2, 4))},
    "have 2 and 3 frames": {"smpl_trans": np.zeros((3, 3))},
    "smpl_poses has no frames": {"smpl_poses": np.zeros((0, 72)), "smpl_trans": np.zeros((0, 3))},
    "smpl_scaling is 0": {"smpl_scaling": np.array([0.0])},
    "smpl_scaling is -93": {"smpl_scaling": np.array([-93.0])},
    "smpl_scaling has nan": {"smpl_scaling": np.array([np.nan])},
    "smpl_scaling has the shape": {"smpl_scaling": np.array([93.0, 93.0])},
    "smpl_poses has nan in frame 1": {"smpl_poses": np.array([[0.0] * 72, [0.0] * 71 + [np.nan]])},
    "smpl_trans has inf in frame 0": {"smpl_trans": np.array([[np.inf, 0, 0], [0, 0, 0]])},
    "smpl_trans has 1e\\+300 in frame 1": {"smpl_trans": np.array([[0, 0, 0], [1e300, 0, 0]])},
    "smpl_trans is no array of numbers": {"smpl_trans": np.full((2, 3), "one")},
    "smpl_poses is no array of numbers": {"smpl_poses": np.zeros((2, 72), dtype=complex)},
}


@pytest.mark.parametrize("problem", WRONG)
def test_a_wrong_array_is_named_with_its_frame(tmp_path: Path, problem: str) -> None:
    path = aist_file(tmp_path, **WRONG[problem])
    with pytest.raises(InputError, match=problem) as caught:
        read("aistpp", path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize("scaling", [0.0, -93.0, 1e-300])
def test_a_wrong_scaling_is_not_called_a_rate(tmp_path: Path, scaling: float) -> None:
    with pytest.raises(InputError, match="smpl_scaling is") as caught:
        read("aistpp", aist_file(tmp_path, smpl_scaling=np.array([scaling])))
    assert "rate" not in str(caught.value).removeprefix(str(tmp_path))


def test_half_precision_is_read_without_a_word(tmp_path: Path) -> None:
    (one,) = read("aistpp", aist_file(tmp_path, smpl_poses=np.zeros((2, 72), dtype=np.float16)))
    assert one.motion.rotations.dtype == np.float64


def test_an_archive_that_unpacks_to_far_more_than_a_recording_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "A_poses.npz"
    np.savez_compressed(path, trans=np.zeros((2**19, 3)))
    with pytest.raises(InputError, match="unpacks to 12 MiB, which no recording does"):
        read("amass", path)


def test_a_tiny_scaling_does_not_make_a_giant(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="smpl_scaling"):
        read("aistpp", aist_file(tmp_path, smpl_scaling=np.array([1e-300])))


@pytest.mark.parametrize("name", ["aistpp", "aistpp-keypoints", "aioz-gdance"])
def test_a_pickle_of_something_else_is_named(tmp_path: Path, name: str) -> None:
    for number, value in enumerate((None, 3.0, [1], {"a": 1}, np.zeros(3), "text")):
        path = tmp_path / f"{number}.pkl"
        path.write_bytes(pickle.dumps(value))
        with pytest.raises(InputError, match=rf"{number}\.pkl: "):
            read(name, path)


@pytest.mark.parametrize(
    ("points", "problem"),
    [
        (np.zeros((2, 17, 3)), "both hips are in one place in frame 0"),
        (np.full((2, 17, 3), "a"), "keypoints3d_optim is no array of numbers"),
        (np.zeros((2, 18, 3)), "keypoints3d_optim has the shape"),
        (np.random.default_rng(0).normal(size=(9, 17, 3)), "are nobody's"),
        (np.random.default_rng(0).normal(size=(9, 17, 3)) * 1e5, "are nobody's"),
    ],
)
def test_keypoints_of_nobody_are_named(tmp_path: Path, points: np.ndarray, problem: str) -> None:
    path = tmp_path / "points.pkl"
    path.write_bytes(pickle.dumps({"keypoints3d_optim": points}))
    with pytest.raises(InputError, match=problem) as caught:
        read("aistpp-keypoints", path)
    assert str(path) in str(caught.value)


def seen(folder: Path, frames: int, **gaps: slice) -> Path:
    """Write somebody who stands and moves the left hand evenly, with points lost for a while, in cm."""
    points = np.zeros((frames, 17, 3))
    points[:, :, 1] = [170, 174, 174, 172, 172, 150, 150, 120, 120, 95, 95, 95, 95, 50, 50, 8, 8]
    points[:, [1, 3, 5, 7, 9, 11, 13, 15], 0] = [3, 7, 18, 18, 18, 10, 10, 10]
    points[:, [2, 4, 6, 8, 10, 12, 14, 16], 0] = [-3, -7, -18, -18, -18, -10, -10, -10]
    points[:, :3, 2] = [12, 10, 10]
    points[:, 9, 2] = np.linspace(0, 15, frames)
    for name, frames_lost in gaps.items():
        points[frames_lost, COCO_JOINTS.index(name)] = np.nan
    path = folder / f"{len(gaps)}.pkl"
    path.write_bytes(pickle.dumps({"keypoints3d": points}))
    return path


def test_keypoints_lost_for_a_moment_are_filled_in_and_noted(tmp_path: Path) -> None:
    (whole,) = read("aistpp-keypoints", seen(tmp_path, 90))
    gaps = {"left_wrist": slice(20, 50), "nose": slice(85, 90)}
    (one,) = read("aistpp-keypoints", seen(tmp_path, 90, **gaps))
    assert whole.notes == ""
    assert one.notes == "frames filled in: nose 5, left_wrist 30"
    np.testing.assert_allclose(
        kinematics.joint_positions(one.motion), kinematics.joint_positions(whole.motion), atol=1e-9
    )


@pytest.mark.parametrize(
    ("frames", "gaps", "problem"),
    [
        (90, {"left_wrist": slice(20, 51)}, "left_wrist is lost in frames 21-51, more than 0.5 s"),
        (20, {"left_wrist": slice(0, 20)}, "keypoints3d has left_wrist in no frame"),
        (
            90,
            dict.fromkeys(COCO_JOINTS, slice(7, 8)),
            "keypoints3d has nan in frame 7, where nothing was seen",
        ),
    ],
)
def test_keypoints_lost_for_long_are_named(
    tmp_path: Path, frames: int, gaps: dict[str, slice], problem: str
) -> None:
    path = seen(tmp_path, frames, **gaps)
    with pytest.raises(InputError, match=problem) as caught:
        read("aistpp-keypoints", path)
    assert str(path) in str(caught.value)


def test_keypoints_on_one_line_still_give_turns(tmp_path: Path) -> None:
    points = np.zeros((3, 17, 3))
    points[:, :, 1] = [170] * 5 + [150, 150, 120, 120, 95, 95, 95, 95, 50, 50, 8, 8]
    points[:, [5, 7, 9, 11, 13, 15], 0] = 10.0
    points[1, :5] = points[1, [0]]  # the whole face in one place
    points[2, 5] = points[2, 6]  # both shoulders too
    path = tmp_path / "points.pkl"
    path.write_bytes(pickle.dumps({"keypoints3d": points}))
    (one,) = read("aistpp-keypoints", path)
    assert np.all(np.isfinite(kinematics.joint_positions(one.motion)))


def test_more_numbers_than_a_take_has_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(smpl_arrays, "MOST_NUMBERS", 100)
    with pytest.raises(InputError, match="smpl_poses has 144 numbers, more than any take"):
        read("aistpp", aist_file(tmp_path))


# --- AIOZ-GDANCE -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("body_numbers", "kept"), [(72, 24), (69, 24), (63, 22), (57, 20)])
def test_groups_may_have_the_root_apart_and_no_hands(tmp_path: Path, body_numbers: int, kept: int) -> None:
    vectors = np.random.default_rng(0).normal(scale=0.3, size=(2, 5, 24, 3))
    pelvis = np.random.default_rng(1).normal(size=(2, 5, 3))
    dance = {"vectors": vectors, "pelvis": pelvis}
    path = native("aioz_gdance").write(tmp_path, dance, body_numbers=body_numbers, root_too=True)
    performances = read("aioz-gdance", path)
    assert [one.dancer for one in performances] == ["dancer-1", "dancer-2"]
    vectors[:, :, kept:] = 0.0
    for one, turns, places in zip(performances, vectors, pelvis, strict=True):
        np.testing.assert_allclose(rotation.log(one.motion.rotations), turns, atol=1e-12)
        np.testing.assert_allclose(one.motion.root_positions, places, atol=1e-12)


def test_groups_with_the_root_in_their_poses_need_it_nowhere_else(tmp_path: Path) -> None:
    vectors = np.random.default_rng(0).normal(scale=0.3, size=(2, 5, 24, 3))
    dance = {"vectors": vectors, "pelvis": np.zeros((2, 5, 3))}
    both, once = (
        read("aioz-gdance", native("aioz_gdance").write(tmp_path / str(root_too), dance, root_too=root_too))
        for root_too in (True, False)
    )
    for first, second in zip(both, once, strict=True):
        np.testing.assert_array_equal(first.motion.rotations, second.motion.rotations)


# --- FineDance ---------------------------------------------------------------------------------------------


def test_a_literal_quarter_turn_of_finedance(tmp_path: Path) -> None:
    # A quarter turn about +Y takes +Z to +X; its matrix has the rows (0, 0, 1), (0, 1, 0), (-1, 0, 0).
    array = np.tile([1.0, 0, 0, 0, 1, 0], (2, 53))[:, :315]
    array[:, :3] = [0.0, 1.0, 0.0]
    array[:, 3:] = np.tile([1.0, 0, 0, 0, 1, 0], (2, 52))
    array[:, 3:9] = [0, 0, 1, 0, 1, 0]
    path = tmp_path / "motion" / "001.npy"
    path.parent.mkdir()
    np.save(path, array)
    (one,) = read("finedance", path)
    np.testing.assert_allclose(
        rotation.rotate(one.motion.rotations[0, 0], np.array([0, 0, 1.0])), [1, 0, 0], atol=1e-12
    )
    facing = kinematics.facing(kinematics.joint_positions(one.motion))
    np.testing.assert_allclose(facing, np.pi / 2, atol=0.1)
    np.testing.assert_allclose(one.motion.root_positions[0], [0.0031, 1.0 - 0.3514, 0.0120], atol=1e-12)
    assert one.genre == ""


def test_the_columns_of_a_matrix_instead_of_its_rows_would_be_noticed(tmp_path: Path) -> None:
    vectors = np.zeros((1, 30, 24, 3))
    vectors[:, :, [4, 5], 0] = np.linspace(0.6, 1.2, 30)[None, :, None]
    dance = {"vectors": vectors, "pelvis": np.zeros((1, 30, 3))}
    (right,) = read("finedance", native("finedance").write(tmp_path / "rows", dance))
    assert implausible(right.motion) is None
    (wrong,) = read("finedance", native("finedance").write(tmp_path / "columns", dance, columns=True))
    fault = implausible(wrong.motion)
    assert fault is not None
    assert "knees bend forwards" in fault.problem


@pytest.mark.parametrize("width", [315, 319, 168])
def test_all_widths_of_finedance_say_the_same(tmp_path: Path, width: int) -> None:
    vectors = np.random.default_rng(0).normal(scale=0.4, size=(1, 6, 24, 3))
    dance = {"vectors": vectors, "pelvis": np.random.default_rng(1).normal(size=(1, 6, 3))}
    (one,) = read("finedance", native("finedance").write(tmp_path, dance, width=width))
    np.testing.assert_allclose(rotation.log(one.motion.rotations), vectors[0], atol=1e-6)
    np.testing.assert_allclose(one.motion.root_positions, dance["pelvis"][0], atol=1e-12)
    assert one.genre == "HanTang"


def test_the_legs_of_smplx_are_as_published() -> None:
    assert leg_length(SMPLX_BODY) == pytest.approx(0.784, abs=0.002)
    rest = kinematics.centred_positions(SMPLX_BODY, rotation.identity(24))
    ankle, neck = rest[AT["left_ankle"]], rest[AT["neck"]]
    np.testing.assert_allclose(ankle, [0.0726 - 0.0031, -1.2260 + 0.3514, -0.0552 - 0.0120], atol=1e-9)
    np.testing.assert_allclose(neck, [-0.0137 - 0.0031, 0.1077 + 0.3514, -0.0247 - 0.0120], atol=1e-9)
    ratios = SMPLX_BODY.bone_lengths[1:] / NEUTRAL_BODY.bone_lengths[1:]
    assert np.all((ratios > 0.85) & (ratios < 1.2) | (np.arange(1, 24) == AT["head"]))  # its head is higher


@pytest.mark.parametrize(
    ("label", "problem"),
    [("{", "is no JSON"), ("[" * 100_000, "is no JSON"), ("", "is no JSON")],
)
def test_a_broken_label_is_named(tmp_path: Path, label: str, problem: str) -> None:
    dance = {"vectors": np.zeros((1, 3, 24, 3)), "pelvis": np.zeros((1, 3, 3))}
    path = native("finedance").write(tmp_path, dance)
    (tmp_path / "label_json" / "012.json").write_text(label)
    with pytest.raises(InputError, match=rf"012\.json: .*{problem}"):
        read("finedance", path)


@pytest.mark.parametrize(
    ("label", "genre"),
    [
        ('{"style1": "Modern", "style2": " Hip\\n hop "}', "Hip hop"),
        ('{"style1": "Modern", "style2": ""}', "Modern"),
        ('{"style1": "Modern", "style2": null}', "Modern"),
        (json.dumps({"style1": "Modern", "style2": "x" * 101}), "Modern"),
        ('{"style1": "Modern"}', "Modern"),
        ('{"style1": [], "style2": 3}', ""),
        ("{}", ""),
        ("[1]", ""),
    ],
)
def test_a_label_without_a_fine_style_gives_the_coarse_one(tmp_path: Path, label: str, genre: str) -> None:
    dance = {"vectors": np.zeros((1, 3, 24, 3)), "pelvis": np.zeros((1, 3, 3))}
    path = native("finedance").write(tmp_path, dance)
    (tmp_path / "label_json" / "012.json").write_text(label)
    (one,) = read("finedance", path)
    assert one.genre == genre


def npy(**header: object) -> bytes:
    text = json.dumps(header)  # stands in for a Python literal
    text = text.replace("true", "True").replace("false", "False").replace("[", "(").replace("]", ",)")
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode() + bytes(64)


NPY_BOMBS = {
    "promises the shape": npy(descr="<f8", fortran_order=False, shape=[2**30, 315]),
    "has no shape": npy(descr="<f8", fortran_order=False, shape=[-1, 315]),
    "objects, not numbers": npy(descr="|O", fortran_order=False, shape=[8]),
    "objects, not number": npy(descr="<M8", fortran_order=False, shape=[8]),
    "broken file": b"\x93NUMPY\x01\x00\xff\xff" + b"(" * 65535,
    "broken file of": b"\x93NUMPY\x01\x00\x10\x00" + b"(" * 16,
    "version": b"\x93NUMPY\x09\x00\x10\x00" + b"(" * 16,
    "the array has 64 numbers a frame": npy(descr="|i1", fortran_order=True, shape=[1, 64]),
    "the array has nan": npy(descr="<f8", fortran_order=False, shape=[1, 8])[:-8] + b"\xff" * 8,
}


@pytest.mark.parametrize("problem", NPY_BOMBS)
def test_a_hostile_array_file_is_refused(tmp_path: Path, problem: str) -> None:
    path = tmp_path / "001.npy"
    path.write_bytes(NPY_BOMBS[problem])
    with pytest.raises(InputError, match=problem) as caught:
        read("finedance", path)
    assert str(path) in str(caught.value)


def test_a_rotation_of_nothing_is_named_with_its_frame(tmp_path: Path) -> None:
    array = np.concatenate((np.zeros((3, 3)), np.tile([1.0, 0, 0, 0, 1, 0], (3, 52))), axis=1)
    array[1, 3 + 6 * 4 : 3 + 6 * 4 + 6] = [1, 0, 0, 2, 0, 0]
    np.save(tmp_path / "001.npy", array)
    with pytest.raises(InputError, match="left_knee in frame 1 is none"):
        read("finedance", tmp_path / "001.npy")


# --- AMASS -------------------------------------------------------------------------------------------------


def amass_file(folder: Path, **changes: object) -> Path:
    """Write a literal take: standing upright with Z up, facing -Y as SMPL does after a quarter turn."""
    poses = np.zeros((2, 156))
    poses[:, 0] = np.pi / 2
    content = {
        "poses": poses,
        "trans": np.array([[1.0, 2.0, 3.0], [1.0, 2.0, 3.0]]),
        "gender": np.array("neutral"),
        "mocap_framerate": np.array(120.0),
    } | changes
    path = folder / "ACCAD" / "Female1General_c3d" / "A1_-_Stand_poses.npz"
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savez(path, **{key: value for key, value in content.items() if value is not None})
    return path


def upright(motion: Motion) -> bool:
    """Tell whether a dancer stands upright, faces +Z and has the left side on +X."""
    joints = kinematics.joint_positions(motion)[0]
    high = joints[AT["head"], 1] > joints[AT["pelvis"], 1] + 0.4 > joints[AT["left_ankle"], 1] + 1.0
    ahead = joints[AT["left_foot"], 2] > joints[AT["left_ankle"], 2] + 0.05
    return bool(high and ahead and joints[AT["left_hand"], 0] > joints[AT["right_hand"], 0] + 1.0)


def test_a_literal_person_of_amass_stands_upright_and_is_not_mirrored(tmp_path: Path) -> None:
    (one,) = read("amass", amass_file(tmp_path))
    assert upright(one.motion)
    assert one.motion.frame_rate_hz == 120.0
    assert (one.genre, one.performer, one.notes) == ("", "ACCAD Female1General_c3d", "")
    # The pelvis was 3 m high and 2 m along +Y, but for where SMPL has it: (x, y, z) -> (x, z, -y).
    np.testing.assert_allclose(
        one.motion.root_positions[0], [1 - 0.001795, 3 + 0.028219, -2 + 0.223333], atol=1e-9
    )


def test_a_left_arm_of_amass_that_is_raised_stays_the_left_one(tmp_path: Path) -> None:
    poses = np.zeros((2, 156))
    poses[:, 0] = np.pi / 2
    poses[:, 3 * 16 + 2] = np.pi / 2  # left shoulder, about +Z: the arm goes up
    (one,) = read("amass", amass_file(tmp_path, poses=poses))
    joints = kinematics.joint_positions(one.motion)[0]
    assert joints[AT["left_wrist"], 1] > joints[AT["head"], 1] > joints[AT["right_wrist"], 1] + 0.1
    assert joints[AT["left_shoulder"], 0] > joints[AT["right_shoulder"], 0]


@pytest.mark.parametrize(
    ("gender", "body"),
    [
        ("male", AIST_BODY),
        (b"male", AIST_BODY),
        (" Male\n", AIST_BODY),
        ("b'male'", AIST_BODY),
        ('b"MALE"', AIST_BODY),
        (["male"], AIST_BODY),
        (b"female", NEUTRAL_BODY),
        ("neutral", NEUTRAL_BODY),
    ],
)
def test_gender_may_be_text_or_bytes(tmp_path: Path, gender: object, body: object) -> None:
    (one,) = read("amass", amass_file(tmp_path, gender=np.array(gender)))
    assert one.motion.skeleton is body
    assert one.notes == ""


@pytest.mark.parametrize(
    ("gender", "note"),
    [
        (np.array("robot"), "gender 'robot' counts as neutral"),
        (np.array("male " * 50), "gender 'male male male male ' counts as neutral"),
        (np.array("male", dtype=object), "gender is not said and counts as neutral"),
        (np.array(["male", "male"]), "gender is not said and counts as neutral"),
        (np.array(1), "gender is not said and counts as neutral"),
        (None, "gender is not said and counts as neutral"),
    ],
)
def test_a_gender_that_nobody_can_read_is_noted(tmp_path: Path, gender: object, note: str) -> None:
    (one,) = read("amass", amass_file(tmp_path, gender=gender))
    assert one.motion.skeleton is NEUTRAL_BODY
    assert one.notes == note


AMASS_FORMS = [{}, {"gender": "male"}, {"smplx": True}, {"smplx": True, "joined": False}]


@pytest.mark.parametrize("words", AMASS_FORMS)
def test_a_smplx_archive_says_the_same_as_a_smplh_one(tmp_path: Path, words: dict[str, object]) -> None:
    vectors = np.random.default_rng(0).normal(scale=0.4, size=(1, 6, 24, 3))
    dance = {"vectors": vectors, "pelvis": np.ones((1, 6, 3)), "rate": np.array(59.94)}
    path = native("amass").write(tmp_path, dance, **words)
    assert Amass().items(tmp_path) == [path]
    (one,) = read("amass", path)
    np.testing.assert_allclose(rotation.log(one.motion.rotations)[:, :22], vectors[0, :, :22], atol=1e-12)
    np.testing.assert_allclose(one.motion.root_positions, 1.0, atol=1e-12)
    assert one.motion.frame_rate_hz == 59.94
    men = AIST_BODY if "gender" in words else NEUTRAL_BODY
    assert one.motion.skeleton is (SMPLX_BODY if "smplx" in words else men)


@pytest.mark.parametrize(
    ("model", "body"),
    [
        ("smplh", AIST_BODY),
        (b"SMPLH", AIST_BODY),
        ("smplx", SMPLX_BODY),
        (b"smplx", SMPLX_BODY),
        (None, SMPLX_BODY),
        ("new", SMPLX_BODY),
    ],
)
def test_split_arrays_are_of_the_model_that_the_file_names(
    tmp_path: Path, model: object, body: object
) -> None:
    split = {"poses": None, "root_orient": np.zeros((2, 3)), "pose_body": np.zeros((2, 63))}
    named = None if model is None else np.array(model)
    (one,) = read("amass", amass_file(tmp_path, **split, gender=np.array("male"), surface_model_type=named))
    assert one.motion.skeleton is body


def test_a_rate_of_the_recipe_serves_where_the_file_has_none(tmp_path: Path) -> None:
    path = amass_file(tmp_path, mocap_framerate=None)
    (take,) = read_takes(path, tmp_path, Recipe(data_set="a", format="amass", frame_rates_hz={"ACCAD/*": 60}))
    assert take.motion.frame_rate_hz == 60.0
    own = Recipe(data_set="a", format="amass", frame_rates_hz={"*": 60})
    (one,) = DATASETS["amass"].read(amass_file(tmp_path), own)
    assert one.motion.frame_rate_hz == 120.0


def test_no_folder_above_the_subject_but_a_collection_of_amass_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    subject = amass_file(tmp_path).parent
    monkeypatch.chdir(subject)
    for typed in (".", "..", "../..", "../Female1General_c3d", str(subject), str(tmp_path)):
        (path,) = Amass().items(Path(typed))
        (one,) = read("amass", path)
        assert (one.performer, one.genre) == ("ACCAD Female1General_c3d", ""), typed
    mine = tmp_path / "anna" / "takes"
    mine.mkdir(parents=True)
    path = (subject / "A1_-_Stand_poses.npz").rename(mine / "A1_-_Stand_poses.npz")
    assert read("amass", path)[0].performer == "takes"


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"mocap_framerate": None}, "has no array mocap_framerate"),
        ({"mocap_framerate": np.array(0.0)}, "mocap_framerate is 0"),
        ({"mocap_framerate": np.array(np.inf)}, "mocap_framerate has inf"),
        ({"mocap_framerate": np.array("fast")}, "mocap_framerate is no array of numbers"),
        ({"poses": np.zeros((2, 72))}, "poses has the shape"),
        ({"poses": np.zeros(156)}, "poses has the shape"),
        ({"poses": None}, "has no array root_orient"),
        ({"trans": np.full((2, 3), np.longdouble("1e4000"))}, "trans has inf in frame 0"),
        ({"trans": np.zeros((5, 3))}, "have 2 and 5 frames"),
        ({"trans": np.array([{}, {}])}, "objects, not numbers"),
    ],
)
def test_a_wrong_archive_is_named(tmp_path: Path, changes: dict[str, object], problem: str) -> None:
    path = amass_file(tmp_path, **changes)
    with pytest.raises(InputError, match=problem) as caught:
        read("amass", path)
    assert str(path) in str(caught.value)


def archive(members: dict[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", method) as zipped:
        for name, data in members.items():
            zipped.writestr(name, data)
    return file.getvalue()


def test_a_zip_bomb_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(array_files, "LARGEST_BYTES", 2**20)
    zeros = npy(descr="<f8", fortran_order=False, shape=[10**6, 1]) + bytes(8 * 10**6 - 64)
    bomb = archive({"trans.npy": zeros})
    assert len(bomb) < 20_000
    lying = bytearray(bomb)
    for place in (bomb.find(b"PK\x01\x02") + 24, bomb.find(b"PK\x03\x04") + 22):
        lying[place : place + 4] = (200).to_bytes(4, "little")
    for data in (bomb, bytes(lying), archive({"trans.npy": bytes(100)}, zipfile.ZIP_BZIP2)):
        path = tmp_path / "A_poses.npz"
        path.write_bytes(data)
        with pytest.raises(InputError, match=r"A_poses\.npz: broken file of arrays"):
            read("amass", path)


# --- SMPL archives -----------------------------------------------------------------------------------------


def test_our_own_dances_are_read_back(tmp_path: Path) -> None:
    class Dance:
        condition, seed, sha256, is_synthetic, segments = "light-easy-on", 1, "0" * 64, True, ()
        mask = None

        def __init__(self, motion: Motion) -> None:
            self.motion = motion

        def to_dict(self) -> dict[str, object]:
            return {"seed": self.seed}

    rng = np.random.default_rng(0)
    motion = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.exp(rng.normal(scale=0.5, size=(9, 24, 3))),
        root_positions=rng.normal(size=(9, 3)),
        frame_rate_hz=30.0,
    )
    write_dances({"light-easy-on": Dance(motion)}, tmp_path)
    dataset = DATASETS["smpl-npz"]
    assert dataset.recognises(tmp_path)
    (path,) = dataset.items(tmp_path)
    (one,) = read("smpl-npz", path)
    np.testing.assert_allclose(kinematics.joint_positions(one.motion), kinematics.joint_positions(motion))
    assert one.motion.frame_rate_hz == 30.0


# --- real dances, there and back ---------------------------------------------------------------------------

ROUND_TRIPS: dict[str, tuple[str, Callable[[ModuleType, Path, dict[str, np.ndarray]], Path], int]] = {
    "aistpp": ("aistpp", lambda w, f, d: w.write(f, d, protocol=2), 24),
    "aioz-gdance": ("aioz-gdance", lambda w, f, d: w.write(f, d), 24),
    "finedance 315": ("finedance", lambda w, f, d: w.write(f, d), 24),
    "finedance 319": ("finedance", lambda w, f, d: w.write(f, d, width=319), 24),
    "finedance 168": ("finedance", lambda w, f, d: w.write(f, d, width=168), 24),
    "amass SMPL-H": ("amass", lambda w, f, d: w.write(f, d, gender="male"), 22),
    "amass SMPL-X": ("amass", lambda w, f, d: w.write(f, d, smplx=True), 22),
    "amass SMPL-X, split": ("amass", lambda w, f, d: w.write(f, d, smplx=True, joined=False), 22),
    "smpl-npz": ("smpl-npz", lambda w, f, d: w.write(f, d), 24),
}


@pytest.fixture(scope="session")
def couple(shared_data) -> list[Motion]:
    folder = shared_data("motion/cmu-bvh-acrnn")
    return [to_smpl(read_bvh(folder / f"salsa/{name}.bvh.xz"), "daz", units_m=0.01) for name in ("01", "16")]


@pytest.mark.parametrize("name", ROUND_TRIPS)
def test_a_real_dance_comes_back(couple: list[Motion], tmp_path: Path, name: str) -> None:
    dataset, write, kept = ROUND_TRIPS[name]
    dance = {
        "vectors": np.array([rotation.log(motion.rotations) for motion in couple]),
        "pelvis": np.array([motion.root_positions for motion in couple]),
        "rate": np.array(couple[0].frame_rate_hz),
    }
    performances = read(dataset, write(native(dataset.replace("-", "_")), tmp_path, dance))
    for one, motion in zip(performances, couple, strict=False):
        turns = rotation.between(motion.rotations, one.motion.rotations)[:, :kept]
        assert np.linalg.norm(turns, axis=-1).max() < 1e-6
        same_body = Motion(
            skeleton=one.motion.skeleton,
            rotations=motion.rotations,
            root_positions=motion.root_positions,
            frame_rate_hz=motion.frame_rate_hz,
        )
        away = kinematics.joint_positions(one.motion) - kinematics.joint_positions(same_body)
        assert np.linalg.norm(away, axis=-1)[:, :kept].max() < 1e-6
        assert implausible(on_neutral_body(one.motion)) is None


def test_the_keypoints_of_a_real_dance_come_back(couple: list[Motion], tmp_path: Path) -> None:
    motion = couple[0]
    world = kinematics.global_rotations(motion.skeleton, motion.rotations)
    dance = {
        "joints": kinematics.joint_positions(motion)[None],
        "world": rotation.to_matrix(world)[None],
    }
    writer = native("aistpp_keypoints")
    (one,) = read("aistpp-keypoints", writer.write(tmp_path, dance))
    away = np.linalg.norm(kinematics.joint_positions(one.motion) - dance["joints"][0], axis=-1)
    limbs = away[:, writer.JOINTS]
    assert np.median(limbs) < 0.01
    assert np.quantile(limbs, 0.99) < writer.POSITION_TOLERANCE_M
    assert implausible(on_neutral_body(one.motion)) is None
    head = rotation.between(
        world[:, AT["head"]], kinematics.global_rotations(one.motion.skeleton, one.motion.rotations)[:, 15]
    )
    assert np.degrees(np.median(np.linalg.norm(head, axis=-1))) < 15.0  # eyes and nose lie a little high
