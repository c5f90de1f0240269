"""What a dance library holds: how hard its dances are, how varied, and which goals are in reach."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.choreography.dance_library import CHAIN_SEGMENTS, DanceLibrary
from studykit.choreography.goal import Goal
from studykit.choreography.targets import PAPER_ENERGIES, PAPER_VARIETIES
from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.figures import style
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.motion.segmentation import SEGMENT_S

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from studykit.figures.canvas import PaperFigure

_CHAIN_S = CHAIN_SEGMENTS * SEGMENT_S
_WINDOW = f"{_CHAIN_S:g} s"
_NAMES = ("Linear energy", "Rotational energy")
_PALE = "#c9c9c9"
_DASHES = (0, (3.0, 1.6))
_MANY = 100  # fewer dances are shown one by one
_LINES: Mapping[str, Any] = {"chains": "-", "windows": (0, (1.0, 1.0))}
_WORDS = {
    "segments": f"segments, danced for {_WINDOW}",
    "chains": f"random chains of {_WINDOW}",
    "windows": f"{_WINDOW} danced in one go",
}
_NO_GOALS: Mapping[str, Goal] = {}


def energy_distribution(
    library: DanceLibrary,
    *,
    goals: Mapping[str, Goal] = _NO_GOALS,
    body_mass_kg: float = DEFAULT_BODY_MASS_KG,
) -> PaperFigure:
    """Show how hard the segments of a library are, and where light and intense dances aim.

    Parameters
    ----------
    library : DanceLibrary
        Its segments are shown as if danced for 32 s, beside the random chains that it was calibrated on and
        the windows of 32 s that were danced in one go.
    goals : mapping of str to Goal, optional
        The goals of a protocol on this library, marked by their intensity.
    body_mass_kg : float
        Energies are shown for this body mass; the paper's targets are for 73.5 kg.

    Raises
    ------
    InputError
        If the library is empty.
    """
    _require(library)
    levels = _energy_levels(goals, body_mass_kg)
    with style.in_style():
        figure = _sheet(library, width_mm=style.PAGE_MM, height_mm=72.0)
        panels = figure.subplots(1, 2, sharey=True)
        measured = (_segment_energies(library), _chain_energies(library), _window_energies(library))
        for column, axes in enumerate(panels):
            segments, chains, windows = (body_mass_kg * values[column] for values in measured)
            paper = {level: values[column] for level, values in PAPER_ENERGIES.items()}
            asked = {level: values[column] for level, values in levels.items()}
            danced = CHAIN_SEGMENTS * segments
            reach = [*danced[danced > 0.0], *chains, *windows, *paper.values(), *asked.values()]
            bins = np.geomspace(min(reach) / 1.1, max(reach) * 1.1, 36)
            _draw_shares(axes, bins, segments=danced, chains=chains, windows=windows)
            _draw_levels(axes, asked, paper, style.INTENSITY)
            _log_scale(axes, "x")
            axes.set_xlabel(f"{_NAMES[column]} in {_WINDOW} (J, {body_mass_kg:g} kg)")
        panels[0].set_ylabel("Share (%)")
        _explain(figure, library, asked=bool(levels), colours=style.INTENSITY, segments=True)
    return figure


def variety_distribution(library: DanceLibrary, *, goals: Mapping[str, Goal] = _NO_GOALS) -> PaperFigure:
    """Show how varied random dances from a library are, and where easy and hard dances aim.

    Parameters
    ----------
    library : DanceLibrary
        Its calibration holds random chains, and windows of 32 s that were danced in one go.
    goals : mapping of str to Goal, optional
        The goals of a protocol on this library; those that measure variety by the cosine, or ask for none
        because a single segment has nothing to differ from, are left out.

    Raises
    ------
    InputError
        If the library is empty.
    """
    _require(library)
    asked = {
        goal.condition.split("-")[1]: goal.measures.variety
        for goal in goals.values()
        if goal.preset.variety == "euclidean_z" and goal.measures.variety > 0.0
    }
    chains, windows = library.calibration.chain_varieties, library.calibration.window_varieties
    reach = [*chains, *windows, *PAPER_VARIETIES.values(), *asked.values()]
    colours = {"easy": "#666666", "hard": style.INK}
    with style.in_style():
        figure = _sheet(library, width_mm=style.PAGE_MM * 0.66, height_mm=72.0)
        axes = figure.add_subplot()
        axes.set_xlim(0.0, 1.06 * max(reach))
        _draw_shares(axes, np.linspace(0.0, 1.06 * max(reach), 61), chains=chains, windows=windows)
        _draw_levels(axes, asked, PAPER_VARIETIES, colours)
        axes.set_xlabel(f"Variety of {_WINDOW} (mean feature distance of its segments)")
        axes.set_ylabel("Share (%)")
        _explain(figure, library, asked=bool(asked), colours=colours, segments=False)
    return figure


def target_space(
    library: DanceLibrary,
    *,
    goals: Mapping[str, Goal] = _NO_GOALS,
    body_mass_kg: float = DEFAULT_BODY_MASS_KG,
) -> PaperFigure:
    """Show which pairs of linear and rotational energy dances from a library can have.

    Parameters
    ----------
    library : DanceLibrary
        Its segments and the random chains of its calibration.
    goals : mapping of str to Goal, optional
        The goals of a protocol on this library.
    body_mass_kg : float
        Energies are shown for this body mass; the paper's targets are for 73.5 kg.

    Returns
    -------
    PaperFigure
        Every dance of 32 s lies within the outline: its energy is the mean of its segments', each danced for
        32 s, and the outline is their convex hull.

    Raises
    ------
    InputError
        If the library is empty.
    """
    _require(library)
    segments = body_mass_kg * CHAIN_SEGMENTS * np.stack(_segment_energies(library), axis=1)
    chains = body_mass_kg * np.stack(_chain_energies(library), axis=1)
    outline = _outline(segments)
    with style.in_style():
        figure = _sheet(library, width_mm=style.COLUMN_MM * 1.3, height_mm=108.0)
        axes = figure.add_subplot()
        axes.fill(outline[:, 0], outline[:, 1], color=style.GRID, alpha=0.55, linewidth=0.0, zorder=0)
        axes.plot(outline[:, 0], outline[:, 1], color=style.FAINT, linewidth=0.8, zorder=1, gid="outline")
        axes.scatter(
            segments[:, 0],
            segments[:, 1],
            s=3.0,
            color=style.FAINT,
            alpha=0.5,
            linewidths=0.0,
            gid="segments",
        )
        axes.scatter(
            chains[:, 0], chains[:, 1], s=4.0, color=style.INK, alpha=0.35, linewidths=0.0, gid="chains"
        )
        windows = body_mass_kg * np.stack(_window_energies(library), axis=1)
        axes.scatter(
            windows[:, 0], windows[:, 1], s=9.0, marker="+", color=style.INK, linewidths=0.5, gid="windows"
        )
        for level, place in _energy_levels(goals, body_mass_kg).items():
            _draw_point(axes, place, style.INTENSITY[level], filled=True, gid=f"goal {level}")
        for level, place in PAPER_ENERGIES.items():
            _draw_point(axes, place, style.INTENSITY[level], filled=False, gid=f"paper {level}")
        _log_scale(axes, "x")
        _log_scale(axes, "y")
        axes.set_xlabel(f"{_NAMES[0]} in {_WINDOW} (J, {body_mass_kg:g} kg)")
        axes.set_ylabel(f"{_NAMES[1]} in {_WINDOW} (J, {body_mass_kg:g} kg)")
        _explain_space(figure, asked=bool(goals), kinds=_kinds(library))
    return figure


def _require(library: DanceLibrary) -> None:
    if not len(library):
        raise InputError("the library has no segment to show", where=library.name, remedy="add takes")


def _sheet(library: DanceLibrary, *, width_mm: float, height_mm: float) -> PaperFigure:
    return style.sheet(
        width_mm=width_mm, height_mm=height_mm, simulated=False, synthetic=library.is_synthetic
    )


def _segment_energies(library: DanceLibrary) -> tuple[Floats, Floats]:
    return library.linear_energies.sum(axis=1), library.rotational_energies.sum(axis=1)


def _chain_energies(library: DanceLibrary) -> tuple[Floats, Floats]:
    calibration = library.calibration
    return calibration.chain_linear_energies, calibration.chain_rotational_energies


def _window_energies(library: DanceLibrary) -> tuple[Floats, Floats]:
    calibration = library.calibration
    return calibration.window_linear_energies, calibration.window_rotational_energies


def _energy_levels(goals: Mapping[str, Goal], body_mass_kg: float) -> dict[str, tuple[float, float]]:
    """Give what light and intense dances aim at in 32 s, J."""
    return {
        goal.condition.split("-", maxsplit=1)[0]: (
            body_mass_kg * goal.measures.linear_energy * _CHAIN_S / goal.duration_s,
            body_mass_kg * goal.measures.rotational_energy * _CHAIN_S / goal.duration_s,
        )
        for goal in goals.values()
    }


def _outline(places: Floats) -> Floats:
    """Give the closed convex hull of places, its edges in small steps (they are bent on a log scale)."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        corners = places[ConvexHull(places).vertices]
    except QhullError:  # fewer than three places, or all on a line
        corners = places[np.argsort(places[:, 0])][[0, -1]]
    share = np.linspace(0.0, 1.0, 60)[:, None]
    ends = np.roll(corners, -1, axis=0)
    return np.concatenate([start + share * (end - start) for start, end in zip(corners, ends, strict=True)])


