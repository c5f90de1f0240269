"""Maps of joints: colours are what joints do, and limits are told."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex

from studykit.core.errors import InputError
from studykit.figures import body, joint_intensity_map, style
from studykit.figures.joint_map import mean_speeds, peak_speeds, rotational_shares
from studykit.motion import energy, kinematics
from studykit.motion.joint_mask import spare
from studykit.motion.skeleton import JOINT_NAMES

JOINTS = [joint for bone in body.BONES for joint in bone]  # whose halves are drawn, in turn
LEFT, RIGHT = JOINT_NAMES.index("left_elbow"), JOINT_NAMES.index("right_elbow")


def colours(axes: Axes, layer: int) -> dict[int, str]:
    """Give the colour of each joint: of its rim (layer 0) or itself (layer 1)."""
    drawn = axes.collections[layer].get_colors()
    starts = [half[0] for half in axes.collections[layer].get_segments()]
    assert np.allclose(starts, body.standing()[JOINTS])  # each half of a bone begins at its joint
    return {joint: to_hex(colour) for joint, colour in zip(JOINTS, drawn, strict=True)}


def test_shares_and_speeds_are_those_of_the_movement(made_dance) -> None:
    dance = made_dance("A")
    speeds = kinematics.angular_speeds(dance.motion.rotations, 30.0)
    assert peak_speeds(dance) == pytest.approx(speeds.max(axis=0))
    assert mean_speeds(dance) == pytest.approx(speeds.mean(axis=0))
    # 0.9 sin(2 pi t / 4 s) turns at most at 0.9 x 2 pi / 4 rad/s.
    assert peak_speeds(dance)[LEFT] == pytest.approx(0.9 * np.pi / 2.0, rel=1e-3)
    assert rotational_shares(dance).sum() == pytest.approx(100.0)
    # Speeds are as 3 to 1, energies as 9 to 1.
    assert rotational_shares(dance)[[LEFT, RIGHT]] == pytest.approx([90.0, 10.0], abs=0.5)
    assert energy.rotational_energy(dance.motion.rotations, 30.0).sum() > 0.0


def test_bodies_share_their_colours(made_dance) -> None:
    slow, fast = made_dance("A"), made_dance("C")
    figure = joint_intensity_map([slow, fast])
    peaks = body.shades(float(peak_speeds(fast).max()))
    for axes, dance in zip(figure.axes[4:6], (slow, fast), strict=True):
        expected = peaks.to_rgba(peak_speeds(dance))
        assert colours(axes, 1) == {joint: to_hex(expected[joint]) for joint in JOINTS}
    alone = joint_intensity_map([slow]).axes[2]  # Wrong: each dance has a scale of its own
    assert colours(alone, 1) != colours(figure.axes[4], 1)


def test_rims_and_limits_mark_the_spared_joints(made_dance) -> None:
    dance = made_dance("A")
    limit = float(peak_speeds(dance)[LEFT])
    mask = spare(["left_elbow", "right_knee"], speed_limits_rad_s=[limit * 0.9, 3.0])
    figure = joint_intensity_map([dance, made_dance("A", mask=mask)])
    spared = {JOINT_NAMES.index(name) for name in mask.spared}
    for axes in figure.axes[1:6:2]:
        rims = colours(axes, 0)
        assert {joint for joint, rim in rims.items() if rim == style.SPARED.lower()} == spared
    said = {text.get_text(): text.get_color() for text in figure.axes[5].texts if text.get_gid() == "limit"}
    assert said[f"left elbow {limit:.2f}, limit {limit * 0.9:.2f}"] == style.WARNING
    assert said["right knee 0.00, limit 3.00"] == style.INK
    assert len(said) == len(spared)
    bar = figure.axes[-1]
    assert [float(line.get_ydata()[0]) for line in bar.lines] == pytest.approx([limit * 0.9, 3.0])


def test_a_mask_without_limits_tells_none(made_dance) -> None:
    figure = joint_intensity_map([made_dance("A", mask=spare("left_elbow"))])
    assert not [text for axes in figure.axes for text in axes.texts if text.get_gid() == "limit"]


def test_a_map_says_what_is_made_up_and_needs_a_dance(made_dance) -> None:
    assert joint_intensity_map([made_dance()]).get_suptitle() == style.SYNTHETIC
    assert joint_intensity_map([made_dance(is_synthetic=False)]).get_suptitle() == ""
    with pytest.raises(InputError, match="no dance to show"):
        joint_intensity_map([])
