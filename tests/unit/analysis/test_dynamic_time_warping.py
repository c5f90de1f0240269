from __future__ import annotations

import numpy as np
import pytest

from studykit.analysis.dynamic_time_warping import (
    COMMON_JOINTS,
    COMMON_WEIGHTS,
    LIMBS,
    align,
    frame_costs,
)
from studykit.core.errors import InputError


def swinging(frames: int, *, delay: float = 0.0) -> np.ndarray:
    time = np.arange(frames)[:, None, None] - delay
    phase = np.arange(45).reshape(15, 3)
    return np.asarray(0.3 * np.sin(0.2 * time + phase) + 0.1 * np.sin(0.047 * time + 2.0 * phase))


def test_a_dancer_who_is_late_is_paired_with_the_right_frames() -> None:
    result = align(swinging(300), swinging(300, delay=6.0), 30)
    assert result.lag_s == pytest.approx(0.2)
    # Only the first and last frames, which have no partner, cost anything.
    assert result.distance_by_frame_m[10:-10] == pytest.approx(0.0, abs=1e-12)
    assert align(swinging(300), swinging(300, delay=-6.0), 30).lag_s == pytest.approx(-0.2)
    assert align(swinging(300), swinging(300, delay=6.0), 30, frame_rate_hz=60.0).lag_s == pytest.approx(0.1)


def test_a_constant_offset_of_every_joint_is_the_distance() -> None:
    guide = swinging(20)
    assert align(guide, guide + np.array([0.03, 0.0, 0.04]), 0).distance_m == pytest.approx(0.05)


def test_metres_per_aligned_frame() -> None:
    # One joint on a line: 0 0 1 against 0 1 1 within one frame pairs (0,0) (1,0) (2,1) (2,2) at no cost.
    guide, danced = (
        np.array(x, dtype=float)[:, None, None] * [1.0, 0.0, 0.0] for x in ([0, 0, 1], [0, 1, 1])
    )
    free = align(guide, danced, 1, [1.0])
    assert free.distance_m == 0.0
    assert free.path.tolist() == [[0, 0], [1, 0], [2, 1], [2, 2]]
    tied = align(guide, danced, 0, [1.0])
    assert tied.total_m == 1.0
    assert tied.distance_m == pytest.approx(1.0 / 3.0)
    assert tied.distance_by_frame_m.tolist() == [0.0, 1.0, 0.0]


def test_the_ends_of_the_limbs_count_more_and_the_hips_less() -> None:
    weights = dict(zip(COMMON_JOINTS, COMMON_WEIGHTS, strict=True))
    assert len(weights) == 15
    assert {name for name, weight in weights.items() if weight == 1.5} == {
        "left_wrist", "right_wrist", "left_ankle", "right_ankle",
    }  # fmt: skip
    assert {name for name, weight in weights.items() if weight == 0.5} == {"left_hip", "right_hip"}
    pose, moved = np.zeros((15, 3)), np.zeros((15, 3))
    moved[COMMON_JOINTS.index("left_wrist")] = [0.0, 0.3, 0.4]
    assert frame_costs(pose, moved, COMMON_WEIGHTS) == pytest.approx(1.5 * 0.5 / sum(COMMON_WEIGHTS))


def test_an_unseen_joint_is_left_out_of_the_mean() -> None:
    pose, moved = np.zeros((3, 3)), np.zeros((3, 3))
    moved[:, 0] = [0.1, 0.3, np.nan]
    assert frame_costs(pose, moved, [1.0, 1.0, 2.0]) == pytest.approx(0.2)
    assert frame_costs(pose, np.full((3, 3), np.nan), [1.0, 1.0, 2.0]) == np.inf


def test_frames_without_sight_keep_the_last_pose_and_are_counted() -> None:
    guide, danced = swinging(30), swinging(30)
    danced[[0, 1, 10, 11]] = np.nan
    held = swinging(30)
    held[:2], held[10:12] = held[2], held[9]
    result, expected = align(guide, danced, 3), align(guide, held, 3)
    assert result.unseen_frames == 4
    assert result.distance_m == expected.distance_m > 0.0


