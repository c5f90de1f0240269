"""Our archives are those of AMASS: read as its tutorials and smplx read them, the joints are in place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studykit.io.datasets.amass import Amass
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.smpl_npz import amass_arrays, read_smpl_npz
from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY, NEUTRAL_PELVIS

Numbers = NDArray[np.float64]
SHARED_JOINTS = 22
"""SMPL-H has SMPL's joints up to the wrists; then come fingers."""


@pytest.fixture
def archive(motion: Motion, tmp_path: Path) -> Path:
    path = tmp_path / "DanceDB" / "somebody" / "dance_poses.npz"
    path.parent.mkdir(parents=True)
    np.savez(path, **amass_arrays(motion))
    return path


def bodies(arrays: Any) -> Numbers:
    """Pose the SMPL-H body of an archive; gives the joints in the world, Z up, shape (frame, 22, 3), m.

    As a body model does: parameters are cut from `poses` by AMASS's columns, the root turns about the pelvis
    of the model and `trans` is added. None of it is studykit's.
    """
    parameters = {
        "root_orient": arrays["poses"][:, :3],
        "pose_body": arrays["poses"][:, 3:66],
        "pose_hand": arrays["poses"][:, 66:],
        "betas": np.repeat(arrays["betas"][None, :16], len(arrays["trans"]), axis=0),
        "dmpls": arrays["dmpls"][:, :8],
    }
    widths = {name: values.shape[1] for name, values in parameters.items()}
    assert widths == {"root_orient": 3, "pose_body": 63, "pose_hand": 90, "betas": 16, "dmpls": 8}
    assert not parameters["betas"].any()
    vectors = np.concatenate((parameters["root_orient"], parameters["pose_body"]), axis=1)
    turns = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix().reshape(-1, SHARED_JOINTS, 3, 3)
    world = np.array(turns)
    places = np.zeros((len(turns), SHARED_JOINTS, 3))
    places[:, 0] = NEUTRAL_PELVIS
    for joint in range(1, SHARED_JOINTS):
        parent = NEUTRAL_BODY.parents[joint]
        world[:, joint] = world[:, parent] @ turns[:, joint]
        places[:, joint] = places[:, parent] + world[:, parent] @ NEUTRAL_BODY.offsets[joint]
    return places + arrays["trans"][:, None]


def as_z_up(joints: Numbers) -> Numbers:
    """Stand up what has Y up: x stays, z comes to the front as -y, y becomes the height."""
    x, y, z = np.moveaxis(joints[:, :SHARED_JOINTS], -1, 0)
    return np.stack((x, -z, y), axis=-1)


def test_it_loads_as_amass(archive: Path, joints: Numbers) -> None:
    arrays = np.load(archive, allow_pickle=False)
    with arrays:
        assert set(arrays) == {"poses", "trans", "betas", "dmpls", "gender", "mocap_framerate"}
        assert str(arrays["gender"]) == "neutral"
        assert float(arrays["mocap_framerate"]) == 30.0
        assert bodies(arrays) == pytest.approx(as_z_up(joints), abs=1e-9)


WRONG: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
    "Y up": lambda a: a | {"trans": a["trans"][:, [0, 2, 1]]},
    "turned backwards": lambda a: a | {"poses": -a["poses"]},
    "pelvis twice": lambda a: a | {"trans": a["trans"] + np.array(NEUTRAL_PELVIS)},
    "centimetres": lambda a: a | {"trans": 100.0 * a["trans"]},
}


@pytest.mark.parametrize("wrong", WRONG)
def test_a_wrong_archive_would_be_noticed(motion: Motion, joints: Numbers, wrong: str) -> None:
    away = bodies(WRONG[wrong](amass_arrays(motion))) - as_z_up(joints)
    assert np.linalg.norm(away, axis=-1).max() > 0.05


def test_our_own_importer_takes_it_for_amass(archive: Path, joints: Numbers) -> None:
    assert Amass().recognises(archive.parent)
    (one,) = Amass().read(archive, Recipe(data_set="made-up", format="amass"))
    assert kinematics.joint_positions(one.motion)[:, :SHARED_JOINTS] == pytest.approx(
        joints[:, :SHARED_JOINTS], abs=1e-9
    )
    assert one.motion.frame_rate_hz == 30.0
    assert one.notes == ""


