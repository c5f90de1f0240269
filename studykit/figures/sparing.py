"""A dance that spares joints below one that does not, at the same intensity (Figure 1)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from studykit.choreography.dance import Dance
from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.figures import body, strips, style
from studykit.motion.body import DEFAULT_BODY_MASS_KG

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from studykit.figures.canvas import PaperFigure

_STRIP_MM, _FRAME_MM = 39.0, 24.0


def free_and_sparing(
    free: Dance, sparing: Dance, *, body_mass_kg: float = DEFAULT_BODY_MASS_KG
) -> PaperFigure:
    """Show what sparing joints changes in a dance, and that its intensity stays (Figure 1).

    Parameters
    ----------
    free : Dance
        Without spared joints, above.
    sparing : Dance
        With spared joints, below.
    body_mass_kg : float
        Energies are shown for this body mass.

    Returns
    -------
    PaperFigure
        Poses from the middle of equal stretches, each half of a bone in the colour of its joint's energy, on
        one scale. Spared joints have a rim of their own. Below each strip: its energies, what of the
        rotational one (Eq. 11) the spared joints have, and by how much sparing changed them.

    Raises
    ------
    InputError
        If the second dance spares nothing.
    """
    if sparing.mask is None or not sparing.mask.spared:
        raise InputError("the dance spares no joint", where="figure 1", remedy="choreograph it with --spare")
    spared = sparing.mask.spared
    shown = [strips.poses(dance.motion) for dance in (free, sparing)]
    highest = max(float(one.intensity.max()) for one in shown) or 1.0
    colours = body.shades(1.0)
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM,
            height_mm=_FRAME_MM + 2.0 * _STRIP_MM,
            simulated=False,
            synthetic=free.is_synthetic or sparing.is_synthetic,
        )
        for axes, dance, bodies in zip(figure.subplots(2, 1), (free, sparing), shown, strict=True):
            strips.draw_poses(
                axes, dance.motion, bodies, lambda joint: colours.to_rgba(joint / highest), spared=spared,
                size_mm=(style.PAGE_MM - 2.0, _STRIP_MM - 8.0),
            )  # fmt: skip
            _say_energies(axes, dance, free, (spared, body_mass_kg))
        strips.draw_scale(figure, colours)
        _explain(figure, spared)
    return figure


def spared_energy(dance: Dance, spared: tuple[str, ...]) -> float:
    """Give the rotational energy of some joints in a dance as shown, J per kg.

    Parameters
    ----------
    dance : Dance
        It need not spare them.
    spared : tuple of str
        Names of the joints.
    """
    told = dance.joints()
    return float(np.sum([told[name]["energy"] for name in spared]))


def _say_energies(axes: Axes, dance: Dance, free: Dance, what: tuple[tuple[str, ...], float]) -> None:
    axes.set_title(style.title(dance), fontweight="bold", pad=3.0)
    words = []
    for name, digits, own, before in zip(
        ("linear", "rotational", "spared joints"), (0, 1, 2), _energies(dance, *what), _energies(free, *what),
        strict=True,
    ):  # fmt: skip
        change = "" if dance is free or not before else f" ({100.0 * (own / before - 1.0):+.0f} %)"
        words.append(f"{name} {own:.{digits}f} J{change}".replace("-", "−"))
    axes.set_xlabel(", ".join(words), loc="left", fontsize=7.0, labelpad=2.0)


def _energies(dance: Dance, spared: tuple[str, ...], body_mass_kg: float) -> Floats:
    """Give the linear, the rotational and the spared joints' rotational energy of a dance as shown, J."""
    shown = dance.achieved_blended
    return body_mass_kg * np.array(
        [shown.linear_energy, shown.rotational_energy, spared_energy(dance, spared)]
    )


def _explain(figure: PaperFigure, spared: tuple[str, ...]) -> None:
    from matplotlib.lines import Line2D

    words = " and ".join(body.topmost(spared))
    sign = Line2D(
        [], [], color=style.SPARED, linewidth=1.6, label=f"rim of the joints spared: {words} and beyond"
    )
    figure.legend(handles=[sign], loc="outside lower center")
