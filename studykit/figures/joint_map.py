"""What a dance asks of each joint, coloured on a body (Figures 1 and 6)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from studykit.choreography.dance import Dance
from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.figures import body, style
from studykit.motion.skeleton import JOINT_NAMES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colorbar import Colorbar
    from matplotlib.figure import Figure

    from studykit.figures.canvas import PaperFigure

_BODY_MM, _ROW_MM, _SCALE_MM = 40.0, 44.0, 24.0


def joint_intensity_map(dances: Sequence[Dance]) -> PaperFigure:
    """Show what dances ask of each joint, on bodies side by side that share their colours.

    Parameters
    ----------
    dances : sequence of Dance
        From left to right, for example free and sparing an arm.

    Returns
    -------
    PaperFigure
        From top to bottom: each joint's share of the rotational energy of its dance (Eq. 11), the mean and
        the peak of its angular speed, all of the movement as shown. Spared joints have a rim of their own;
        below the peaks stands what those with a speed limit reach of it.

    Raises
    ------
    InputError
        If there is no dance to show.
    """
    if not dances:
        raise InputError("there is no dance to show", where="joint map", remedy="give at least one")
    limits = [_limits(dance) for dance in dances]
    with style.in_style():
        figure = style.sheet(
            width_mm=max(style.COLUMN_MM, min(_SCALE_MM + len(dances) * _BODY_MM, style.PAGE_MM)),
            height_mm=14.0 + len(_ASKED) * _ROW_MM + 3.4 * max(map(len, limits)),
            simulated=False,
            synthetic=any(dance.is_synthetic for dance in dances),
        )
        panels = figure.subplots(len(_ASKED), len(dances), squeeze=False)
        bars = [
            _draw_row(row, dances, [measure(dance) for dance in dances], (words, power))
            for row, (words, measure, power) in zip(panels, _ASKED, strict=True)
        ]
        for axes, lines in zip(panels[-1], limits, strict=True):
            _say_limits(axes, lines)
            for limit in sorted({limit for _, _, limit in lines}):
                bars[-1].ax.axhline(limit, color=style.SPARED, linewidth=1.6)
        for axes, dance in zip(panels[0], dances, strict=True):
            words = style.title(dance).replace(", ", ",\n").replace(" and ", "\nand ")
            axes.set_title(words, fontweight="bold", loc="center")
        _explain(figure, dances)
    return figure


def rotational_shares(dance: Dance) -> Floats:
    """Give each joint's share of the rotational energy of a dance as shown, shape (24,), per cent."""
    energies = _told(dance, "energy")
    return np.asarray(100.0 * energies / (energies.sum() or 1.0))


def mean_speeds(dance: Dance) -> Floats:
    """Give the mean angular speed of each joint, shape (24,), rad/s."""
    return _told(dance, "mean_rad_s")


def peak_speeds(dance: Dance) -> Floats:
    """Give the highest angular speed of each joint, shape (24,), rad/s."""
    return _told(dance, "peak_rad_s")


def _told(dance: Dance, measure: str) -> Floats:
    return np.array([joint[measure] for joint in dance.joints().values()], dtype=np.float64)


# What a row shows, and the power of its colours: few joints and few moments hold most of energies and peaks.
_ASKED: tuple[tuple[str, Callable[[Dance], Floats], float], ...] = (
    ("Rotational energy\n(% of the dance)", rotational_shares, 0.5),
    ("Mean angular speed\n(rad/s)", mean_speeds, 1.0),
    ("Peak angular speed\n(rad/s)", peak_speeds, 0.5),
)


def _limits(dance: Dance) -> list[tuple[str, float, float]]:
    """Give the name, the highest speed and the limit of each joint that has one, rad/s."""
    if dance.mask is None:
        return []
    limits, peaks = dance.mask.speed_limits_rad_s, peak_speeds(dance)
    return [
        (JOINT_NAMES[joint].replace("_", " "), float(peaks[joint]), float(limits[joint]))
        for joint in np.flatnonzero(np.isfinite(limits))
    ]


def _draw_row(
    row: Sequence[Axes], dances: Sequence[Dance], values: Sequence[Floats], scale: tuple[str, float]
) -> Colorbar:
    words, power = scale
    colours = body.shades(max(float(one.max()) for one in values) or 1.0, power=power)
    places = body.standing()
    for axes, dance, asked in zip(row, dances, values, strict=True):
        spared = () if dance.mask is None else dance.mask.spared
        is_spared = [name in spared for name in JOINT_NAMES]
        rims = [style.SPARED if one else style.INK for one in is_spared]
        shades = colours.to_rgba(asked)
        rim_pt = np.where(is_spared, 1.6, 0.45)
        body.draw_body(axes, places, shades, outlines=rims, widths_pt=(5.0, rim_pt))
        body.draw_head(
            axes,
            places[body.HEAD],
            face=shades[body.HEAD],
            edge=rims[body.HEAD],
            linewidth=rim_pt[body.HEAD],
        )
        body.name_sides(axes, places)
    figure = row[0].figure
    bar = figure.colorbar(colours, ax=list(row), location="right", shrink=0.8, aspect=14)
    bar.set_label(words)
    bar.ax.minorticks_off()
    return bar


def _say_limits(axes: Axes, lines: Sequence[tuple[str, float, float]]) -> None:
    for number, (name, peak, limit) in enumerate(lines):
        is_broken = peak > limit
        axes.text(
            0.5, -0.02 - 0.085 * number, f"{name} {peak:.2f}, limit {limit:.2f}",
            transform=axes.transAxes, ha="center", va="top", fontsize=6.5, gid="limit",
            color=style.WARNING if is_broken else style.INK, fontweight="bold" if is_broken else "normal",
        )  # fmt: skip


def _explain(figure: Figure, dances: Sequence[Dance]) -> None:
    from matplotlib.lines import Line2D

    if any(dance.mask is not None for dance in dances):
        sign = Line2D([], [], color=style.SPARED, label="spared joints, and the limits of their speed")
        figure.legend(handles=[sign], loc="outside lower center")
