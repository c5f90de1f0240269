"""Room between an arm and the rest of the body, against the closest of many points of both."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from studykit.motion import clearance as module
from studykit.motion import kinematics, rotation
from studykit.motion.clearance import clearance
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY

RADII = {
    "spine1": 0.11, "spine2": 0.11, "spine3": 0.11, "neck": 0.08, "head": 0.055, "hip": 0.09, "knee": 0.07,
    "ankle": 0.045, "foot": 0.035, "collar": 0.05, "shoulder": 0.05, "elbow": 0.04, "wrist": 0.035,
    "hand": 0.025,
}  # fmt: skip


def posed(**turns) -> np.ndarray:
    """Stand in the rest pose with joints turned by rotation vectors; joint positions, shape (24, 3)."""
    vectors = np.zeros((24, 3))
    for name, turn in turns.items():
        vectors[NEUTRAL_BODY.index(name)] = turn
    return kinematics.centred_positions(NEUTRAL_BODY, rotation.exp(vectors))


def sampled(positions: np.ndarray, side: str) -> float:
    """Find the gap from 60 points on every bone."""
    share = np.linspace(0.0, 1.0, 60)[:, None]
    at = dict(zip(JOINT_NAMES, positions, strict=True))
    elbow, wrist, hand = (at[f"{side}_{name}"] for name in ("elbow", "wrist", "hand"))
    own = [
        (a + share * (b - a), radius)
        for (a, b), radius in zip(pairwise((elbow, wrist, 2 * hand - wrist)), (0.035, 0.025), strict=True)
    ]
    gaps = []
    for joint, name in enumerate(JOINT_NAMES[1:], start=1):
        if name.startswith(side) and name.split("_")[1] in ("collar", "shoulder", "elbow", "wrist", "hand"):
            continue
        parent = positions[NEUTRAL_BODY.parents[joint]]
        bone = parent + share * (positions[joint] - parent)
        gaps += [
            np.linalg.norm(bone[:, None] - points, axis=-1).min() - radius - RADII[name.split("_")[-1]]
            for points, radius in own
        ]
    up = at["head"] - at["spine3"]
    skull = at["head"] + 0.07 * up / np.linalg.norm(up)
    gaps += [np.linalg.norm(points - skull, axis=-1).min() - radius - 0.09 for points, radius in own]
    return min(gaps)


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_gap_is_that_of_the_closest_points(side: str) -> None:
    rng = np.random.default_rng(4)
    turns = rng.normal(scale=0.5, size=(15, 24, 3))
    positions = kinematics.centred_positions(NEUTRAL_BODY, rotation.exp(turns))
    gaps = clearance(positions, side)
    expected = np.array([sampled(one, side) for one in positions])
    # Points stand 6 cm apart on the forearm; a gap may look a little wider than it is, never narrower.
    assert np.all(gaps >= expected - 1e-3)
    assert np.all(gaps <= expected + 0.012)
    assert clearance(positions.reshape(3, 5, 24, 3), side) == pytest.approx(gaps.reshape(3, 5))


def test_arms_stretched_out_have_room_and_hands_on_the_head_or_hips_have_none() -> None:
    assert clearance(posed(), "right") > 0.25
    assert clearance(posed(), "right") == pytest.approx(clearance(posed(), "left"), abs=0.02)
    to_head = posed(right_shoulder=[0.0, 0.0, -0.9], right_elbow=[0.0, 0.3, -2.2])
    assert clearance(to_head, "right") < 0.02
    down = posed(right_shoulder=[0.0, 0.0, 1.25])
    assert 0.0 < clearance(down, "right") < 0.15
    into_the_hip = posed(right_shoulder=[0.0, 0.0, 1.65])
    assert clearance(into_the_hip, "right") < -0.02
    assert clearance(into_the_hip, "left") > 0.25


def test_a_hand_at_the_skull_is_told_by_the_skull_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    positions = posed()
    index = NEUTRAL_BODY.index
    above = positions[index("head")] + [0.0, 0.19, 0.0]
    for name, shift in (("elbow", -0.3), ("wrist", -0.05), ("hand", 0.0)):
        positions[index(f"right_{name}")] = above + np.array([shift, 0.0, 0.0])
    assert clearance(positions, "right") < 0.03
    monkeypatch.setattr(module, "_HEAD_RADIUS_M", 0.0)
    assert clearance(positions, "right") > 0.05


def test_where_the_body_stands_and_which_way_it_faces_makes_no_difference() -> None:
    positions = posed(right_shoulder=[0.3, 0.2, 1.1], left_shoulder=[0.1, -0.9, 0.0], spine2=[0.4, 0.2, 0.0])
    turned = rotation.rotate(rotation.exp(np.array([0.3, 2.0, -0.4])), positions) + np.array([3.0, 1.0, -2.0])
    for side in ("left", "right"):
        assert clearance(turned, side) == pytest.approx(clearance(positions, side), abs=1e-9)
