"""Segments are whole, apart from each other, and begin alike."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from studykit.motion import kinematics, rotation, segmentation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY


def dancing(frames: int = 400) -> Motion:
    rng = np.random.default_rng(8)
    turns = np.cumsum(rng.normal(scale=0.02, size=(frames, 24, 3)), axis=0)
    rotations = rotation.exp(turns)
    rotations[:, 0] = rotation.yaw(2.0 + 0.01 * np.arange(frames))
    roots = np.cumsum(rng.normal(scale=0.01, size=(frames, 3)), axis=0) + np.array([5.0, 1.3, -7.0])
    return Motion(skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=roots, frame_rate_hz=30.0)


@pytest.mark.parametrize(
    ("runs", "starts"),
    [
        ([], []),
        ([(0, 119)], []),
        ([(0, 120)], [0]),
        ([(3, 363)], [3, 123, 243]),
        ([(0, 239), (240, 361)], [0, 240]),
    ],
)
def test_only_whole_segments_one_after_the_other(runs, starts) -> None:
    assert segmentation.segment_starts(runs) == starts


def test_segments_never_overlap_nor_leave_their_run() -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        edges = np.sort(rng.choice(3000, size=10, replace=False)).tolist()
        runs = list(zip(edges[::2], edges[1::2], strict=True))
        starts = segmentation.segment_starts(runs)
        assert all(b - a >= 120 for a, b in pairwise(starts))
        assert all(any(a <= s and s + 120 <= b for a, b in runs) for s in starts)
        assert len(starts) == sum((b - a) // 120 for a, b in runs)


@pytest.mark.parametrize("start", [0, 37, 280])
def test_a_segment_begins_at_the_origin_facing_ahead(start) -> None:
    take = dancing()
    centred = kinematics.centred_positions(take.skeleton, take.rotations)
    rotations, roots = segmentation.cut(take, centred, np.array([start, 11]))
    floor = segmentation.floor_height(centred, take.root_positions)
    cut = replace(take, rotations=rotations[0], root_positions=roots[0])
    assert len(cut) == 120
    assert cut.duration_s == segmentation.SEGMENT_S
    positions = kinematics.joint_positions(cut)
    assert float(kinematics.facing(positions[0])) == pytest.approx(0.0, abs=1e-9)
    assert cut.root_positions[0, [0, 2]] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert positions[..., 1] == pytest.approx(
        kinematics.joint_positions(take)[start : start + 120, :, 1] - floor, abs=1e-9
    )
    # One turn for the whole segment: the dancer's own turning stays.
    turning = np.diff(np.unwrap(kinematics.facing(positions)))
    before = np.diff(np.unwrap(kinematics.facing(kinematics.joint_positions(take)[start : start + 120])))
    assert turning == pytest.approx(before, abs=1e-9)
    assert np.abs(before).max() > 0.005


def test_the_floor_is_where_the_feet_are_not_where_a_glitch_is() -> None:
    take = dancing()
    lowest = kinematics.joint_positions(take)[..., 1].min(axis=1)
    roots = np.array(take.root_positions)
    roots[:, 1] -= lowest - 0.07  # the lowest joint always at 0.07 m ...
    roots[100:104, 1] -= 2.0  # ... but for four frames under ground
    centred = kinematics.centred_positions(take.skeleton, take.rotations)
    assert segmentation.floor_height(centred, roots) == pytest.approx(0.07, abs=1e-9)


def test_segments_may_overlap_by_a_stride() -> None:
    assert segmentation.segment_starts([(5, 250)], stride_frames=30) == [5, 35, 65, 95, 125]
