"""Our posed joints are those of the smplx package (SMPL's own forward kinematics)."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY, NEUTRAL_PELVIS

HERE = Path(__file__).parent
TOLERANCE_M = 1e-6


def errors_m(golden: dict[str, np.ndarray], joint_positions=kinematics.joint_positions) -> float:
    """Largest distance between our joints and theirs."""
    motion = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.exp(golden["rotation_vectors"]),
        root_positions=golden["translations"] + NEUTRAL_PELVIS,
        frame_rate_hz=30.0,
    )
    return float(np.linalg.norm(joint_positions(motion) - golden["joints"], axis=-1).max())


@pytest.fixture(scope="module")
def golden() -> dict[str, np.ndarray]:
    return dict(np.load(HERE / "smplx_joints.npz"))


def test_posed_joints_are_those_of_smplx(golden) -> None:
    assert golden["joints"].shape == (20, 24, 3)
    assert errors_m(golden) < TOLERANCE_M


def transposed(motion: Motion) -> np.ndarray:
    """Wrong: every rotation the wrong way round."""
    turned_back = Motion(
        skeleton=motion.skeleton,
        rotations=rotation.inverse(motion.rotations),
        root_positions=motion.root_positions,
        frame_rate_hz=30.0,
    )
    return kinematics.joint_positions(turned_back)


def child_turns_its_own_bone(motion: Motion) -> np.ndarray:
    """Wrong: a joint's rotation applied to the bone that leads to it."""
    world = kinematics.global_rotations(motion.skeleton, motion.rotations)
    positions = np.zeros((len(motion), 24, 3))
    for joint, parent in enumerate(motion.skeleton.parents):
        if parent >= 0:
            bone = rotation.rotate(world[:, joint], motion.skeleton.offsets[joint])
            positions[:, joint] = positions[:, parent] + bone
    return positions + motion.root_positions[:, None]


@pytest.mark.parametrize("wrong", [transposed, child_turns_its_own_bone])
def test_wrong_kinematics_would_be_noticed(golden, wrong) -> None:
    assert errors_m(golden, wrong) > 0.1


def test_forgetting_where_smpl_puts_the_pelvis_would_be_noticed(golden) -> None:
    moved = golden | {"translations": golden["translations"] - NEUTRAL_PELVIS}
    assert errors_m(moved) > 0.1


def test_smplx_itself_still_agrees(golden, tmp_path: Path) -> None:
    pytest.importorskip("smplx", reason="smplx and torch are not installed (make test-smplx brings them)")
    out = tmp_path / "joints.npz"
    script = HERE / "make_smplx_joints.py"
    subprocess.run([sys.executable, str(script), str(out)], check=True, capture_output=True)
    live = dict(np.load(out))
    np.testing.assert_array_equal(live["rotation_vectors"], golden["rotation_vectors"])
    assert errors_m(live) < TOLERANCE_M
