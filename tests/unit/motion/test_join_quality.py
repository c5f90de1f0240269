from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import join_quality, kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY

FRAMES = 40


def still(*, slide_m_s: float = 0.0, wave: float = 0.0) -> Motion:
    """Stand, be pushed along the floor, and wave one hand."""
    rotations = rotation.identity(FRAMES, 24)
    angles = wave * np.sin(np.arange(FRAMES) / 5.0)
    rotations[:, NEUTRAL_BODY.index("left_elbow")] = rotation.exp(angles[:, None] * np.array([0.0, 1.0, 0.0]))
    pose = kinematics.centred_positions(NEUTRAL_BODY, rotation.identity(24))
    roots = np.arange(FRAMES)[:, None] / 30.0 * [0.6 * slide_m_s, 0.0, 0.8 * slide_m_s]
    roots[:, 1] = -pose[:, 1].min()
    return Motion(skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=roots, frame_rate_hz=30.0)


def jerked(frame: int, angle: float) -> Motion:
    """Stand, with the left elbow bent in one frame only; twice as long."""
    rotations = rotation.identity(2 * FRAMES, 24)
    rotations[frame, NEUTRAL_BODY.index("left_elbow")] = rotation.exp(np.array([0.0, angle, 0.0]))
    roots = np.tile(still().root_positions, (2, 1))
    return Motion(skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=roots, frame_rate_hz=30.0)


@pytest.mark.parametrize(("frame", "is_seen"), [(-8, False), (-6, True), (0, True), (5, True), (7, False)])
def test_a_jolt_is_seen_in_the_frames_that_the_blend_changes(frame, is_seen) -> None:
    angle = 0.2
    found = join_quality.join_accelerations(jerked(FRAMES + frame, angle), [FRAMES])
    hand, elbow = NEUTRAL_BODY.index("left_hand"), NEUTRAL_BODY.index("left_elbow")
    rest = kinematics.centred_positions(NEUTRAL_BODY, rotation.identity(24))
    arm = np.linalg.norm((rest[hand] - rest[elbow])[[0, 2]])
    # There and back within two frames: twice the chord, a frame time squared.
    expected = 2.0 * 2.0 * arm * np.sin(angle / 2.0) * 900.0
    assert found == pytest.approx([expected if is_seen else 0.0], rel=1e-6, abs=1e-9)


def test_usual_is_what_one_in_a_thousand_exceeds() -> None:
    moving = [jerked(FRAMES, angle) for angle in np.linspace(0.0, 0.5, 20)]
    usual = join_quality.usual_acceleration(moving)
    joints = [
        np.linalg.norm(np.diff(kinematics.joint_positions(m), 2, axis=0), axis=-1) * 900 for m in moving
    ]
    assert np.mean(np.concatenate(joints) > usual) == pytest.approx(1e-3, rel=0.05)


def test_dancers_themselves_jolt_in_every_stretch_that_holds_the_jolt() -> None:
    # Bent in one frame, the elbow is accelerated in three; 12 + 2 of 67 stretches hold one of them.
    frames = 2 * FRAMES - 2 - 12 + 1
    found = join_quality.jolting_share([jerked(FRAMES, 0.2), still(), still()], 1.0)
    assert found == pytest.approx((12 + 2) / (frames + 2 * (FRAMES - 2 - 12 + 1)))
    assert join_quality.jolting_share([jerked(FRAMES, 0.2)], 1e3) == 0.0


def test_sliding_is_against_that_of_the_segments() -> None:
    segments = [still(slide_m_s=0.1, wave=0.3), still(slide_m_s=0.1, wave=0.3)]
    roots = np.concatenate([segments[0].root_positions] * 2)
    roots[:, [0, 2]] = np.arange(2 * FRAMES)[:, None] / 30.0 * [0.3, 0.0]
    motion = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=np.concatenate([s.rotations for s in segments]),
        root_positions=roots,
        frame_rate_hz=30.0,
    )
    found = join_quality.join_quality(segments, motion)
    assert found.sliding == pytest.approx(3.0)
    assert found.join_sliding == pytest.approx(3.0)
    # Feet in the air do not slide.
    high = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=motion.rotations,
        root_positions=roots + np.array([0.0, 0.5, 0.0]),
        frame_rate_hz=30.0,
    )
    assert np.isnan(join_quality.join_quality(segments, high).sliding)