def _draw_shares(axes: Axes, bins: Floats, **kinds: Floats) -> None:
    """Draw how frequent values are: segments as a surface, dances as outlines, few dances one by one."""
    style.rule(axes)
    for kind, values in kinds.items():
        if kind == "windows" and len(values) < _MANY:
            axes.plot(
                values, np.full(len(values), 0.025), linestyle="", marker="|", markersize=6.0,
                color=style.INK, markeredgewidth=0.7, transform=axes.get_xaxis_transform(), zorder=4,
                gid=kind,
            )  # fmt: skip
            continue
        weights = np.full(len(values), 100.0 / len(values))
        look: dict[str, Any] = (
            {"color": _PALE, "linewidth": 0.0}
            if kind == "segments"
            else {"histtype": "step", "color": style.INK, "linewidth": 1.0, "linestyle": _LINES[kind]}
        )
        axes.hist(values, bins.tolist(), weights=weights, gid=kind, **look)
    axes.margins(y=0.08)


def _draw_levels(
    axes: Axes, asked: Mapping[str, float], paper: Mapping[str, float], colours: Mapping[str, str]
) -> None:
    """Draw targets as lines with their names, which tell them apart without colour."""
    for level, value in asked.items():
        axes.axvline(value, color=colours[level], linewidth=1.4, gid=f"goal {level}", zorder=3)
        axes.text(
            value, 1.01, level, transform=axes.get_xaxis_transform(), color=colours[level], fontsize=6.5,
            rotation=40.0, ha="left", va="bottom", rotation_mode="anchor",
        )  # fmt: skip
    for level, value in paper.items():
        axes.axvline(
            value, color=colours[level], linestyle=_DASHES, linewidth=1.4, gid=f"paper {level}", zorder=3
        )
        # Beside the line, on the side away from the nearest goal.
        nearest = min(asked.values(), key=lambda goal: abs(goal - value), default=value)
        is_right = nearest < value
        axes.annotate(
            f"{level} (paper)", (value, 0.98), xycoords=axes.get_xaxis_transform(),
            xytext=(1.5 if is_right else -1.5, 0.0), textcoords="offset points", color=colours[level],
            fontsize=6.5, rotation=90.0, ha="left" if is_right else "right", va="top", zorder=4,
            bbox={"facecolor": "white", "alpha": 0.75, "linewidth": 0.0, "pad": 0.6},
        )  # fmt: skip


