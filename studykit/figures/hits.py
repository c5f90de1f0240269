"""How far the dances of many searches miss their targets, for one reading of the formulas beside another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from studykit.core.errors import InputError
from studykit.figures import style
from studykit.figures.samples import ORDER
from studykit.protocol.condition import ALL_CONDITIONS

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from studykit.figures.canvas import PaperFigure

ALLOWED = {"linear_off": 0.05, "rotational_off": 0.05, "variety_off": 0.10}
"""By what share a dance may miss each target and still hit it."""

_PANELS = {
    "linear_off": ("Linear energy off\n(% of the target)", 100.0),
    "rotational_off": ("Rotational energy off\n(% of the target)", 100.0),
    "variety_off": ("Variety off\n(% of Hard − Easy)", 100.0),
    "displacement_m": ("Jump at joins\n(mm)", 1000.0),
    "distinct_segments": ("Distinct\nsegments", 1.0),
}
_LOOKS = tuple((colour, marker) for colour, marker, _ in style.SERIES)
_FLOOR = 0.01  # per cent
_QUANTILES = (5.0, 50.0, 95.0)
_GOLDEN = (5.0**0.5 - 1.0) / 2.0


def hit_rates(
    table: pd.DataFrame, *, allowed: Mapping[str, float] = ALLOWED, synthetic: bool = False
) -> PaperFigure:
    """Show how far dances of many seeds miss their targets, and how many hit all of them.

    Parameters
    ----------
    table : DataFrame
        One row a dance: `condition`, `preset`, `seed`; by how much it misses its targets, of either sign:
        `linear_off` and `rotational_off` as shares of them, `variety_off` as a share of the gap between Hard
        and Easy; `displacement_m`, the mean over its joins; and `distinct_segments`.
    allowed : mapping of str to float
        By what share each target may be missed; those that are left out do not count.
    synthetic : bool, optional
        Whether any of the dances was made up rather than danced by a person.

    Returns
    -------
    PaperFigure
        Every dance as a dot, the median of its row and the range from the 5th to the 95th percentile; misses
        on a logarithmic axis, what is below 0.01 % at its edge. At the right: per cent of dances within the
        dashed line.

    Raises
    ------
    InputError
        If a column is missing, or there is no dance.
    """
    _require(table)
    conditions, presets = _ordered(table)
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM,
            height_mm=30.0 + len(conditions) * (2.0 + 3.6 * len(presets)),
            simulated=False,
            synthetic=synthetic,
        )
        panels = figure.subplots(1, len(_PANELS), sharey=True, width_ratios=(1.0, 1.0, 1.0, 0.75, 0.62))
        for axes, (column, (words, _)) in zip(panels, _PANELS.items(), strict=True):
            style.rule(axes, at="x")
            for row, condition in enumerate(conditions):
                for number, preset in enumerate(presets):
                    dances = table[(table["condition"] == condition) & (table["preset"] == preset)]
                    place = row + (number + 0.5) / len(presets) * 0.8 - 0.4
                    _draw_dances(axes, dances, column, (place, _LOOKS[number % len(_LOOKS)]))
                    if column in allowed:
                        _say_share(axes, place, hits(dances, {column: allowed[column]}), number)
            if column in allowed:
                axes.axvline(100.0 * allowed[column], color=style.INK, linewidth=0.9, linestyle=(0, (4, 1.5)))
            axes.set_xlabel(words)
            axes.tick_params(axis="y", length=0.0)
        _finish(figure, conditions)
        _explain(figure, table, presets, allowed)
    return figure


def hits(dances: pd.DataFrame, allowed: Mapping[str, float] = ALLOWED) -> float:
    """Give the share of dances that miss no target by more than is allowed; NaN where there is no dance."""
    if dances.empty:
        return float("nan")
    within = [dances[column].abs() <= most for column, most in allowed.items()]
    return float(np.all(within, axis=0).mean())


def _require(table: pd.DataFrame) -> None:
    wanted = ["condition", "preset", "seed", *_PANELS]
    missing = [column for column in wanted if column not in table.columns]
    if missing or table.empty:
        problem = f"there is no column {missing[0]!r}" if missing else "there is no dance"
        raise InputError(problem, where="hit rates", remedy=f"give {', '.join(wanted)}")


def _ordered(table: pd.DataFrame) -> tuple[list[str], list[str]]:
    """Give conditions in the order of figures, and presets with studykit's own first."""
    names = [f"{cell}-{transition}" for cell in ORDER for transition in ("on", "off")]
    present = list(dict.fromkeys(table["condition"]))
    conditions = [name for name in names if name in present] + [n for n in present if n not in names]
    return conditions, sorted(set(table["preset"]), key=lambda preset: (preset != "studykit", preset))


def _draw_dances(axes: Axes, dances: pd.DataFrame, column: str, at: tuple[float, tuple[str, str]]) -> None:
    if dances.empty:
        return
    place, (colour, marker) = at
    values = _PANELS[column][1] * dances[column].to_numpy(float)
    if column.endswith("_off"):
        axes.set_xscale("log")
        values = np.maximum(np.abs(values), _FLOOR)
    spread = place + 0.22 * (np.arange(len(values)) * _GOLDEN % 1.0 - 0.5)
    axes.scatter(values, spread, s=2.5, color=colour, alpha=0.3, linewidths=0.0, gid=f"dances {column}")
    low, middle, high = np.percentile(values, _QUANTILES)
    axes.hlines(place, low, high, color=colour, linewidth=1.1, gid="range")
    axes.scatter(
        middle, place, s=15.0, color=colour, marker=marker, edgecolors="white", linewidths=0.5, zorder=4,
        gid="median",
    )  # fmt: skip


def _say_share(axes: Axes, place: float, share: float, number: int) -> None:
    if np.isfinite(share):
        axes.text(
            1.02, place, f"{100.0 * share:.0f}", transform=axes.get_yaxis_transform(), va="center",
            fontsize=6.0, color=_LOOKS[number % len(_LOOKS)][0], gid="share",
        )  # fmt: skip


def _finish(figure: Figure, conditions: Sequence[str]) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    first = figure.axes[0]
    labels = [
        f"{style.words(name)}, {name.rsplit('-', maxsplit=1)[1]}" if name in ALL_CONDITIONS else name
        for name in conditions
    ]
    first.set_yticks(range(len(labels)), labels)
    first.set_ylim(len(labels) - 0.5, -0.5)
    first.set_ylabel("Condition, transition cost")
    for axes in figure.axes:
        if axes.get_xscale() == "log":
            axes.xaxis.set_major_locator(LogLocator(numticks=6))
            axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axes.xaxis.set_minor_formatter(NullFormatter())
        else:
            axes.set_xlim(0.0, axes.dataLim.xmax * 1.2)


def _explain(
    figure: Figure, table: pd.DataFrame, presets: Sequence[str], allowed: Mapping[str, float]
) -> None:
    from matplotlib.lines import Line2D

    entries = [
        Line2D(
            [], [], color=colour, marker=marker, markersize=4.0,
            label=f"{preset}: {100.0 * hits(table[table['preset'] == preset], allowed):.1f} % hit all",
        )
        for preset, (colour, marker) in zip(presets, _LOOKS * len(presets), strict=False)
    ]  # fmt: skip
    entries.append(
        Line2D(
            [],
            [],
            color=style.INK,
            linewidth=0.9,
            linestyle=(0, (4, 1.5)),
            label="allowed; right of it: % within",
        )
    )
    figure.legend(handles=entries, loc="outside lower center", ncols=len(entries))
