"""The body model of one's own: joints and skin are those of the smplx package and of SMPL's formulas.

The model is synthetic, of the official file's layout (6890 vertices): SMPL's own may not be passed on.
"""

from __future__ import annotations

import importlib.util
import pickle
import pickletools
from pathlib import Path

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io.smpl_model import BodyModel, read_body_model
from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY, NEUTRAL_PELVIS

TOLERANCE_M = 1e-6
BETAS = [1.5, -0.7, 0.3, 0.0, 2.0, -2.0, 0.1, 0.2, -0.4, 1.0]


def arrays(vertices: int = 200) -> dict[str, np.ndarray]:
    """Make the arrays of a model whose mean joints are those of the neutral body."""
    rng = np.random.default_rng(7)
    rest = np.zeros((24, 3))
    for joint, parent in enumerate(NEUTRAL_BODY.parents):
        rest[joint] = NEUTRAL_BODY.offsets[joint] + (NEUTRAL_PELVIS if parent < 0 else rest[parent])
    # Each joint is the middle of a pair of points; the others are anywhere.
    template = rng.normal(scale=0.3, size=(vertices, 3))
    aside = rng.normal(scale=0.05, size=(24, 3))
    template[:24], template[24:48] = rest + aside, rest - aside
    regressor = np.zeros((24, vertices))
    regressor[range(24), range(24)] = regressor[range(24), range(24, 48)] = 0.5
    parents = np.array(NEUTRAL_BODY.parents, dtype=np.int64)
    parents[0] = 2**32 - 1
    return {
        "v_template": template,
        "shapedirs": rng.normal(scale=0.01, size=(vertices, 3, 10)),
        "posedirs": rng.normal(scale=0.002, size=(vertices, 3, 207)),
        "J_regressor": regressor,
        "weights": rng.dirichlet(np.full(24, 0.2), vertices),
        "kintree_table": np.array([parents, range(24)]),
        "f": rng.integers(0, vertices, size=(50, 3)).astype(np.uint32),
    }


def written(folder: Path, **changes: object) -> Path:
    path = folder / "SMPL_NEUTRAL.npz"
    np.savez(path, **(arrays() | changes))
    return path


def moving(model: BodyModel, betas: list[float], frames: int = 20) -> Motion:
    rng = np.random.default_rng(3)
    return Motion(
        skeleton=model.skeleton(betas=betas),
        rotations=rotation.exp(rng.normal(scale=0.6, size=(frames, 24, 3))),
        root_positions=rng.normal(size=(frames, 3)),
        frame_rate_hz=30.0,
    )


def skin(values: dict[str, np.ndarray], motion: Motion, betas: list[float]) -> np.ndarray:
    """SMPL's skin by its formulas (Loper et al. 2015, equations 2 to 10), in plain matrices."""
    shaped = values["v_template"] + values["shapedirs"] @ np.array(betas)
    joints = values["J_regressor"] @ shaped
    out = []
    for turns, place in zip(rotation.to_matrix(motion.rotations), motion.root_positions, strict=True):
        posed = shaped + values["posedirs"] @ (turns[1:] - np.eye(3)).reshape(-1)
        world = []
        for joint, parent in enumerate(NEUTRAL_BODY.parents):
            step = np.eye(4)
            step[:3, :3] = turns[joint]
            step[:3, 3] = place if parent < 0 else joints[joint] - joints[parent]
            world.append(step if parent < 0 else world[parent] @ step)
        away = np.array([g[:3, 3] - g[:3, :3] @ j for g, j in zip(world, joints, strict=True)])
        turned = np.array([g[:3, :3] for g in world])
        blended = np.einsum("vj,jab->vab", values["weights"], turned)
        out.append(np.einsum("vab,vb->va", blended, posed) + values["weights"] @ away)
    return np.array(out)


def test_the_mean_shape_has_the_joints_that_its_regressor_finds(tmp_path: Path) -> None:
    model = read_body_model(written(tmp_path))
    np.testing.assert_allclose(model.pelvis(), NEUTRAL_PELVIS, atol=1e-12)
    np.testing.assert_allclose(model.skeleton().offsets, NEUTRAL_BODY.offsets, atol=1e-12)


def test_joints_of_a_shape_are_the_regressor_times_the_shaped_skin(tmp_path: Path) -> None:
    model, values = read_body_model(written(tmp_path)), arrays()
    joints = values["J_regressor"] @ (values["v_template"] + values["shapedirs"] @ np.array(BETAS))
    standing = Motion(
        skeleton=model.skeleton(betas=BETAS),
        rotations=rotation.identity(1, 24),
        root_positions=model.pelvis(betas=BETAS)[None],
        frame_rate_hz=30.0,
    )
    np.testing.assert_allclose(kinematics.joint_positions(standing)[0], joints, atol=1e-12)
    assert np.abs(joints - model.rest_joints()).max() > 0.01
    few = model.rest_joints(betas=BETAS[:2])
    np.testing.assert_allclose(few, model.rest_joints(betas=[*BETAS[:2], *[0.0] * 8]), atol=1e-15)


def chumpy_pickle(values: dict[str, np.ndarray], protocol: int) -> bytes:
    """Write the official layout: some arrays inside objects of a package that is not there."""
    holder = type("Ch", (), {})
    holder.__module__, holder.__qualname__ = "chumpy.ch", "Ch"
    import sys
    from types import ModuleType

    import scipy.sparse

    module, parent = ModuleType("chumpy.ch"), ModuleType("chumpy")
    module.Ch = holder
    sys.modules |= {"chumpy": parent, "chumpy.ch": module}
    try:
        content: dict[str, object] = dict(values) | {"bs_style": "lbs", "bs_type": "lrotmin"}
        for name in ("v_template", "shapedirs"):
            one = holder()
            one.__dict__ |= {"x": values[name], "_dirty_vars": {"x"}, "_parents": {}}
            content[name] = one
        content["J_regressor"] = scipy.sparse.csc_matrix(values["J_regressor"])
        return pickle.dumps(content, protocol)
    finally:
        del sys.modules["chumpy"], sys.modules["chumpy.ch"]


