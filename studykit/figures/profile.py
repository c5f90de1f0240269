"""How hard and how varied dances are over time, beside what was asked of each block (Figures 9 and 10)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.choreography.dance import Dance
from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.figures import style
from studykit.motion import energy, kinematics
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.motion.skeleton import JOINT_NAMES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from studykit.figures.canvas import PaperFigure

_PANEL_MM, _FRAME_MM, _HEAD_MM = 28.0, 20.0, 12.0
_ACROSS = 2
_SPARED = "spared"
_LABELS = {
    "linear_energy": "Linear energy\n(J/s, {:g} kg)",
    "rotational_energy": "Rotational energy\n(J/s, {:g} kg)",
    _SPARED: "Spared joints,\nrotational (J/s)",
    "variety": "Variety (mean\nfeature distance)",
}
_DASHES = (0, (4, 1.5))


def energy_profile(
    dances: Sequence[Dance], *, body_mass_kg: float = DEFAULT_BODY_MASS_KG, window_s: float = 1.0
) -> PaperFigure:
    """Show how hard dances are from moment to moment, and what was asked of their blocks.

    Parameters
    ----------
    dances : sequence of Dance
        One a column, two across; all share their axes.
    body_mass_kg : float
        Energies are shown for this body mass.
    window_s : float
        Length of the moving mean.

    Returns
    -------
    PaperFigure
        Linear and rotational energy of the movement as shown, in J for each second of dance: the area below a
        curve is the energy of the dance. Steps: what was asked of each block, and what it became. Ticks at
        the bottom: joins. Where a dance spares joints, the rotational energy of these joints alone, in every
        dance. Where a dance has blocks, their variety.

    Raises
    ------
    InputError
        If there is no dance to show, or the window is not above 0.
    """
    if not dances:
        raise InputError("there is no dance to show", where="energy profile", remedy="give at least one")
    if not window_s > 0.0:
        raise InputError(f"a window of {window_s:g} s", where="energy profile", remedy="say 1 s")
    spared = sorted({name for dance in dances if dance.mask is not None for name in dance.mask.spared})
    is_blocked = any(len(dance.blocks) > 1 for dance in dances)
    shown = {_SPARED: bool(spared), "variety": is_blocked}
    measures = [measure for measure in _LABELS if shown.get(measure, True)]
    across = min(_ACROSS, len(dances))
    bands = -(-len(dances) // across)
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM if across > 1 else style.COLUMN_MM,
            height_mm=_FRAME_MM + bands * (_HEAD_MM + _PANEL_MM * len(measures)),
            simulated=False,
            synthetic=any(dance.is_synthetic for dance in dances),
        )
        panels = figure.subplots(bands * len(measures), across, squeeze=False)
        columns = panels.reshape(bands, len(measures), across).swapaxes(1, 2).reshape(-1, len(measures))
        for number, (column, dance) in enumerate(zip(columns, dances, strict=False)):
            for axes, measure in zip(column, measures, strict=True):
                _draw_panel(axes, dance)
                if measure != "variety":
                    steps = body_mass_kg * energy_steps(dance, measure, spared)
                    _draw_curve(axes, dance, profile(steps, dance.motion.frame_rate_hz, window_s), measure)
                if measure != _SPARED:
                    _draw_blocks(axes, dance, measure, body_mass_kg)
                if number % across == 0:
                    axes.set_ylabel(_LABELS[measure].format(body_mass_kg))
            column[0].set_title(style.title(dance).replace(", sparing", ",\nsparing"), fontweight="bold")
            column[-1].set_xlabel("Time in the dance (s)")
            column[-1].tick_params(labelbottom=True)
        for axes in columns[len(dances) :].ravel():
            axes.remove()
        for row in range(len(measures)):
            _share_height(list(columns[: len(dances), row]))
        figure.align_ylabels()
        _explain(figure, is_blocked=is_blocked)
    return figure


def profile(steps: Floats, frame_rate_hz: float, window_s: float) -> tuple[Floats, Floats]:
    """Smooth the energy of single steps so that the area below the curve stays what it was.

    Parameters
    ----------
    steps : ndarray, shape (step,), J
        Energy of each step from a pose to the next.
    frame_rate_hz : float
        Steps a second.
    window_s : float
        Length of the moving mean; the nearest odd number of steps is taken.

    Returns
    -------
    times_s : ndarray, shape (step,), s
        The middle of each step.
    values : ndarray, shape (step,), J for each second
        The moving mean; beyond its ends the dance is taken to run backwards.
    """
    half = min(round((window_s * frame_rate_hz - 1.0) / 2.0), len(steps))
    padded = np.pad(steps, half, mode="symmetric")
    mean = np.convolve(padded, np.full(2 * half + 1, 1.0 / (2 * half + 1)), mode="valid")
    return np.asarray((np.arange(len(steps)) + 0.5) / frame_rate_hz), np.asarray(mean * frame_rate_hz)


def energy_steps(dance: Dance, measure: str, spared: Sequence[str] = ()) -> Floats:
    """Give the energy of each step of a dance as shown, shape (step,), J per kg.

    Parameters
    ----------
    measure : {"linear_energy", "rotational_energy", "spared"}
        Eq. 8, Eq. 11, or Eq. 11 of the spared joints alone.
    spared : sequence of str
        Names of the spared joints.
    """
    motion = dance.motion
    joints = [JOINT_NAMES.index(name) for name in (spared if measure == _SPARED else JOINT_NAMES)]
    if measure == "linear_energy":
        positions = kinematics.centred_positions(motion.skeleton, motion.rotations)
        steps = energy.linear_energy_steps(positions, motion.frame_rate_hz)
    else:
        steps = energy.rotational_energy_steps(motion.rotations, motion.frame_rate_hz)
    return np.asarray(steps[:, joints].sum(axis=1))


def _colour(dance: Dance) -> str:
    colour = style.colour(dance.condition)
    return style.FAINT if colour == style.INK else colour  # what was asked is drawn in ink


def _draw_panel(axes: Axes, dance: Dance) -> None:
    style.rule(axes)
    duration_s = dance.motion.duration_s
    joins = np.linspace(0.0, duration_s, len(dance.segments) + 1)[1:-1]
    axes.plot(
        joins, np.zeros(len(joins)), linestyle="", marker="|", color=style.INK, markersize=5.0,
        markeredgewidth=0.7, transform=axes.get_xaxis_transform(), clip_on=False, gid="joins",
        in_layout=False,  # where there is none, it would be laid out at infinity
    )  # fmt: skip
    axes.set_xlim(0.0, duration_s)
    tick_s = 4.0 if duration_s < 16.0 else 8.0 if duration_s <= 64.0 else 32.0
    axes.set_xticks(np.arange(0.0, duration_s + 0.1, tick_s))
    axes.tick_params(labelbottom=False)


def _draw_curve(axes: Axes, dance: Dance, curve: tuple[Floats, Floats], measure: str) -> None:
    colour = style.SPARED if measure == _SPARED else _colour(dance)
    axes.plot(*curve, color=colour, linewidth=0.9, gid="profile")
    axes.fill_between(*curve, color=colour, alpha=0.15, linewidth=0.0)


def _draw_blocks(axes: Axes, dance: Dance, measure: str, body_mass_kg: float) -> None:
    lengths = np.array([block.asked.duration_s for block in dance.blocks])
    edges = np.concatenate(([0.0], np.cumsum(lengths)))
    factors = np.ones(len(lengths)) if measure == "variety" else body_mass_kg / lengths
    looks: dict[str, dict[str, Any]] = {
        "achieved_blended": {"color": _colour(dance), "linewidth": 2.4, "alpha": 0.6},
        "asked": {"color": style.INK, "linewidth": 1.0, "linestyle": _DASHES},
    }
    for kind, look in looks.items():
        heights = factors * [getattr(getattr(block, kind), measure) for block in dance.blocks]
        axes.step(edges, [*heights, heights[-1]], where="post", gid=kind, **look)


def _share_height(panels: Sequence[Axes]) -> None:
    top = 1.04 * max(axes.get_ylim()[1] for axes in panels)
    for axes in panels:
        axes.set_ylim(0.0, top)
        axes.locator_params(axis="y", nbins=5)


def _explain(figure: Figure, *, is_blocked: bool) -> None:
    from matplotlib.lines import Line2D

    what = "block" if is_blocked else "dance"
    joins = Line2D([], [], linestyle="", marker="|", color=style.INK, markersize=5.0, markeredgewidth=0.7)
    joins.set_label("joins")
    entries = [
        Line2D([], [], color=style.INK, linewidth=1.0, linestyle=_DASHES, label=f"asked of the {what}"),
        Line2D([], [], color=style.FAINT, linewidth=2.4, alpha=0.7, label=f"the {what}, joins included"),
        joins,
    ]
    figure.legend(handles=entries, loc="outside lower center", ncols=3, columnspacing=1.2)
