from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.figures import DanceStrip, four_dances
from studykit.figures.strips import poses
from studykit.figures.style import SIMULATED, SYNTHETIC
from studykit.motion.skeleton import NEUTRAL_BODY


def test_poses_stand_on_the_ground_around_their_moment(made_strip: Callable[..., DanceStrip]) -> None:
    chosen = poses(made_strip().motion)
    assert chosen.times_s.tolist() == [0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5]
    assert np.allclose(chosen.positions[:, 0, [0, 2]], 0.0)
    assert chosen.positions[..., 1].min() == pytest.approx(0.0)


def test_the_joint_that_works_has_the_highest_intensity(made_strip: Callable[..., DanceStrip]) -> None:
    chosen = poses(made_strip().motion)
    works = chosen.intensity.sum(axis=0)
    # The elbow turns; what lies beyond it travels; nothing else does.
    names = ("left_elbow", "left_wrist", "left_hand")
    moving = {NEUTRAL_BODY.index(name) for name in names}
    assert set(np.flatnonzero(works > 1e-12).tolist()) == moving


def test_curves_are_means_over_participants(made_strip: Callable[..., DanceStrip]) -> None:
    strip = made_strip(participants=5)
    figure = four_dances([strip], simulated=False)
    _, heart, distance = figure.axes[:3]
    assert np.allclose(heart.lines[0].get_ydata(), 82.0 + strip.times_s)
    assert np.allclose(distance.lines[0].get_ydata(), 0.22)


def test_all_dances_share_one_scale_of_colours(made_strip: Callable[..., DanceStrip]) -> None:
    weak, strong = made_strip(amplitude=0.1), made_strip("intense-easy-on", amplitude=1.0)
    figure = four_dances([weak, strong], simulated=False)

    def darkest(axes: int) -> float:
        coloured = figure.axes[axes].collections[1::2]
        return min(float(c.get_colors()[:, :3].sum(axis=1).min()) for c in coloured)

    assert darkest(3) < darkest(0) - 0.5


def test_what_is_not_real_says_so(made_strip: Callable[..., DanceStrip]) -> None:
    strips = [made_strip()]
    assert four_dances(strips, simulated=False).get_suptitle() == ""
    assert four_dances(strips, simulated=True).get_suptitle() == SIMULATED
    both = four_dances(strips, simulated=True, synthetic=True).get_suptitle()
    assert both == f"{SIMULATED} · {SYNTHETIC}"


def test_wrong_input_is_refused(made_strip: Callable[..., DanceStrip]) -> None:
    with pytest.raises(InputError, match="no dance to show"):
        four_dances([], simulated=False)
    strip = made_strip()
    with pytest.raises(ValueError, match="heart_rate_bpm has the shape"):
        DanceStrip(
            condition=strip.condition,
            motion=strip.motion,
            times_s=strip.times_s,
            heart_rate_bpm=strip.heart_rate_bpm[:, 1:],
            distance_m=strip.distance_m,
        )
