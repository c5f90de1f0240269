"""A free dance above a sparing one: the energies on the figure are those of the movement."""

from __future__ import annotations

import pytest

from studykit.core.errors import InputError
from studykit.figures import free_and_sparing, style
from studykit.figures.sparing import spared_energy
from studykit.motion import energy
from studykit.motion.joint_mask import spare
from studykit.motion.skeleton import JOINT_NAMES

MASK = spare("right_elbow")


def test_energies_of_spared_joints_are_those_of_the_movement(made_dance) -> None:
    dance = made_dance("AC")
    energies = energy.rotational_energy(dance.motion.rotations, 30.0)
    joints = [JOINT_NAMES.index(name) for name in MASK.spared]
    assert spared_energy(dance, MASK.spared) == pytest.approx(energies[joints].sum())
    assert spared_energy(dance, tuple(JOINT_NAMES)) == pytest.approx(energies.sum())


def test_both_dances_say_what_the_spared_joints_have_and_what_sparing_changed(made_dance) -> None:
    free, sparing = made_dance("CA"), made_dance("AC", mask=MASK)
    figure = free_and_sparing(free, sparing, body_mass_kg=1000.0)
    above, below = (axes.get_xlabel() for axes in figure.axes[:2])
    energies = [1000.0 * spared_energy(dance, MASK.spared) for dance in (free, sparing)]
    assert f"linear {1000.0 * free.achieved_blended.linear_energy:.0f} J, " in above
    assert above.endswith(f"spared joints {energies[0]:.2f} J")
    change = f"{100.0 * (energies[1] / energies[0] - 1.0):+.0f} %".replace("-", "−")
    assert below.endswith(f"spared joints {energies[1]:.2f} J ({change})")


def test_spared_joints_have_a_thicker_rim_not_only_another_colour(made_dance) -> None:
    figure = free_and_sparing(made_dance("A"), made_dance("B", mask=MASK))
    rims = figure.axes[0].collections[0]
    green = [tuple(colour[:3]) != (0.0, 0.0, 0.0) for colour in rims.get_colors()]
    widths = {round(float(width), 2) for width in rims.get_linewidths()}
    assert any(green)
    assert len(widths) == 2


def test_a_dance_that_spares_nothing_is_refused(made_dance) -> None:
    with pytest.raises(InputError, match="spares no joint; choreograph it with --spare"):
        free_and_sparing(made_dance("A"), made_dance("B"))


def test_it_says_what_is_made_up(made_dance) -> None:
    assert style.SYNTHETIC in free_and_sparing(made_dance("A"), made_dance("B", mask=MASK)).marks