def test_a_dancer_who_was_never_seen_is_an_error() -> None:
    with pytest.raises(InputError, match="danced: no joint is seen in any frame"):
        align(swinging(5), np.full((5, 15, 3), np.nan), 1)


def test_poses_without_a_common_joint_are_an_error() -> None:
    guide, danced = swinging(5), swinging(5)
    guide[2, :8], danced[1:4, 8:] = np.nan, np.nan
    with pytest.raises(InputError, match="without a joint seen in both"):
        align(guide, danced, 1)


def test_a_limb_that_is_wrong_is_told_from_the_others_over_time() -> None:
    guide = swinging(40)
    danced = guide.copy()
    danced[20:, COMMON_JOINTS.index("left_wrist")] += [0.0, 0.3, 0.4]
    result = align(guide, danced, 0)
    # Shoulder, elbow and wrist weigh 1, 1 and 1.5; the wrist is 0.5 m away during half the time.
    assert result.limb_m("left_arm") == pytest.approx(0.5 * 0.5 * 1.5 / 3.5)
    assert result.limb_m("arms") == pytest.approx(0.5 * 0.5 * 1.5 / 7.0)
    assert result.limb_by_frame_m("left_arm")[[19, 20]] == pytest.approx([0.0, 0.5 * 1.5 / 3.5])
    assert {limb for limb in LIMBS if result.limb_m(limb) > 0.0} == {"arms", "left", "left_arm"}


def test_every_joint_belongs_to_one_limb_and_sides_are_mirrored() -> None:
    assert sorted(LIMBS["arms"] + LIMBS["legs"] + LIMBS["trunk"]) == list(range(15))
    assert sorted(LIMBS["left_arm"] + LIMBS["left_leg"]) == sorted(LIMBS["left"])
    for left, right in zip(LIMBS["left"], LIMBS["right"], strict=True):
        assert COMMON_JOINTS[left].replace("left", "right") == COMMON_JOINTS[right]


def test_a_limb_never_seen_has_no_distance_and_the_others_keep_theirs() -> None:
    guide, danced = swinging(30), swinging(30, delay=3.0) + 0.01
    hidden = danced.copy()
    hidden[:, LIMBS["right_arm"]] = np.nan
    result = align(guide, hidden, 10)
    assert np.isnan(result.limb_m("right_arm"))
    assert np.isnan(result.limb_by_frame_m("right_arm")).all()
    assert result.limb_m("legs") > 0.0
    assert np.isfinite(result.distance_by_frame_m).all()


def test_a_dancer_who_drifts_is_unsteadily_late() -> None:
    guide = swinging(300)
    steady, drifting = swinging(300, delay=6.0), swinging(300, delay=6.0)
    drifting[150:] = swinging(300, delay=10.0)[150:]
    assert align(guide, drifting, 30).lag_sd_s > 2.0 * align(guide, steady, 30).lag_sd_s > 0.0


def test_a_joint_that_was_not_seen_is_made_up_for_in_both_definitions() -> None:
    guide = swinging(20)
    danced = guide + np.array([0.03, 0.0, 0.04])
    whole, partial = danced.copy(), danced.copy()
    partial[3:9, [0, 4]] = np.nan
    for definition in ("mean_joint_distance", "tslearn"):
        of_all = align(guide, whole, 0, definition=definition)  # type: ignore[arg-type]
        assert align(guide, partial, 0, definition=definition).distance_m == pytest.approx(of_all.distance_m)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"danced": np.zeros((5, 14, 3))}, "shape"),
        ({"danced": np.zeros((5, 45))}, "shape"),
        ({"band_frames": -1}, "negative"),
        ({"weights": [0.0] * 15}, "zero"),
        ({"weights": [1.0] * 24}, "shape"),
    ],
)
def test_what_does_not_fit_is_refused(changes: dict[str, object], problem: str) -> None:
    arguments = {"guide": swinging(5), "danced": swinging(5), "band_frames": 1} | changes
    with pytest.raises(ValueError, match=problem):
        align(**arguments)  # type: ignore[arg-type]
