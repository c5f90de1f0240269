"""Profiles of energy: areas are energies, steps are blocks."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from studykit.core.errors import InputError
from studykit.figures import PeopleCurve, energy_profile, style
from studykit.figures.profile import profile
from studykit.motion import energy
from studykit.motion.joint_mask import spare
from studykit.motion.skeleton import JOINT_NAMES


def line(axes: Axes, gid: str) -> Line2D:
    (found,) = (one for one in axes.lines if one.get_gid() == gid)
    return found


def area(axes: Axes) -> float:
    """Give the area below the curve, J."""
    return float(np.sum(line(axes, "profile").get_ydata())) / 30.0


@pytest.mark.parametrize("window_s", [0.01, 1.0, 3.0, 100.0])
def test_the_area_below_a_curve_is_the_energy_of_the_dance(made_dance, window_s: float) -> None:
    dance = made_dance()
    figure = energy_profile([dance], body_mass_kg=60.0, window_s=window_s)
    assert area(figure.axes[0]) == pytest.approx(60.0 * dance.achieved_blended.linear_energy)
    assert area(figure.axes[1]) == pytest.approx(60.0 * dance.achieved_blended.rotational_energy)


@given(
    steps=st.lists(st.floats(0.0, 1e3), min_size=1, max_size=80),
    window_s=st.floats(0.01, 4.0),
)
def test_smoothing_loses_nothing(steps: list[float], window_s: float) -> None:
    times, values = profile(np.array(steps), 30.0, window_s)
    assert values.sum() / 30.0 == pytest.approx(sum(steps), rel=1e-9, abs=1e-9)
    assert times[0] == pytest.approx(0.5 / 30.0)


def test_smoothing_against_nothing_beyond_the_ends_would_lose_energy() -> None:
    steps = np.ones(60)
    wrong = np.convolve(steps, np.full(31, 1.0 / 31.0), mode="same")
    assert wrong.sum() < 0.9 * steps.sum()
    assert profile(steps, 30.0, 1.0)[1] == pytest.approx(30.0 * steps)


def test_steps_are_what_was_asked_of_blocks_each_second(made_dance) -> None:
    dance = made_dance("ABCCBA", blocks=3)
    figure = energy_profile([dance], body_mass_kg=50.0)
    for axes, measure in zip(figure.axes, ("linear_energy", "rotational_energy", "variety"), strict=True):
        factor = 1.0 if measure == "variety" else 50.0 / 8.0
        for kind in ("asked", "achieved_blended"):
            drawn = line(axes, kind)
            heights = [factor * getattr(getattr(block, kind), measure) for block in dance.blocks]
            assert drawn.get_drawstyle() == "steps-post"
            assert np.asarray(drawn.get_xdata()) == pytest.approx([0.0, 8.0, 16.0, 24.0])
            assert np.asarray(drawn.get_ydata()) == pytest.approx([*heights, heights[-1]])


def test_the_curve_of_a_block_has_the_area_of_its_step(made_dance) -> None:
    dance = made_dance("AC", blocks=2)
    axes = energy_profile([dance], window_s=0.01).axes[1]
    curve, steps = line(axes, "profile"), line(axes, "achieved_blended")
    second = np.asarray(curve.get_xdata()) > 119.0 / 30.0  # the step between blocks belongs to the later one
    assert np.asarray(curve.get_ydata())[second].sum() / 30.0 == pytest.approx(4.0 * steps.get_ydata()[1])


def test_joins_are_ticks(made_dance) -> None:
    axes = energy_profile([made_dance("ABCA")]).axes[0]
    assert np.asarray(line(axes, "joins").get_xdata()) == pytest.approx([4.0, 8.0, 12.0])


def test_spared_joints_have_a_curve_in_every_dance(made_dance) -> None:
    mask = spare("right_elbow")
    free, masked = made_dance("A"), made_dance("B", mask=mask)
    figure = energy_profile([free, masked], body_mass_kg=1.0)
    joints = [JOINT_NAMES.index(name) for name in mask.spared]
    for axes, dance in zip(figure.axes[4:6], (free, masked), strict=True):
        energies = energy.rotational_energy(dance.motion.rotations, 30.0)
        assert area(axes) == pytest.approx(energies[joints].sum())
        assert area(axes) < 0.2 * energies.sum()
    assert len(energy_profile([free]).axes) == 2


def test_dances_share_their_axes(made_dance) -> None:
    figure = energy_profile([made_dance("A"), made_dance("C"), made_dance("B")])
    assert len(figure.axes) == 6
    assert len({axes.get_ylim() for axes in figure.axes[:2]}) == 1
    assert figure.axes[0].get_ylim()[0] == 0.0


def test_a_profile_says_what_is_made_up_and_refuses_nonsense(made_dance) -> None:
    assert energy_profile([made_dance()]).get_suptitle() == style.SYNTHETIC
    assert energy_profile([made_dance(is_synthetic=False)]).get_suptitle() == ""
    with pytest.raises(InputError, match="no dance to show"):
        energy_profile([])
    for window_s in (0.0, -1.0, float("nan")):
        with pytest.raises(InputError, match="a window of"):
            energy_profile([made_dance()], window_s=window_s)


def people(dance, *, label: str = "Heart rate", level: float = 100.0) -> PeopleCurve:
    times_s = np.arange(0.25, dance.motion.duration_s, 0.5)
    return PeopleCurve(
        label=label, times_s=times_s, values=level + times_s + np.array([[-1.0], [1.0], [np.nan]])
    )


def test_people_have_a_row_below_with_their_mean(made_dance) -> None:
    dances = [made_dance("A"), made_dance("C")]
    curves = [people(dances[0]), people(dances[1], level=120.0)]
    figure = energy_profile(dances, people=[[curve] for curve in curves], simulated=True)
    assert style.SIMULATED in figure.marks
    assert len(figure.axes) == 6
    for axes, curve, level in zip(figure.axes[4:], curves, (100.0, 120.0), strict=True):
        assert np.asarray(line(axes, "people").get_ydata()) == pytest.approx(level + curve.times_s)
    assert figure.axes[4].get_ylim() == figure.axes[5].get_ylim()
    assert figure.axes[4].get_ylim()[0] > 50.0  # a heart does not begin at zero


def test_only_the_measures_asked_for_are_shown(made_dance) -> None:
    figure = energy_profile([made_dance("ABCA", blocks=2)], measures=("variety",))
    assert [axes.get_ylabel() for axes in figure.axes] == ["Variety (mean\nfeature distance)"]


def test_curves_of_some_dances_only_are_refused(made_dance) -> None:
    dances = [made_dance("A"), made_dance("C")]
    for curves in ([[people(dances[0])]], [[people(dances[0])], [people(dances[1], label="Distance")]]):
        with pytest.raises(InputError, match="not every dance has the same curves"):
            energy_profile(dances, people=curves)
