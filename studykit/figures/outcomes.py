"""What was measured in each condition: every participant's value, and the mean with its interval."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from studykit.core.arrays import Floats
from studykit.figures import style
from studykit.figures.samples import ORDER, beside_each_other, by_participant, mean_interval

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WITH_TRANSITION = tuple(f"{cell}-on" for cell in ORDER)
"""The four conditions whose dances were joined with the transition cost."""


def movement_by_condition(trials: pd.DataFrame, *, conditions: Sequence[str] = WITH_TRANSITION) -> Figure:
    """Show how far the dancers' movements were from the guide's, condition by condition (Figure 7).

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`; `dtw_m` in m.
    conditions : sequence of str
        Which conditions, from left to right.

    Raises
    ------
    InputError
        If no valid trial of these conditions has a distance.
    """
    return _by_condition(trials, "dtw_m", conditions, "Movement (DTW) distance (m)")


def heart_rate_by_condition(trials: pd.DataFrame, *, conditions: Sequence[str] = WITH_TRANSITION) -> Figure:
    """Show how fast hearts beat while performing, condition by condition.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`; `heart_rate_mean_bpm` in beats a minute.
    conditions : sequence of str
        Which conditions, from left to right.

    Raises
    ------
    InputError
        If no valid trial of these conditions has a heart rate.
    """
    return _by_condition(trials, "heart_rate_mean_bpm", conditions, "Mean heart rate (beats/min)")


def smoothness_by_condition(trials: pd.DataFrame, *, scale: tuple[int, int] = (1, 7)) -> Figure:
    """Show how smooth the dances were rated, each condition with and without transition cost (Figure 8).

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`; `smoothness_rating` on the scale of the protocol.
    scale : (int, int)
        The lowest and the highest answer.

    Raises
    ------
    InputError
        If no valid trial has a rating.
    """
    conditions = [f"{cell}-{transition}" for cell in ORDER for transition in ("on", "off")]
    table = by_participant(trials, "smoothness_rating", conditions)
    with style.in_style():
        figure = style.sheet(width_mm=140.0, height_mm=82.0, simulated=bool(trials["simulated"].any()))
        axes = figure.add_subplot()
        style.rule(axes)
        for cell, name in enumerate(ORDER):
            _draw_pair(axes, table[[f"{name}-on", f"{name}-off"]], 2.6 * cell)
        centres = [2.6 * cell + side for cell in range(len(ORDER)) for side in (0.0, 1.0)]
        axes.set_xticks(centres, ["on", "off"] * len(ORDER))
        axes.set_xlim(-0.6, centres[-1] + 0.6)
        for cell, name in enumerate(ORDER):
            words = " – ".join(part.capitalize() for part in name.split("-"))
            axes.text(
                2.6 * cell + 0.5, -0.13, words, transform=axes.get_xaxis_transform(), ha="center", va="top"
            )
        axes.set_xlabel("Transition cost", labelpad=16.0)
        low, high = scale
        axes.set_yticks(range(low, high + 1))
        axes.set_ylim(low - 0.5, high + 0.5)
        axes.set_ylabel(f"“The dance was smooth”\n({low} strongly disagree, {high} strongly agree)")
        _explain_pairs(figure)
    return figure


def _by_condition(
    trials: pd.DataFrame, outcome: str, conditions: Sequence[str], axis_label: str
) -> Figure:
    table = by_participant(trials, outcome, conditions)
    with style.in_style():
        figure = style.sheet(
            width_mm=style.COLUMN_MM, height_mm=74.0, simulated=bool(trials["simulated"].any())
        )
        axes = figure.add_subplot()
        style.rule(axes)
        shifts = np.column_stack(
            [beside_each_other(table[name].to_numpy(float), half_width=0.22) for name in conditions]
        )
        places = np.arange(len(conditions)) + shifts - 0.08
        axes.plot(places.T, table.to_numpy(float).T, color=style.FAINT, linewidth=0.35, alpha=0.35, zorder=1)
        for column, name in enumerate(conditions):
            _draw_sample(axes, column, places[:, column], table[name].to_numpy(float), name)
        axes.set_xticks(range(len(conditions)), [style.label(name) for name in conditions])
        axes.set_xlim(-0.55, len(conditions) - 0.4)
        axes.set_ylabel(axis_label)
        axes.tick_params(axis="x", length=0.0)
    return figure


def _draw_sample(axes: Axes, column: int, places: Floats, values: Floats, condition: str) -> None:
    intensity, variety, *_ = condition.split("-")
    colour = style.INTENSITY.get(intensity, style.INK)
    axes.scatter(
        places,
        values,
        s=11.0,
        marker=style.MARKERS.get(variety, "o"),
        color=colour,
        alpha=0.55,
        linewidths=0.0,
        gid=f"participants {condition}",
        zorder=2,
    )
    interval = mean_interval(values)
    axes.errorbar(
        column + 0.33,
        interval.mean,
        yerr=[[interval.mean - interval.low], [interval.high - interval.mean]],
        fmt=style.MARKERS.get(variety, "o"),
        color=style.INK,
        markerfacecolor=colour,
        markersize=5.0,
        elinewidth=1.0,
        capsize=2.5,
        label=f"mean {condition}",
        zorder=3,
    )


def _draw_pair(axes: Axes, pair: pd.DataFrame, left: float) -> None:
    colour = style.INTENSITY.get(str(pair.columns[0]).split("-", maxsplit=1)[0], style.INK)
    values = pair.to_numpy(float)
    shifts = [beside_each_other(values[:, side], half_width=0.30, bins=97) for side in (0, 1)]
    places = left + np.array([0.0, 1.0]) + np.column_stack(shifts)
    axes.plot(places.T, values.T, color=style.FAINT, linewidth=0.35, alpha=0.4, zorder=1)
    for side, name in enumerate(pair.columns):
        axes.scatter(
            places[:, side],
            values[:, side],
            s=10.0,
            facecolor=colour if side == 0 else "white",
            edgecolor=colour,
            linewidths=0.7,
            gid=f"participants {name}",
            zorder=2,
        )
        median, mean = np.nanmedian(values[:, side]), np.nanmean(values[:, side])
        x = left + side
        axes.plot([x - 0.4, x + 0.4], [median, median], color=style.INK, linewidth=1.6, zorder=3)
        axes.plot(x, mean, marker="D", markersize=4.0, color=style.INK, markerfacecolor="white", zorder=4)


def _explain_pairs(figure: Figure) -> None:
    from matplotlib.lines import Line2D

    entries = [
        Line2D([], [], marker="o", linestyle="", markersize=3.4, color=style.FAINT, label="participant, on"),
        Line2D(
            [], [], marker="o", linestyle="", markersize=3.4, color=style.FAINT, markerfacecolor="white",
            label="participant, off",
        ),
        Line2D([], [], color=style.INK, linewidth=1.6, label="median"),
        Line2D([], [], marker="D", linestyle="", markersize=4.0, color=style.INK, markerfacecolor="white", label="mean"),
    ]  # fmt: skip
    figure.legend(handles=entries, loc="outside lower center", ncols=len(entries))