def test_a_dance_comes_back_whole_with_its_hands(archive: Path, motion: Motion, joints: Numbers) -> None:
    again = read_smpl_npz(archive)
    assert np.abs(rotation.between(motion.rotations, again.rotations)).max() < 1e-7
    assert kinematics.joint_positions(again) == pytest.approx(joints, abs=1e-9)
    # The hand of SMPL is the four fingers of SMPL-H; the thumb keeps to the wrist.
    with np.load(archive) as arrays:
        fingers = arrays["poses"][:, 66:].reshape(60, 2, 5, 3, 3)
    hands = rotation.log(motion.rotations[:, 22:])
    for finger in range(4):
        assert fingers[:, :, finger, 0] == pytest.approx(hands)
    assert not fingers[:, :, 4].any()
    assert not fingers[:, :, :, 1:].any()


def test_archives_of_24_joints_with_y_up_are_still_read(motion: Motion, tmp_path: Path) -> None:
    still = replace(motion, rotations=motion.rotations[:5], root_positions=motion.root_positions[:5])
    np.savez(
        tmp_path / "old.npz",
        poses=rotation.log(still.rotations).reshape(5, 72),
        trans=still.root_positions - np.array(NEUTRAL_PELVIS),
        mocap_framerate=np.array(30.0),
    )
    again = read_smpl_npz(tmp_path / "old.npz")
    assert kinematics.joint_positions(again) == pytest.approx(kinematics.joint_positions(still), abs=1e-9)


def test_smplx_poses_it_as_we_do(archive: Path, joints: Numbers) -> None:
    """The model is synthetic, of SMPL-H's layout and our rest offsets: SMPL-H's own may not be passed on."""
    reason = "smplx and torch are not installed (make test-smplx brings them)"
    smplx = pytest.importorskip("smplx", reason=reason)
    torch = pytest.importorskip("torch", reason=reason)

    vertices, count = 6890, SHARED_JOINTS + 30  # how the fingers hang on the wrists does not matter here
    parents = np.array([2**32 - 1, *NEUTRAL_BODY.parents[1:SHARED_JOINTS], *[20] * 15, *[21] * 15])
    rest = np.zeros((count, 3))
    rest[0] = NEUTRAL_PELVIS
    for joint in range(1, SHARED_JOINTS):
        rest[joint] = rest[parents[joint]] + NEUTRAL_BODY.offsets[joint]
    model = smplx.SMPLH(
        "",
        data_struct=smplx.utils.Struct(
            v_template=np.concatenate((rest, np.zeros((vertices - count, 3)))),
            J_regressor=np.eye(count, vertices),
            shapedirs=np.zeros((vertices, 3, 10)),
            posedirs=np.zeros((vertices, 3, 9 * (count - 1))),
            weights=np.eye(vertices, count),
            kintree_table=np.array([parents, range(count)]),
            f=np.zeros((1, 3), dtype=np.int64),
            hands_componentsl=np.eye(45),
            hands_componentsr=np.eye(45),
            hands_meanl=np.zeros(45),
            hands_meanr=np.zeros(45),
        ),
        batch_size=len(joints),
        dtype=torch.float64,
        num_betas=10,
        use_pca=False,
    )
    with np.load(archive) as arrays, torch.no_grad():
        poses = torch.tensor(arrays["poses"])
        posed = model(
            betas=torch.tensor(arrays["betas"])[:10].repeat(len(joints), 1),
            global_orient=poses[:, :3],
            body_pose=poses[:, 3:66],
            left_hand_pose=poses[:, 66:111],
            right_hand_pose=poses[:, 111:],
            transl=torch.tensor(arrays["trans"]),
        )
    # smplx adds 1e-8 to every component before it measures an angle.
    assert posed.joints[:, :SHARED_JOINTS].numpy() == pytest.approx(as_z_up(joints), abs=1e-6)