@pytest.mark.parametrize("protocol", [0, 1, 2, 4])
def test_the_official_pickle_opens_without_chumpy(tmp_path: Path, protocol: int) -> None:
    data = chumpy_pickle(arrays(), protocol)
    named = [argument for _, argument, _ in pickletools.genops(data) if isinstance(argument, str)]
    assert any("chumpy" in name for name in named)
    path = tmp_path / "basicModel_neutral_lbs_10_207_0_v1.0.0.pkl"
    path.write_bytes(data)
    theirs, ours = read_body_model(path), read_body_model(written(tmp_path))
    for name in ("template", "shape_directions", "pose_directions", "joint_regressor", "weights", "faces"):
        np.testing.assert_array_equal(getattr(theirs, name), getattr(ours, name))


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"v_template": np.zeros((0, 3))}, "v_template"),
        ({"posedirs": np.zeros((200, 3, 486))}, "posedirs"),
        ({"J_regressor": np.full((24, 200), np.nan)}, "J_regressor"),
        ({"J_regressor": np.zeros((24, 200))}, "J_regressor"),
        ({"J_regressor": np.full((24, 200), 1e308)}, "J_regressor does not add up to 1 for pelvis"),
        ({"weights": np.full((200, 24), "a")}, "weights"),
        ({"kintree_table": np.zeros((2, 52), dtype=np.int64)}, "kintree_table"),
        ({"kintree_table": np.zeros((2, 24), dtype=np.int64)}, "kintree_table"),
        ({"f": np.array([[0, 1, 200]])}, "f names"),
        ({"f": np.array([[0.0, 1.0, 1e308]])}, "f names"),
        ({"f": np.array([[0.0, 1.0, 1.5]])}, "f names"),
        ({"f": np.array("none")}, "f has"),
    ],
)
def test_a_file_that_is_no_smpl_model_is_named(
    tmp_path: Path, changes: dict[str, np.ndarray], named: str
) -> None:
    path = written(tmp_path, **changes)
    with pytest.raises(InputError, match=named) as caught:
        read_body_model(path)
    assert str(path) in str(caught.value)


def test_a_file_that_lacks_an_array_is_named(tmp_path: Path) -> None:
    path = tmp_path / "model.npz"
    np.savez(path, v_template=np.zeros((5, 3)))
    with pytest.raises(InputError, match="has no array shapedirs"):
        read_body_model(path)
    path = tmp_path / "model.pkl"
    path.write_bytes(pickle.dumps([1, 2]))
    with pytest.raises(InputError, match=r"model\.pkl: holds no table"):
        read_body_model(path)


@pytest.mark.parametrize("betas", [[0.0] * 11, [np.nan], [[1.0]]])
def test_a_shape_that_is_none_is_refused(tmp_path: Path, betas: list[float]) -> None:
    with pytest.raises(InputError, match="betas"):
        read_body_model(written(tmp_path)).skeleton(betas=betas)


@pytest.mark.skipif(importlib.util.find_spec("smplx") is not None, reason="smplx is installed")
def test_the_skin_says_what_to_install(tmp_path: Path) -> None:
    model = read_body_model(written(tmp_path))
    with pytest.raises(InputError, match="pip install torch smplx"):
        model.mesh(moving(model, []))


@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::UserWarning")
def test_skin_and_joints_are_those_of_smplx(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("smplx", reason="smplx and torch are not installed (make test-smplx brings them)")
    values = arrays(6890)
    path = tmp_path / "SMPL_NEUTRAL.npz"
    np.savez(path, **values)
    model = read_body_model(path)
    motion = moving(model, BETAS, frames=100)
    mesh = model.mesh(motion, betas=BETAS)
    assert capsys.readouterr().out == ""
    assert mesh.vertices.shape == (100, 6890, 3)
    assert mesh.faces.shape == (50, 3)
    few = Motion(
        skeleton=motion.skeleton,
        rotations=motion.rotations[60:70],
        root_positions=motion.root_positions[60:70],
        frame_rate_hz=30.0,
    )
    assert np.abs(mesh.vertices[60:70] - skin(values, few, BETAS)).max() < TOLERANCE_M
    # The joints that smplx itself gives for the same pose and shape.
    joints = smplx_joints(values, motion, model.pelvis(betas=BETAS))
    assert np.abs(kinematics.joint_positions(motion) - joints).max() < TOLERANCE_M
    mean_body = Motion(
        skeleton=model.skeleton(),
        rotations=motion.rotations,
        root_positions=motion.root_positions,
        frame_rate_hz=30.0,
    )
    assert np.abs(kinematics.joint_positions(mean_body) - joints).max() > 0.01  # wrong: the shape forgotten


def smplx_joints(values: dict[str, np.ndarray], motion: Motion, pelvis: np.ndarray) -> np.ndarray:
    import smplx
    import torch

    vectors = rotation.log(motion.rotations)
    model = smplx.SMPL("", data_struct=smplx.utils.Struct(**values), dtype=torch.float64)
    with torch.no_grad():
        posed = model(
            betas=torch.tensor(np.tile(BETAS, (len(motion), 1))),
            global_orient=torch.tensor(vectors[:, 0]),
            body_pose=torch.tensor(vectors[:, 1:].reshape(len(motion), -1)),
            transl=torch.tensor(motion.root_positions - pelvis),
        )
    return posed.joints[:, :24].numpy()
