"""Another program's reader and kinematics find the joints of our BVH where the dance has them."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studykit.io.bvh import bvh_text
from studykit.motion.motion import Motion
from studykit.motion.skeleton import JOINT_NAMES

with warnings.catch_warnings(action="ignore"):  # one of its own packages is about to be renamed
    import bvhio


def furthest(text: str, joints: NDArray[np.float64], folder: Path) -> float:
    """Give how far any joint stands from where it should, in several frames, m."""
    path = folder / "dance.bvh"
    path.write_text(text)
    root = bvhio.readAsHierarchy(str(path))
    away = []
    for frame in (0, 7, 8, 21, 59):
        root.loadPose(frame)
        places = {joint.Name: np.array(joint.PositionWorld) for joint, _, _ in root.layout()}
        assert set(places) == set(JOINT_NAMES)
        found = 0.01 * np.array([places[name] for name in JOINT_NAMES])
        away.append(np.linalg.norm(found - joints[frame], axis=1).max())
    return float(max(away))


def test_the_joints_are_where_they_dance(motion: Motion, joints: NDArray[np.float64], tmp_path: Path) -> None:
    text = bvh_text(motion)
    assert furthest(text, joints, tmp_path) < 1e-4
    assert "\nFrames: 60\nFrame Time: 0.033333333333\n" in text


def test_wrong_axes_wrong_turns_and_wrong_units_would_be_noticed(
    motion: Motion, joints: NDArray[np.float64], tmp_path: Path
) -> None:
    text = bvh_text(motion)
    other_order = text.replace("Zrotation Xrotation Yrotation", "Xrotation Yrotation Zrotation")
    backwards = bvh_text(replace(motion, rotations=motion.rotations * (1.0, -1.0, -1.0, -1.0)))
    metres = bvh_text(replace(motion, root_positions=0.01 * motion.root_positions))
    for wrong in (other_order, backwards, metres):
        assert furthest(wrong, joints, tmp_path) > 0.05


def test_angles_go_on_where_a_dancer_turns_round_and_round(motion: Motion) -> None:
    text = bvh_text(motion)
    rows = np.array([line.split() for line in text.split("Frame Time")[1].splitlines()[1:]], dtype=float)
    angles = rows[:, 3:].reshape(60, 24, 3)
    assert np.abs(np.diff(angles[:, 1:], axis=0)).max() < 180.0
    assert np.ptp(angles[:, 0, 2]) > 360.0
