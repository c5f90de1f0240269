"""The body map: which joints it spares, what it refuses, and what it draws on which side."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import studykit.widgets
from studykit.core.errors import InputError
from studykit.motion.joint_mask import spare
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY
from studykit.widgets import joint_picker
from studykit.widgets.history import History

BODY = (Path(studykit.widgets.__file__).parent / "body_map" / "src" / "body.js").read_text(encoding="utf-8")


def drawn() -> list[tuple[str, str, int, int]]:
    """Read the table of the drawn body."""
    found = re.findall(r'\["(\w+)", "(\w*)", (-?\d+), (\d+)\]', BODY)
    return [(name, parent, int(x), int(y)) for name, parent, x, y in found]


def test_the_drawn_body_is_the_one_that_dances() -> None:
    parents = [JOINT_NAMES[parent] if parent >= 0 else "" for parent in NEUTRAL_BODY.parents]
    assert [(name, parent) for name, parent, _, _ in drawn()] == list(zip(JOINT_NAMES, parents, strict=True))


def test_the_body_faces_the_viewer_so_its_left_is_drawn_on_the_right() -> None:
    for name, _, x, _ in drawn():
        side = {"left": 1, "right": -1}.get(name.split("_")[0], 0)
        assert np.sign(x) == side, name


def test_what_is_higher_on_the_body_is_drawn_higher() -> None:
    heights = np.zeros(len(JOINT_NAMES))
    for joint, parent in enumerate(NEUTRAL_BODY.parents[1:], start=1):
        heights[joint] = heights[parent] + NEUTRAL_BODY.offsets[joint, 1]
    trunk = [JOINT_NAMES.index(name) for name in ("head", "neck", "spine3", "spine2", "spine1", "pelvis")]
    downwards = [drawn()[joint][3] for joint in trunk]
    assert np.all(np.diff(heights[trunk]) < 0.0)
    assert downwards == sorted(downwards)


def test_no_two_joints_are_drawn_closer_than_a_finger_is_wide() -> None:
    places = np.array([(x, y) for _, _, x, y in drawn()], dtype=float)
    apart = np.linalg.norm(places[:, None] - places, axis=-1) + 100.0 * np.eye(len(places))
    assert apart.min() >= 24.0


def test_sparing_a_joint_spares_what_lies_beyond_it() -> None:
    picker = joint_picker(weights={"right_elbow": 0.0}, speed_limits_rad_s={"right_elbow": 2.0})
    same = spare("right_elbow", speed_limits_rad_s=2.0)
    assert picker.mask.spared == ("right_elbow", "right_wrist", "right_hand")
    np.testing.assert_array_equal(picker.mask.weights, same.weights)
    np.testing.assert_array_equal(picker.mask.speed_limits_rad_s, same.speed_limits_rad_s)


def test_a_joint_that_was_chosen_itself_keeps_its_own() -> None:
    picker = joint_picker(weights={"left_wrist": 1.0, "left_shoulder": 0.5})
    named = dict(zip(JOINT_NAMES, picker.mask.weights, strict=True))
    assert (named["left_shoulder"], named["left_elbow"], named["left_wrist"]) == (0.5, 0.5, 1.0)
    assert named["right_shoulder"] == 1.0


def test_nothing_chosen_spares_nothing() -> None:
    assert joint_picker().mask.spared == ()


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("weights", {"rigth_elbow": 0.0}),
        ("weights", {"right_elbow": 1.5}),
        ("weights", {"right_elbow": float("nan")}),
        ("weights", {"right_elbow": "none"}),
        ("weights", {"right_elbow": True}),
        ("speed_limits_rad_s", {"right_elbow": 0.0}),
        ("speed_limits_rad_s", {"right_elbow": float("inf")}),
        ("speed_limits_rad_s", {"tail": 2.0}),
        ("suggested_speeds_rad_s", {"tail": 2.0}),
    ],
)
def test_what_cannot_be_asked_of_a_joint_is_refused(name: str, wrong: dict[str, object]) -> None:
    picker = joint_picker(weights={"left_knee": 0.5})
    with pytest.raises(InputError):
        setattr(picker, name, wrong)
    assert picker.weights == {"left_knee": 0.5}
    assert picker.mask.spared == ("left_knee", "left_ankle", "left_foot")


def test_undo_and_redo_go_through_what_was_set() -> None:
    picker = joint_picker()
    picker.weights = {"right_elbow": 0.5}
    picker.weights = {"right_elbow": 0.0}
    picker.speed_limits_rad_s = {"right_elbow": 2.0}
    picker.undo()
    picker.undo()
    assert (picker.weights, picker.speed_limits_rad_s) == ({"right_elbow": 0.5}, {})
    assert picker.can_redo
    picker.redo()
    assert picker.weights == {"right_elbow": 0.0}
    picker.weights = {}
    assert not picker.can_redo
    picker.undo()
    picker.undo()
    picker.undo()
    picker.undo()
    assert picker.weights == {}
    assert not picker.can_undo


def test_a_slider_that_moves_is_one_step_back() -> None:
    history = History(0)
    for value in (1, 2, 3):
        history.record(value, change="intensity")
    history.record(10)
    assert (history.back(), history.back()) == (3, 0)
    history.record(7, change="intensity")
    assert history.back() == 0
