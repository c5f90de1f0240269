"""How hard and how varied dances are over time, beside what was asked of each block (Figures 9 and 10)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from studykit.choreography.dance import Dance
from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.figures import style
from studykit.figures.time_curves import PeopleCurve, draw_people
from studykit.motion import energy, kinematics
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.motion.skeleton import JOINT_NAMES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from studykit.figures.canvas import PaperFigure

_PANEL_MM, _FRAME_MM, _HEAD_MM = 28.0, 20.0, 12.0
_ACROSS = 2
_LONG_S = 64.0
Measure = Literal["linear_energy", "rotational_energy", "spared", "variety"]
_SPARED: Measure = "spared"
_LABELS: dict[Measure, str] = {
    "linear_energy": "Linear energy\n(J/s, {:g} kg)",
    "rotational_energy": "Rotational energy\n(J/s, {:g} kg)",
    "spared": "Spared joints,\nrotational (J/s)",
    "variety": "Variety (mean\nfeature distance)",
}
_DASHES = (0, (4, 1.5))


def energy_profile(
    dances: Sequence[Dance],
    *,
    body_mass_kg: float = DEFAULT_BODY_MASS_KG,
    window_s: float = 1.0,
    measures: Sequence[Measure] | None = None,
    people: Sequence[Sequence[PeopleCurve]] = (),
    simulated: bool = False,
) -> PaperFigure:
    """Show how hard dances are from moment to moment, what was asked, and what people did (Figures 9, 10).

    Parameters
    ----------
    dances : sequence of Dance
        One a column, two across; all share their axes.
    body_mass_kg : float
        Energies are shown for this body mass.
    window_s : float
        Length of the moving mean.
    measures : sequence of str, optional
        Which rows: "linear_energy", "rotational_energy", "spared", "variety". If not given, both energies,
        those of spared joints where a dance spares any, and variety where a dance has blocks.
    people : sequence of sequence of PeopleCurve, optional
        For each dance what was measured of those who danced it; a row each, below the others.
    simulated : bool
        Whether these people were simulated.

    Returns
    -------
    PaperFigure
        Linear and rotational energy of the movement as shown, in J for each second of dance: the area below a
        curve is the energy of the dance. Steps: what was asked of each block, and what it became. Ticks at
        the bottom: joins. Where a dance spares joints, the rotational energy of these joints alone, in every
        dance. Where a dance has blocks, their variety. Of people, the mean with its 95 % interval.

    Raises
    ------
    InputError
        If there is no dance to show, the window is not above 0, or not every dance has the same curves.
    """
    _require(dances, window_s, people)
    spared = sorted({name for dance in dances if dance.mask is not None for name in dance.mask.spared})
    is_blocked = any(len(dance.blocks) > 1 for dance in dances)
    rows = list(measures or _measures(is_blocked=is_blocked, spares=bool(spared)))
    count = len(rows) + (len(people[0]) if people else 0)
    across = min(_ACROSS, len(dances))
    bands = -(-len(dances) // across)
    is_long = max(dance.motion.duration_s for dance in dances) > _LONG_S
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM if across > 1 or (people and is_long) else style.COLUMN_MM,
            height_mm=_FRAME_MM + bands * (_HEAD_MM + _PANEL_MM * count),
            simulated=simulated,
            synthetic=any(dance.is_synthetic for dance in dances),
        )
        panels = figure.subplots(bands * count, across, squeeze=False)
        columns = panels.reshape(bands, count, across).swapaxes(1, 2).reshape(-1, count)
        for number, (column, dance) in enumerate(zip(columns, dances, strict=False)):
            for axes, measure in zip(column, rows, strict=False):
                _draw_measure(axes, dance, measure, (body_mass_kg, window_s, spared))
            for axes, curve in zip(column[len(rows) :], people[number] if people else (), strict=True):
                _draw_panel(axes, dance)
                draw_people(axes, curve, _colour(dance))
            if number % across == 0:
                labels = [_LABELS[measure].format(body_mass_kg) for measure in rows]
                labels += [curve.label for curve in (people[number] if people else ())]
                for axes, label in zip(column, labels, strict=True):
                    axes.set_ylabel(label)
            column[0].set_title(style.title(dance).replace(", sparing", ",\nsparing"), fontweight="bold")
            column[-1].set_xlabel("Time in the dance (s)")
            column[-1].tick_params(labelbottom=True)
        for axes in columns[len(dances) :].ravel():
            axes.remove()
        for row in range(count):
            _share_height(list(columns[: len(dances), row]), from_zero=row < len(rows))
        figure.align_ylabels()
        _explain(figure, is_blocked=is_blocked, has_people=bool(people))
    return figure


def _require(dances: Sequence[Dance], window_s: float, people: Sequence[Sequence[PeopleCurve]]) -> None:
    where = "energy profile"
    if not dances:
        raise InputError("there is no dance to show", where=where, remedy="give at least one")
    if not window_s > 0.0:
        raise InputError(f"a window of {window_s:g} s", where=where, remedy="say 1 s")
    labels = {tuple(curve.label for curve in curves) for curves in people}
    if people and (len(people) != len(dances) or len(labels) > 1):
        raise InputError(
            "not every dance has the same curves of people", where=where, remedy="give them for all or none"
        )


def _measures(*, is_blocked: bool, spares: bool) -> tuple[Measure, ...]:
    shown = {_SPARED: spares, "variety": is_blocked}
    return tuple(measure for measure in _LABELS if shown.get(measure, True))


def _draw_measure(
    axes: Axes, dance: Dance, measure: Measure, how: tuple[float, float, Sequence[str]]
) -> None:
    body_mass_kg, window_s, spared = how
    _draw_panel(axes, dance)
    if measure != "variety":
        steps = body_mass_kg * energy_steps(dance, measure, spared)
        _draw_curve(axes, dance, profile(steps, dance.motion.frame_rate_hz, window_s), measure)
    if measure != _SPARED:
        _draw_blocks(axes, dance, measure, body_mass_kg)


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


def energy_steps(dance: Dance, measure: Measure, spared: Sequence[str] = ()) -> Floats:
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


def _draw_curve(axes: Axes, dance: Dance, curve: tuple[Floats, Floats], measure: Measure) -> None:
    colour = style.SPARED if measure == _SPARED else _colour(dance)
    axes.plot(*curve, color=colour, linewidth=0.9, gid="profile")
    axes.fill_between(*curve, color=colour, alpha=0.15, linewidth=0.0)


def _draw_blocks(axes: Axes, dance: Dance, measure: Measure, body_mass_kg: float) -> None:
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


def _share_height(panels: Sequence[Axes], *, from_zero: bool) -> None:
    low = 0.0 if from_zero else min(axes.get_ylim()[0] for axes in panels)
    top = max(axes.get_ylim()[1] for axes in panels)
    for axes in panels:
        axes.set_ylim(low, top + 0.04 * (top - low))
        axes.locator_params(axis="y", nbins=5)


def _explain(figure: Figure, *, is_blocked: bool, has_people: bool) -> None:
    from matplotlib.lines import Line2D

    what = "block" if is_blocked else "dance"
    joins = Line2D([], [], linestyle="", marker="|", color=style.INK, markersize=5.0, markeredgewidth=0.7)
    joins.set_label("joins")
    entries = [
        Line2D([], [], color=style.INK, linewidth=1.0, linestyle=_DASHES, label=f"asked of the {what}"),
        Line2D([], [], color=style.FAINT, linewidth=2.4, alpha=0.7, label=f"the {what}, joins included"),
        joins,
    ]
    if has_people:
        entries.append(Line2D([], [], color=style.FAINT, linewidth=0.8, label="people: mean, 95 % interval"))
    across = len(entries) if figure.get_figwidth() * style.MM_PER_INCH > style.COLUMN_MM else 2
    figure.legend(
        handles=entries, loc="outside lower center", ncols=across if has_people else 3, columnspacing=1.2
    )
