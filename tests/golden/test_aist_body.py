"""The bones of genuine AIST++ clips are those of AIST_BODY.

AIST++ Dance Motion Dataset, R. Li, S. Yang, D. A. Ross, A. Kanazawa, 2021 (CC BY 4.0), as positions of SMPL's
24 joints in metres, Z up; the frame written out below is the 76th of the clip gLH_sBM_cAll_d18_mLH4_ch02.
"""

from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import kinematics
from studykit.motion.inverse_kinematics import rotations_from_positions
from studykit.motion.motion import Motion
from studykit.motion.skeleton import AIST_BODY, NEUTRAL_BODY

TOLERANCE_M = 1e-6

FRAME_Z_UP = """
-0.38750264 0.37465113 1.9337798
-0.37832233 0.43724972 1.8530895
-0.4665247 0.3572832 1.8598393
-0.3716288 0.38937244 2.0622349
-0.14605056 0.3741704 1.5475047
-0.65820336 0.35748774 1.5246227
-0.2808764 0.36978942 2.1678376
-0.08898033 0.3018589 1.12875
-0.8830774 0.43385258 1.1759167
-0.2469269 0.35864785 2.2111528
0.016415164 0.20843033 1.1093314
-0.8636359 0.32367218 1.0782571
-0.15117723 0.29928908 2.3939028
-0.1497605 0.3904925 2.3008127
-0.24369612 0.26921043 2.3210795
-0.08766712 0.23417345 2.441649
-0.09035115 0.5002644 2.3448193
-0.3054445 0.16839433 2.3544097
-0.24355994 0.6522608 2.2055712
-0.5246042 0.17142092 2.2101517
-0.15214598 0.52737945 1.9890875
-0.55045676 0.16523735 1.9422054
-0.13620868 0.47359207 1.9203526
-0.55782175 0.1755567 1.8533602
"""


def y_up(positions: np.ndarray) -> np.ndarray:
    """Turn Z up (x, y, z) into Y up (x, z, -y)."""
    return np.stack((positions[..., 0], positions[..., 2], -positions[..., 1]), axis=-1)


def bone_errors_m(positions: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    bones = positions[..., 1:, :] - positions[..., AIST_BODY.parents[1:], :]
    return np.abs(np.linalg.norm(bones, axis=-1) - lengths[1:])


@pytest.fixture
def frame() -> np.ndarray:
    return y_up(np.array(FRAME_Z_UP.split(), dtype=float).reshape(24, 3))


def test_bone_lengths_of_a_frame(frame: np.ndarray) -> None:
    assert bone_errors_m(frame, AIST_BODY.bone_lengths).max() < TOLERANCE_M


def test_another_body_would_be_noticed(frame: np.ndarray) -> None:
    assert bone_errors_m(frame, NEUTRAL_BODY.bone_lengths).max() > 0.01


def test_the_dancer_stands_upright_after_the_change_of_axes(frame: np.ndarray) -> None:
    heights = dict(zip(AIST_BODY.joint_names, frame[:, 1], strict=True))
    assert heights["head"] > heights["pelvis"] + 0.4 > heights["left_ankle"] + 0.9
    left_to_right = frame[AIST_BODY.index("right_hip")] - frame[AIST_BODY.index("left_hip")]
    toes = frame[AIST_BODY.index("left_foot")] - frame[AIST_BODY.index("left_ankle")]
    assert np.dot(np.cross(left_to_right, [0.0, 1.0, 0.0]), toes) < 0.0  # not mirrored: left x up = front


def test_bone_lengths_of_every_frame_of_every_clip(shared_data) -> None:
    clips = sorted(shared_data("motion/aistpp-edge-positions").glob("*.csv"))
    assert len(clips) == 6
    for clip in clips:
        positions = y_up(np.loadtxt(clip, delimiter=",").reshape(-1, 24, 3))
        assert bone_errors_m(positions, AIST_BODY.bone_lengths).max() < TOLERANCE_M


def test_our_kinematics_pose_the_body_as_the_clip_does(frame: np.ndarray) -> None:
    motion = Motion(
        skeleton=AIST_BODY,
        rotations=rotations_from_positions(frame[None], AIST_BODY),
        root_positions=frame[None, 0],
        frame_rate_hz=30.0,
    )
    posed = kinematics.joint_positions(motion)[0]
    # At a branch three bones share one rotation, which cannot fit all: only bones that are alone must agree.
    single = [joint for joint in range(24) if len(AIST_BODY.children(AIST_BODY.parents[joint])) == 1]
    theirs = frame[single] - frame[[AIST_BODY.parents[joint] for joint in single]]
    ours = posed[single] - posed[[AIST_BODY.parents[joint] for joint in single]]
    assert len(single) == 18
    assert ours == pytest.approx(theirs, abs=TOLERANCE_M)
    assert bone_errors_m(posed, AIST_BODY.bone_lengths).max() < 1e-12
