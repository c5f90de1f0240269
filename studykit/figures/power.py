"""How likely a study of some size finds what is there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.core.errors import InputError
from studykit.figures import style

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from studykit.figures.canvas import PaperFigure

_COLUMNS = ("test", "participants", "power", "low", "high")
_PAIR = " - "
_PAIR_WORDS = "single pairs"


def power_curve(table: pd.DataFrame, *, wanted: Sequence[float] = (0.8, 0.9)) -> PaperFigure:
    """Show the power of a study over its number of participants.

    Parameters
    ----------
    table : DataFrame
        One row a test and size: `test` (a panel each), `participants`, `power` (0 to 1), `low` and `high`
        (its interval, from the number of simulated studies) and, if a test answers several, `question` (a
        line each; single pairs, such as "a - b", are thin).
    wanted : sequence of float
        Levels that are marked.

    Returns
    -------
    PaperFigure
        Each question has a colour, a marker and dashes of its own.

    Raises
    ------
    InputError
        If a column is missing, or there is no row.
    """
    missing = [column for column in _COLUMNS if column not in table.columns]
    if missing or table.empty:
        problem = f'there is no column "{missing[0]}"' if missing else "there is no row"
        raise InputError(problem, where="power", remedy=f"give {', '.join(_COLUMNS)}")
    rows = table if "question" in table.columns else table.assign(question="")
    tests = list(dict.fromkeys(rows["test"]))
    named = [question for question in dict.fromkeys(rows["question"]) if _PAIR not in question]
    looks = dict(zip(named, style.SERIES * len(named), strict=False))
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM if len(tests) > 1 else style.COLUMN_MM, height_mm=70.0, simulated=True
        )
        panels = figure.subplots(1, len(tests), sharey=True, squeeze=False)[0]
        for axes, test in zip(panels, tests, strict=True):
            _draw_test(axes, rows[rows["test"] == test], looks, wanted)
            axes.set_title(str(test).replace("_", " ").capitalize(), fontweight="bold")
        panels[0].set_ylabel("Power (%)")
        labels: dict[str, Any] = {}
        for axes in panels:
            labels |= {str(line.get_label()): line for line in axes.lines if line.get_gid() == "power"}
        labels = {words: line for words, line in labels.items() if not words.startswith("_")}  # unnamed
        if labels:
            figure.legend(
                list(labels.values()), list(labels), loc="outside lower center", ncols=3, handlelength=2.6
            )
    return figure


def _draw_test(
    axes: Axes, rows: pd.DataFrame, looks: dict[str, tuple[str, str, Any]], wanted: Sequence[float]
) -> None:
    style.rule(axes)
    for level in wanted:
        axes.axhline(100.0 * level, color=style.FAINT, linewidth=0.8, linestyle=(0, (1, 1.5)), zorder=1)
    for question, some in rows.groupby("question", sort=False):
        values = some.sort_values("participants")[list(_COLUMNS[1:])].to_numpy(float)
        people, (middle, low, high) = values[:, 0], 100.0 * values[:, 1:].T
        if str(question) not in looks:
            axes.plot(
                people, middle, color=style.FAINT, linewidth=0.6, label=_PAIR_WORDS, gid="power", zorder=2
            )
            continue
        colour, marker, dashes = looks[str(question)]
        axes.fill_between(people, low, high, color=colour, alpha=0.18, linewidth=0.0)
        axes.plot(
            people, middle, color=colour, marker=marker, markersize=3.6, linestyle=dashes, linewidth=1.0,
            label=str(question), gid="power", zorder=3,
        )  # fmt: skip
    axes.set(xlabel="Participants", ylim=(0.0, 102.0), yticks=np.arange(0.0, 101.0, 20.0))
    axes.locator_params(axis="x", integer=True)
    axes.margins(x=0.04)
