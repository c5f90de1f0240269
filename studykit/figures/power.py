"""How likely a study of some size finds what is there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from studykit.core.errors import InputError
from studykit.figures import style

if TYPE_CHECKING:
    import pandas as pd

    from studykit.figures.canvas import PaperFigure

_COLUMNS = ("participants", "power", "low", "high")


def power_curve(table: pd.DataFrame, *, wanted: Sequence[float] = (0.8, 0.9)) -> PaperFigure:
    """Show the power of a study over its number of participants.

    Parameters
    ----------
    table : DataFrame
        One row a size: `participants`, `power` (0 to 1), `low`, `high` (its interval, from the number of
        simulated studies) and, if there are several, `test` (words; a line each).
    wanted : sequence of float
        Levels that are marked.

    Returns
    -------
    PaperFigure
        Each test has a colour, a marker and dashes of its own.

    Raises
    ------
    InputError
        If a column is missing, or there is no row.
    """
    missing = [column for column in _COLUMNS if column not in table.columns]
    if missing or table.empty:
        problem = f'there is no column "{missing[0]}"' if missing else "there is no row"
        raise InputError(problem, where="power", remedy=f"give {', '.join(_COLUMNS)}")
    tests = list(dict.fromkeys(table["test"])) if "test" in table.columns else [""]
    with style.in_style():
        figure = style.sheet(width_mm=style.COLUMN_MM, height_mm=72.0, simulated=True)
        axes = figure.add_subplot()
        style.rule(axes)
        for level in wanted:
            axes.axhline(100.0 * level, color=style.FAINT, linewidth=0.8, linestyle=(0, (1, 1.5)), zorder=1)
        for test, (colour, marker, dashes) in zip(tests, style.SERIES * len(tests), strict=False):
            rows = (table[table["test"] == test] if test else table).sort_values("participants")
            people = rows["participants"].to_numpy(float)
            low, middle, high = (100.0 * rows[name].to_numpy(float) for name in ("low", "power", "high"))
            axes.fill_between(people, low, high, color=colour, alpha=0.18, linewidth=0.0)
            axes.plot(
                people, middle, color=colour, marker=marker, markersize=3.6, linestyle=dashes, linewidth=1.0,
                label=test, gid="power",
            )  # fmt: skip
        axes.set(xlabel="Participants", ylabel="Power (%)", ylim=(0.0, 102.0))
        axes.set_yticks(range(0, 101, 20))
        axes.locator_params(axis="x", integer=True)
        axes.margins(x=0.04)
        if tests != [""]:
            figure.legend(loc="outside lower center", ncols=min(len(tests), 2), handlelength=2.6)
    return figure