def _draw_point(axes: Axes, place: tuple[float, float], colour: str, *, filled: bool, gid: str) -> None:
    axes.scatter(
        *place,
        s=46.0,
        marker="D",
        facecolor=colour if filled else "white",
        edgecolor=style.INK if filled else colour,
        linewidths=0.8 if filled else 1.6,
        zorder=5,
        gid=gid,
    )


def _log_scale(axes: Axes, axis: str) -> None:
    """Scale an axis by ratios, with ticks that a reader can read off."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    (axes.set_xscale if axis == "x" else axes.set_yscale)("log")
    one = axes.xaxis if axis == "x" else axes.yaxis
    one.set_major_locator(LogLocator(base=10.0, subs=(1.0, 2.0, 5.0)))
    one.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    one.set_minor_formatter(NullFormatter())
    axes.tick_params(axis="x" if axis == "x" else "y", which="minor", length=0.0)


def _kinds(library: DanceLibrary) -> tuple[str, ...]:
    """Name what is shown of dances: no take of a library may last long enough for a window."""
    return ("chains", "windows") if len(library.calibration.window_varieties) else ("chains",)


def _explain(
    figure: Figure, library: DanceLibrary, *, asked: bool, colours: Mapping[str, str], segments: bool
) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries: list[Any] = [Patch(color=_PALE, label=_WORDS["segments"])] if segments else []
    for kind in _kinds(library):
        if kind == "windows" and len(library.calibration.window_varieties) < _MANY:
            entries.append(
                Line2D([], [], linestyle="", marker="|", markersize=6.0, color=style.INK, label=_WORDS[kind])
            )
        else:
            entries.append(_line(style.INK, _LINES[kind], _WORDS[kind], width=1.0))
    for level, colour in colours.items():
        if asked:
            entries.append(_line(colour, "-", f"{level}: this library's goal"))
        entries.append(_line(colour, _DASHES, f"{level}: printed in the paper"))
    figure.legend(handles=entries, loc="outside lower center", ncols=3 if segments else 2)


def _line(colour: str, kind: Any, words: str, *, width: float = 1.4) -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], color=colour, linestyle=kind, linewidth=width, label=words)


def _explain_space(figure: Figure, *, asked: bool, kinds: tuple[str, ...]) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries: list[Any] = [
        Line2D([], [], linestyle="", marker=marker, markersize=size, color=colour, label=_WORDS[kind])
        for kind, marker, size, colour in (
            ("segments", "o", 2.0, style.FAINT),
            ("chains", "o", 2.4, style.INK),
            ("windows", "+", 4.0, style.INK),
        )
        if kind in ("segments", *kinds)
    ]
    entries.append(Patch(facecolor=style.GRID, edgecolor=style.FAINT, label="what any dance can have"))
    for level, colour in style.INTENSITY.items():
        for is_own, words in ((True, "this library's goal"), (False, "printed in the paper")):
            if asked or not is_own:
                entries.append(
                    Line2D(
                        [], [], linestyle="", marker="D", markersize=5.0, label=f"{level}: {words}",
                        markerfacecolor=colour if is_own else "white",
                        markeredgecolor=style.INK if is_own else colour,
                        markeredgewidth=0.8 if is_own else 1.6,
                    )
                )  # fmt: skip
    figure.legend(handles=entries, loc="outside lower center", ncols=2)
