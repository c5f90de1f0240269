"""What crosses to the browser, and what a player refuses."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studykit.core.errors import InputError
from studykit.motion.skeleton import NEUTRAL_BODY
from studykit.widgets import MotionPlayer
from studykit.widgets.player import material


def places(frames: int = 3) -> np.ndarray[Any, Any]:
    return np.arange(frames * 24 * 3, dtype=float).reshape(frames, 24, 3) / 100.0


def test_positions_cross_as_little_endian_floats_frame_joint_axis() -> None:
    player = MotionPlayer(positions=places())
    sent = bytes(player.get_state()["positions"])
    assert len(sent) == 3 * 24 * 3 * 4
    # Frame 2, joint 5, Z: counted by hand.
    (value,) = struct.unpack_from("<f", sent, 4 * (2 * 72 + 5 * 3 + 2))
    assert value == pytest.approx(places()[2, 5, 2])


@pytest.mark.parametrize("dtype", [">f8", ">f4", "<f2", "int64"])
def test_any_kind_of_number_crosses_as_the_same_bytes(dtype: str) -> None:
    whole = np.round(places())
    expected = MotionPlayer(positions=whole).get_state()["positions"]
    assert MotionPlayer(positions=whole.astype(dtype)).get_state()["positions"] == expected
    assert MotionPlayer(positions=np.asfortranarray(whole)).get_state()["positions"] == expected


def test_what_a_player_holds_is_not_changed_from_outside() -> None:
    mine = places()
    player = MotionPlayer(positions=mine)
    mine[:] = 9.0
    assert player.positions.max() < 9.0
    with pytest.raises(ValueError, match="read-only"):
        player.positions[:] = 0.0


@pytest.mark.parametrize(
    "wrong",
    [
        np.zeros((3, 23, 3)),
        np.zeros((24, 3)),
        np.zeros((3, 24, 2)),
        np.full((3, 24, 3), np.nan),
        np.full((3, 24, 3), np.inf),
        np.full((3, 24, 3), 1e300),  # finite, but not as it crosses
        "a word",
        [[1.0], [1.0, 2.0]],
        np.full((3, 24, 3), 1j),
    ],
    ids=["joints", "one pose", "plane", "nan", "inf", "far", "word", "ragged", "complex"],
)
@pytest.mark.parametrize("name", ["positions", "ghost"])
def test_positions_that_cannot_be_shown_are_refused_whenever_they_are_set(name: str, wrong: Any) -> None:
    player = MotionPlayer(positions=places())
    with pytest.raises(InputError, match=r"give finite metres of the shape \(frame, 24, 3\)"):
        setattr(player, name, wrong)
    assert len(player.positions) == 3
    with pytest.raises(InputError):
        MotionPlayer(**{name: wrong})


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("joint_values", [1.0] * 23),
        ("joint_values", [-1.0] * 24),
        ("joint_values", [np.nan] * 24),
        ("joint_values", "words"),
        ("frame_rate_hz", 0.0),
        ("frame_rate_hz", np.nan),
        ("frame_rate_hz", "fast"),
        ("time_s", -1.0),
        ("time_s", np.inf),
        ("marks", [(1.0, 0.5, "backwards", "flag")]),
        ("marks", [(0.0, 0.5, "colour", "purple")]),
        ("marks", [(0.0, 0.5, 7, "flag")]),
        ("marks", [(0.0, np.inf, "endless", "flag")]),
        ("marks", [(0.0, 0.5)]),
        ("marks", [None]),
    ],
)
def test_values_that_mean_nothing_are_refused(name: str, wrong: Any) -> None:
    player = MotionPlayer(positions=places())
    before = getattr(player, name)
    with pytest.raises(InputError):
        setattr(player, name, wrong)
    assert getattr(player, name) == before


def test_a_speed_outside_the_list_and_a_wrong_word_are_refused() -> None:
    player = MotionPlayer()
    with pytest.raises(Exception, match="speed"):
        player.speed = 3.0
    with pytest.raises(InputError, match="'colour'"):
        MotionPlayer(colour="red")


def test_sides_and_head_come_from_the_names() -> None:
    player = MotionPlayer(positions=places())
    assert player.sides.count("left") == player.sides.count("right") == 9
    assert player.sides[NEUTRAL_BODY.index("right_knee")] == "right"
    assert player.head_joint == NEUTRAL_BODY.index("head")
    own = MotionPlayer(
        positions=np.zeros((2, 2, 3)),
        parents=[-1, 0],
        joint_names=["root", "right_thing"],
        joint_values=[0, 1],
    )
    assert (own.sides, own.head_joint) == (["middle", "right"], -1)
    assert len(bytes(own.get_state()["ghost"])) == 0


@pytest.mark.parametrize("parents", [[0, 1], [-1, 2, 1], []])
def test_a_body_without_order_is_refused(parents: list[int]) -> None:
    with pytest.raises(InputError, match="parents"):
        MotionPlayer(parents=parents)


def test_showing_another_motion_begins_at_its_start() -> None:
    player = MotionPlayer(positions=places(), time_s=0.05)
    player.show(places(5), joint_values=np.ones(24), title="next")
    assert (len(player.positions), player.time_s, player.title) == (5, 0.0, "next")
    assert player.joint_values == [1.0] * 24


@given(st.floats(1.0, 2000.0), st.integers(1, 500))
def test_thinned_frames_keep_their_times(rate_hz: float, frames: int) -> None:
    times = np.arange(frames) / rate_hz
    shown, shown_hz = material.thinned(np.tile(times[:, None, None], (1, 24, 3)), rate_hz)
    assert shown_hz <= material.SHOWN_RATE_HZ * (1 + 1e-6)
    np.testing.assert_allclose(shown[:, 0, 0], np.arange(len(shown)) / shown_hz, atol=1e-9)


def test_marks_stand_in_the_order_of_time() -> None:
    player = MotionPlayer(marks=[(2.0, 3.0, "b", "cut"), (0.5, 0.5, "a", "flag")])
    assert [mark[2] for mark in player.marks] == ["a", "b"]
