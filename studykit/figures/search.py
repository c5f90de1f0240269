"""How a dance was found: costs, terms and temperature while the search went on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.choreography.dance import Dance
from studykit.core.arrays import Floats, Integers
from studykit.core.errors import InputError
from studykit.figures import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from studykit.figures.canvas import PaperFigure

_HEIGHTS_MM = (32.0, 32.0, 20.0, 12.0, 18.0)
_DASHES = (0, (4, 1))
_DECADES = 4
_ACROSS = 4
# Okabe and Ito's palette without its yellow; dashes tell the lines apart in grey.
_LINES: tuple[tuple[str, Any], ...] = (
    ("#0072B2", "-"),
    ("#D55E00", "-"),
    ("#009E73", "-"),
    ("#CC79A7", _DASHES),
    ("#E69F00", _DASHES),
    ("#56B4E9", _DASHES),
    ("#222222", (0, (1, 1))),
)


def search_trace(dance: Dance) -> PaperFigure:
    """Show how the search for a dance went.

    Parameters
    ----------
    dance : Dance
        With its trace.

    Returns
    -------
    PaperFigure
        Over iterations: the cost and the best so far, beside the best of every chain and the cost of this
        dance; every term times its weight, at its final tolerance; temperature and width of tolerances;
        number of segments; share of moves accepted. The cost of the moment is that at the width of the
        moment. On logarithmic axes, what lies more than four decades below the highest stands at the lower
        edge.

    Raises
    ------
    InputError
        If the dance has no trace.
    """
    if not dance.trace:
        raise InputError(
            "the dance has no trace of its search", where=dance.condition, remedy="choreograph it again"
        )
    iterations = np.array([row.iteration for row in dance.trace])
    terms = {
        name: weight * np.array([row.terms[name] for row in dance.trace])
        for name, weight in dance.weights.items()
        if weight > 0.0 and name in dance.trace[0].terms
    }
    with style.in_style():
        figure = style.sheet(
            width_mm=style.COLUMN_MM,
            height_mm=46.0 + sum(_HEIGHTS_MM),
            simulated=False,
            synthetic=dance.is_synthetic,
        )
        panels = figure.subplots(len(_HEIGHTS_MM), 1, sharex=True, height_ratios=_HEIGHTS_MM)
        panels[0].set_title(
            style.title(dance).replace(", sparing", ",\nsparing"), fontweight="bold", pad=14.0
        )
        _draw_costs(panels[0], iterations, dance)
        _draw_terms(panels[1], iterations, terms)
        _draw_annealing(panels[2], iterations, dance)
        segments = [row.segments for row in dance.trace]
        panels[3].plot(iterations, segments, color=style.INK, linewidth=0.9, gid="segments")
        panels[3].set_ylabel("Segments")
        panels[3].locator_params(axis="y", integer=True, nbins=3)
        _draw_acceptance(panels[4], iterations, dance)
        for axes in panels:
            style.rule(axes)
        panels[-1].set_xlim(0.0, iterations[-1])
        panels[-1].set_xlabel("Iteration")
        figure.align_ylabels()
    return figure


def search_traces(dances: Sequence[Dance]) -> PaperFigure:
    """Show how the searches for the dances of a study went: the costs of each, on one scale.

    Parameters
    ----------
    dances : sequence of Dance
        A panel each, four across; those without a trace are left out.

    Returns
    -------
    PaperFigure
        Over iterations the cost of the moment and the best so far; at the right the best of every chain, and
        the cost of the dance that was taken.

    Raises
    ------
    InputError
        If no dance has a trace.
    """
    traced = [dance for dance in dances if dance.trace]
    if not traced:
        raise InputError(
            "no dance has a trace of its search", where="dances", remedy="choreograph them again"
        )
    across = min(_ACROSS, len(traced))
    down = -(-len(traced) // across)
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM,
            height_mm=14.0 + 42.0 * down,
            simulated=False,
            synthetic=any(dance.is_synthetic for dance in traced),
        )
        panels = figure.subplots(down, across, squeeze=False, sharey=True).ravel()
        for axes, dance in zip(panels, traced, strict=False):
            _draw_costs(axes, np.array([row.iteration for row in dance.trace]), dance, is_alone=False)
            style.rule(axes)
            axes.set_title(style.title(dance).replace(", ", ",\n"), fontsize=7.5, fontweight="bold")
            axes.set_xlim(0.0, dance.trace[-1].iteration)
            axes.locator_params(axis="x", nbins=4)
            axes.xaxis.set_major_formatter(lambda value, _: f"{value / 1000.0:g}")
            axes.set_xlabel("Iteration (thousands)")
            axes.label_outer()
        for axes in panels[len(traced) :]:
            axes.remove()
        lines, names = panels[0].get_legend_handles_labels()
        names = ["chains" if name.endswith(" chains") else name for name in names]
        figure.legend(lines, names, loc="outside lower center", ncols=4)
    return figure


def _draw_costs(axes: Axes, iterations: Integers, dance: Dance, *, is_alone: bool = True) -> None:
    for name, words, colour, width in (
        ("cost", "now", style.FAINT, 0.8),
        ("best_cost", "best", style.INK, 1.3),
    ):
        costs = [getattr(row, name) for row in dance.trace]
        axes.plot(iterations, costs, color=colour, linewidth=width, label=words, gid=name)
    beside: dict[str, Any] = {
        "transform": axes.get_yaxis_transform(),
        "clip_on": False,
        "linestyle": "",
        "markersize": 3.0,
    }
    chains = dance.chain_costs
    axes.plot(
        np.full(len(chains), 1.05), chains, marker="o", color=style.INTENSITY["intense"], alpha=0.6,
        label=f"{len(chains)} chains", gid="chains", **beside,
    )  # fmt: skip
    axes.plot(
        [1.05], [dance.cost_total], marker="D", color=style.INK, fillstyle="none", markeredgewidth=0.7,
        label="this dance", gid="found", **beside,
    )  # fmt: skip
    axes.set_ylabel("Cost (Eq. 1)")
    _make_logarithmic(axes)
    if is_alone:
        _name_lines(axes, columns=4)


def _draw_terms(axes: Axes, iterations: Integers, terms: Mapping[str, Floats]) -> None:
    for number, (name, values) in enumerate(terms.items()):
        colour, dashes = _LINES[number % len(_LINES)]
        axes.plot(
            iterations, values, color=colour, linestyle=dashes, linewidth=0.9, label=name, gid=f"term {name}"
        )
    axes.set_ylabel("Weight × term")
    _make_logarithmic(axes)
    _name_lines(axes)


def _draw_annealing(axes: Axes, iterations: Integers, dance: Dance) -> None:
    for name, words, dashes in (
        ("temperature", "temperature", "-"),
        ("width", "width of tolerances", _DASHES),
    ):
        values = [getattr(row, name) for row in dance.trace]
        axes.plot(iterations, values, color=style.INK, linestyle=dashes, linewidth=0.9, label=words, gid=name)
    axes.set_ylabel("Annealing")
    _make_logarithmic(axes)
    _name_lines(axes)


def _draw_acceptance(axes: Axes, iterations: Integers, dance: Dance) -> None:
    looks: dict[str, tuple[str, Any]] = {
        "accepted": (style.INK, "-"),
        "inserted": (_LINES[0][0], _DASHES),
        "removed": (_LINES[1][0], (0, (1, 1))),
        "replaced": (_LINES[2][0], "-"),
    }
    for name, (colour, dashes) in looks.items():
        # A stage in which no such move was tried has no share.
        values = 100.0 * np.array([getattr(row, name) for row in dance.trace], dtype=np.float64)
        if np.isfinite(values).any():
            words = "all" if name == "accepted" else name
            axes.plot(
                iterations, values, color=colour, linestyle=dashes, linewidth=0.9, label=words, gid=name
            )
    axes.set_ylim(0.0, 100.0)
    axes.set_ylabel("Accepted\n(%)")
    _name_lines(axes, columns=4)


def _name_lines(axes: Axes, *, columns: int = 3) -> None:
    axes.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 0.98),
        ncols=columns,
        columnspacing=0.8,
        handlelength=1.4,
        borderpad=0.0,
        borderaxespad=0.2,
    )


def _make_logarithmic(axes: Axes) -> None:
    """Let the axis span four decades at most; what lies below, also nothing at all, is drawn at its edge."""
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    values = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in axes.lines])
    values = values[np.isfinite(values)]  # before a dance keeps what must be kept, the best cost is infinite
    highest = float(values.max(initial=0.0))
    if highest <= 0.0:
        return  # there is no logarithm to show
    floor = highest * 10.0**-_DECADES
    for line in axes.lines:
        line.set_ydata(np.maximum(np.asarray(line.get_ydata(), dtype=float), floor))
    axes.relim()
    axes.set_yscale("log")
    if values.min() < floor:
        axes.set_ylim(bottom=floor)
    bottom, top = axes.get_ylim()
    axes.yaxis.set_major_locator(
        LogLocator(subs=(1.0, 2.0, 5.0) if top < 30.0 * bottom else (1.0,), numticks=6)
    )
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
