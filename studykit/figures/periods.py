"""Whether what people did changed in the course of a visit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from studykit.core.errors import InputError
from studykit.figures import style
from studykit.figures.outcomes import mean_sign, participant_sign
from studykit.figures.samples import beside_each_other, mean_interval

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from studykit.figures.canvas import PaperFigure


def outcomes_by_period(trials: pd.DataFrame, outcomes: Mapping[str, str]) -> PaperFigure:
    """Show every participant's values in the order in which they were measured.

    In a balanced design every condition is as frequent in each period, so a trend is one of time: practice,
    fatigue, or a heart that has not come to rest.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`.
    outcomes : mapping of str to str
        Columns, and what their axes say; a panel each, from left to right.

    Returns
    -------
    PaperFigure
        Points: participants. The line joins the means of the periods, with their 95 % intervals.

    Raises
    ------
    InputError
        If no valid trial has any of the outcomes.
    """
    kept = trials[trials["is_valid"].astype(bool)]
    shown = {name: words for name, words in outcomes.items() if kept[name].notna().any()}
    if not shown:
        raise InputError(
            f"no valid trial has a value of {', '.join(outcomes)}",
            where="trials",
            remedy="record at least one complete performance, then draw again",
        )
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM if len(shown) > 1 else style.COLUMN_MM,
            height_mm=68.0,
            simulated=bool(trials["simulated"].any()),
        )
        panels = figure.subplots(1, len(shown), squeeze=False, gridspec_kw={"wspace": 0.04})[0]
        for axes, (name, words) in zip(panels, shown.items(), strict=True):
            _draw_outcome(axes, kept[kept[name].notna()], name)
            axes.set(xlabel="Period (place in the visit)", ylabel=words)
        figure.legend(
            handles=[participant_sign(filled=None), mean_sign(panels[0])], loc="outside lower center", ncols=2
        )
    return figure


def _draw_outcome(axes: Axes, trials: pd.DataFrame, name: str) -> None:
    style.rule(axes)
    periods = sorted(int(period) for period in trials["period"].unique())
    intervals = []
    for period in periods:
        values = trials.loc[trials["period"] == period].sort_values("participant")[name].to_numpy(float)
        places = period - 0.1 + beside_each_other(values, half_width=0.22)
        axes.scatter(
            places, values, s=7.0, color=style.FAINT, alpha=0.6, linewidths=0.0, zorder=2,
            gid=f"participants {period}",
        )  # fmt: skip
        intervals.append(mean_interval(values))
    means = np.array([one.mean for one in intervals])
    reach = np.array([[one.mean - one.low, one.high - one.mean] for one in intervals]).T
    axes.errorbar(
        np.array(periods) + 0.28, means, yerr=reach, fmt="o", color=style.INK, markersize=4.0,
        elinewidth=1.0, capsize=2.0, linestyle="-", linewidth=0.7, zorder=4,
    )  # fmt: skip
    axes.set_xticks(periods)
    axes.set_xlim(periods[0] - 0.6, periods[-1] + 0.7)
    axes.tick_params(axis="x", length=0.0)
