"""Khronos' validator finds nothing to say, and three.js poses the avatar where the dance has it."""

from __future__ import annotations

import json
import shutil
import struct
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studykit.io.bvh import read_bvh
from studykit.io.gltf import glb
from studykit.io.gltf_body import body_mesh
from studykit.io.skeleton_map import to_smpl
from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.resampling import resampled
from studykit.motion.skeleton import NEUTRAL_BODY

pytestmark = pytest.mark.slow

Read = Callable[[bytes, list[float]], dict[str, Any]]


@pytest.fixture(scope="session")
def read(tmp_path_factory: pytest.TempPathFactory) -> Read:
    """Install the readers that package-lock.json pins, in a folder of their own; gives how to read a file."""
    node, npm = shutil.which("node"), shutil.which("npm")
    if node is None or npm is None:
        pytest.skip("there is no Node.js on this machine")
    folder = tmp_path_factory.mktemp("gltf")
    shutil.copytree(Path(__file__).parent / "gltf", folder, dirs_exist_ok=True)
    subprocess.run([npm, "ci", "--no-audit", "--no-fund"], cwd=folder, check=True, capture_output=True)

    def begin(data: bytes, times: list[float]) -> dict[str, Any]:
        (folder / "dance.glb").write_bytes(data)
        words = [node, "read.mjs", "dance.glb", *map(str, times)]
        said = subprocess.run(words, cwd=folder, check=True, capture_output=True)
        return dict(json.loads(said.stdout))

    return begin


@pytest.fixture(scope="session")
def salsa(shared_data: Callable[[str], Path]) -> Motion:
    """Give a real dance at 30 frames a second."""
    take = shared_data("motion/cmu-bvh-acrnn") / "salsa" / "01.bvh.xz"
    return resampled(to_smpl(read_bvh(take), "daz", units_m=0.01), 30.0)


def away(seen: dict[str, Any], motion: Motion, frames: list[int]) -> float:
    """Give how far any joint, or any vertex of the skin, is from where it should be, m."""
    joints = kinematics.joint_positions(motion)
    world = kinematics.global_rotations(motion.skeleton, motion.rotations)
    still = replace(motion, rotations=rotation.identity(1, 24), root_positions=np.zeros((1, 3)))
    rest, body = kinematics.joint_positions(still)[0], body_mesh(motion.skeleton)
    furthest = 0.0
    for frame, pose in zip(frames, seen["poses"], strict=True):
        carried = joints[frame, body.joints] + rotation.rotate(
            world[frame, body.joints], body.vertices[:, None] - rest[body.joints]
        )
        skin = (body.weights[..., None] * carried).sum(axis=1)
        for found, wanted in ((pose["joints"], joints[frame]), (pose["vertices"], skin)):
            furthest = max(furthest, float(np.abs(np.array(found) - wanted).max()))
    return furthest


@pytest.mark.parametrize("look", ["by side", "spared", "by value"])
def test_a_real_dance_is_sound_and_stands_where_it_should(read: Read, salsa: Motion, look: str) -> None:
    words: dict[str, dict[str, Any]] = {
        "by side": {},
        "spared": {"spared": ("right_elbow", "right_wrist", "right_hand"), "extras": {"sha256": "0" * 64}},
        "by value": {"joint_values": np.arange(24.0)},
    }
    frames = [0, 1, len(salsa) // 2, len(salsa) - 1]
    seen = read(glb(salsa, name="salsa – é", **words[look]), [frame / 30.0 for frame in frames])
    # Not even advice.
    assert seen["issues"]["messages"] == []
    assert [seen["issues"][f"num{kind}"] for kind in ("Errors", "Warnings", "Infos", "Hints")] == [0] * 4
    assert away(seen, salsa, frames) < 1e-4


def test_a_single_pose_is_sound(read: Read) -> None:
    pose = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.identity(1, 24),
        root_positions=[[0.0, 1.0, 0.0]],
        frame_rate_hz=30.0,
    )
    seen = read(glb(pose), [0.0])
    assert seen["issues"]["messages"] == []
    assert away(seen, pose, [0]) < 1e-4


def test_wrong_files_would_be_noticed(read: Read, motion: Motion) -> None:
    frames = [0, 30, 59]
    times = [frame / 30.0 for frame in frames]
    right = glb(motion)
    assert away(read(right, times), motion, frames) < 1e-4
    backwards = glb(replace(motion, rotations=motion.rotations * (1.0, -1.0, -1.0, -1.0)))
    assert away(read(backwards, times), motion, frames) > 0.05
    centimetres = glb(replace(motion, root_positions=100.0 * motion.root_positions))
    assert away(read(centimetres, times), motion, frames) > 1.0
    cut = right[:8] + struct.pack("<I", len(right) - 4) + right[12:-4]
    assert read(cut, times)["issues"]["numErrors"] > 0
    long_turns = bytearray(right)
    long_turns[-16:] = struct.pack("<4f", 0.0, 0.0, 0.0, 1.5)  # the last number of the last joint
    assert read(bytes(long_turns), times)["issues"]["numErrors"] > 0
