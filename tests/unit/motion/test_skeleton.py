"""A skeleton says what is wrong with it."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.motion.skeleton import AIST_BODY, JOINT_NAMES, NEUTRAL_BODY, Skeleton

STICK = {
    "joint_names": ("root", "left", "right"),
    "parents": (-1, 0, 0),
    "offsets": [[0, 0, 0], [3, 4, 0], [-1, 0, 0]],
    "mirror": (0, 2, 1),
}


def test_a_stick_figure() -> None:
    stick = Skeleton(**STICK)
    assert stick.bone_lengths == pytest.approx([0.0, 5.0, 1.0])
    assert stick.index("right") == 2
    assert stick.children(0) == (1, 2)
    assert stick.children(1) == ()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"parents": (-1, 0)}, "one entry a joint"),
        ({"parents": (-1, 2, 0)}, "every parent before its children"),
        ({"parents": (0, 0, 0)}, "the root comes first"),
        ({"mirror": (0, 1, 1)}, "mirroring twice"),
        ({"offsets": [[0, 0, 0]]}, r"offsets has the shape \(1, 3\)"),
    ],
)
def test_mistakes_are_named(change: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Skeleton(**(STICK | change))


def test_a_skeleton_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        NEUTRAL_BODY.offsets[1, 0] = 1.0


@pytest.mark.parametrize("body", [NEUTRAL_BODY, AIST_BODY])
def test_bodies_of_smpl(body: Skeleton) -> None:
    assert len(JOINT_NAMES) == 24
    for joint, name in enumerate(body.joint_names):
        swapped = name.replace("left", "*").replace("right", "left").replace("*", "right")
        assert body.joint_names[body.mirror[joint]] == swapped
        if name.startswith("left_"):
            assert body.offsets[joint] == pytest.approx(
                body.offsets[body.mirror[joint]] * [-1, 1, 1], abs=0.03
            )
    ends = {name: body.index(name) for name in ("head", "left_foot", "right_hand")}
    rest = np.zeros((24, 3))
    for joint, parent in enumerate(body.parents[1:], start=1):
        rest[joint] = rest[parent] + body.offsets[joint]
    assert rest[ends["head"], 1] > 0.5  # Y is up
    assert rest[ends["left_foot"], 1] < -0.85
    assert rest[ends["left_foot"], 2] > 0.05  # the toes point to +Z
    assert rest[ends["right_hand"], 0] < -0.7  # the right side lies on -X
