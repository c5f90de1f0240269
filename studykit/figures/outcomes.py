"""What was measured in each condition: every participant's value, and the mean with its interval."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.figures import style
from studykit.figures.samples import ORDER, beside_each_other, by_participant, mean_interval, valid_trials

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.container import ErrorbarContainer
    from matplotlib.lines import Line2D

    from studykit.figures.canvas import PaperFigure

_CELL_WIDTH = 2.9
_OFF_AT = 1.35


def movement_by_condition(trials: pd.DataFrame) -> PaperFigure:
    """Show how far the dancers' movements were from the guide's, condition by condition (Figure 7).

    Only the conditions with transition cost are shown, as in the study that this follows.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`; `dtw_m` in m.

    Raises
    ------
    InputError
        If no valid trial has a distance.
    """
    return _by_condition(trials, "dtw_m", "Movement (DTW) distance (m)")


def heart_rate_by_condition(trials: pd.DataFrame) -> PaperFigure:
    """Show how fast hearts beat while performing, condition by condition.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`; `heart_rate_mean_bpm` in beats a minute.

    Raises
    ------
    InputError
        If no valid trial has a heart rate.
    """
    return _by_condition(trials, "heart_rate_mean_bpm", "Mean heart rate (beats/min)")


def smoothness_by_condition(
    trials: pd.DataFrame, *, scale: tuple[int, int] = (1, 7), question: str = "The dance was smooth."
) -> PaperFigure:
    """Show how smooth the dances were rated, each condition with and without transition cost (Figure 8).

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`; `smoothness_rating` on the scale of the protocol.
    scale : (int, int)
        The lowest and the highest answer.
    question : str
        The sentence that was rated.

    Raises
    ------
    InputError
        If no valid trial has a rating.
    """
    table = by_participant(valid_trials(trials, ["smoothness_rating"], transition=None), "smoothness_rating")
    cells = [cell for cell in ORDER if any(name.startswith(f"{cell}-") for name in table.columns)]
    lefts = _CELL_WIDTH * np.arange(len(cells))
    low, high = scale
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM, height_mm=84.0, simulated=bool(trials["simulated"].any())
        )
        axes = figure.add_subplot()
        style.rule(axes)
        for cell, left in zip(cells, lefts, strict=True):
            _draw_cell(axes, table, cell, left)
        axes.set_xticks(np.add.outer(lefts, [0.0, _OFF_AT]).ravel(), ["on", "off"] * len(cells))
        axes.set(xlim=(-0.65, lefts[-1] + _OFF_AT + 0.75), ylim=(low - 0.5, high + 0.5))
        axes.set_yticks(range(low, high + 1))
        axes.tick_params(axis="x", length=0.0)
        axes.set_xlabel("Transition cost")
        axes.set_ylabel(f"“{question.rstrip('.')}”\n({low} strongly disagree … {high} strongly agree)")
        median = _sign(color=style.FAINT, alpha=0.45, linewidth=4.0, label="median")
        participants = [participant_sign(filled=filled) for filled in (True, False)]
        figure.legend(handles=[*participants, median, mean_sign(axes)], loc="outside lower center", ncols=4)
    return figure


def declared_outcomes(
    trials: pd.DataFrame, declared: Sequence[tuple[str, str, Sequence[str]]]
) -> PaperFigure:
    """Show every participant's value of every outcome that was declared, with means and intervals.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`.
    declared : sequence of (str, str, sequence of str)
        Column, what its axis says, and the conditions compared; a panel each, from top to bottom.

    Raises
    ------
    InputError
        If nothing is declared, or no valid trial has a value of any of them.
    """
    shown, problem = [], None
    for outcome, axis_label, conditions in declared:
        try:
            kept = valid_trials(trials, [outcome], transition=None)
        except InputError as error:
            problem = error
            continue
        table = by_participant(kept[kept["condition"].isin(list(conditions))], outcome)
        shown.append((table, axis_label))
    if not shown:
        raise problem or InputError(
            "no test is declared", where="protocol", remedy="declare one under [[analysis.tests]]"
        )
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM,
            height_mm=12.0 + 52.0 * len(shown),
            simulated=bool(trials["simulated"].any()),
        )
        panels = figure.subplots(len(shown), 1, squeeze=False)[:, 0]
        for axes, (table, axis_label) in zip(panels, shown, strict=True):
            _draw_conditions(axes, table, axis_label, says_transition=table.shape[1] > len(ORDER))
        figure.align_ylabels()
        figure.legend(
            handles=[participant_sign(filled=None), mean_sign(panels[0])], loc="outside lower center", ncols=2
        )
    return figure


def _by_condition(trials: pd.DataFrame, outcome: str, axis_label: str) -> PaperFigure:
    table = by_participant(valid_trials(trials, [outcome], transition="on"), outcome)
    with style.in_style():
        figure = style.sheet(
            width_mm=style.COLUMN_MM, height_mm=76.0, simulated=bool(trials["simulated"].any())
        )
        axes = figure.add_subplot()
        _draw_conditions(axes, table, axis_label)
        figure.legend(
            handles=[participant_sign(filled=None), mean_sign(axes)], loc="outside lower center", ncols=2
        )
    return figure


def _draw_conditions(
    axes: Axes, table: pd.DataFrame, axis_label: str, *, says_transition: bool = False
) -> None:
    values = table.to_numpy(float)
    style.rule(axes)
    shifts = [beside_each_other(column, half_width=0.22) for column in values.T]
    places = np.asarray(np.arange(values.shape[1]) - 0.08 + np.column_stack(shifts), dtype=np.float64)
    axes.plot(places.T, values.T, color=style.FAINT, linewidth=0.35, alpha=0.35, zorder=1)
    for column, name in enumerate(table.columns):
        draw_participants(axes, places[:, column], values[:, column], name)
        draw_mean(axes, column + 0.34, values[:, column], name)
    labels = [style.words(name, between="\n") for name in table.columns]
    if says_transition:
        labels = [
            f"{label}\n{name.rsplit('-', maxsplit=1)[1]}"
            for label, name in zip(labels, table.columns, strict=True)
        ]
    axes.set_xticks(range(len(labels)), labels)
    axes.set_xlim(-0.5, len(labels) - 0.45)
    axes.set_ylabel(axis_label)
    axes.tick_params(axis="x", length=0.0)


def draw_participants(axes: Axes, places: Floats, values: Floats, condition: str) -> None:
    """Draw one point a participant; hollow where there was no transition cost."""
    colour, is_hollow = style.colour(condition), condition.endswith("-off")
    axes.scatter(
        places,
        values,
        s=10.0,
        marker=style.marker(condition),
        facecolor="white" if is_hollow else colour,
        edgecolor=colour,
        alpha=1.0 if is_hollow else 0.6,
        linewidths=0.7 if is_hollow else 0.0,
        gid=f"participants {condition}",
        zorder=2,
    )


def draw_mean(axes: Axes, place: float, values: Floats, condition: str) -> None:
    """Draw the mean of the participants with its 95 % interval."""
    interval = mean_interval(values)
    axes.errorbar(
        place,
        interval.mean,
        yerr=[[interval.mean - interval.low], [interval.high - interval.mean]],
        fmt=style.marker(condition),
        color=style.INK,
        markerfacecolor="white" if condition.endswith("-off") else style.colour(condition),
        markersize=4.8,
        markeredgewidth=0.8,
        elinewidth=1.0,
        capsize=2.2,
        zorder=4,
    )


def _draw_cell(axes: Axes, table: pd.DataFrame, cell: str, left: float) -> None:
    pair = table.reindex(columns=[f"{cell}-on", f"{cell}-off"])
    values = pair.to_numpy(float)
    centres = (left, left + _OFF_AT)
    shifts = [beside_each_other(column, half_width=0.34, bins=97) for column in values.T]
    places = np.array(centres) + np.column_stack(shifts)
    axes.plot(places.T, values.T, color=style.FAINT, linewidth=0.35, alpha=0.4, zorder=1)
    for side, name in enumerate(pair.columns):
        answers = values[np.isfinite(values[:, side]), side]
        if not len(answers):
            continue
        draw_participants(axes, places[:, side], values[:, side], name)
        axes.hlines(
            np.median(answers), centres[side] - 0.42, centres[side] + 0.42,
            color=style.FAINT, alpha=0.45, linewidth=4.0, zorder=1.5,
        )  # fmt: skip
        draw_mean(axes, centres[side] + 0.53, answers, name)
    axes.text(
        left + _OFF_AT / 2, 1.01, style.words(cell), transform=axes.get_xaxis_transform(),
        ha="center", va="bottom", fontweight="bold",
    )  # fmt: skip


def participant_sign(*, filled: bool | None) -> Line2D:
    """Give what stands for a participant in a legend; `filled` only where there are hollow ones too."""
    words = {True: "participant, transition cost on", False: "… off", None: "participant"}
    return _sign(
        marker="o", linestyle="", markersize=3.4, color=style.FAINT, label=words[filled],
        markerfacecolor="white" if filled is False else style.FAINT,
    )  # fmt: skip


def mean_sign(axes: Axes) -> ErrorbarContainer:
    """Give what stands for a mean and its interval in a legend."""
    return axes.errorbar(
        [], [], yerr=[], fmt="o", color=style.INK, markersize=4.0, capsize=2.2, label="mean and 95 % interval"
    )


def _sign(**options: object) -> Line2D:
    from matplotlib.lines import Line2D

    return Line2D([], [], **options)  # type: ignore[arg-type]
