"""What was asked of the dances, and what they became."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from studykit.core.errors import InputError
from studykit.figures import style
from studykit.figures.samples import ORDER
from studykit.motion.body import DEFAULT_BODY_MASS_KG

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from studykit.figures.canvas import PaperFigure

_ENERGIES = (("linear_energy", "Linear energy"), ("rotational_energy", "Rotational energy"))


def asked_and_achieved(dances: pd.DataFrame, *, body_mass_kg: float = DEFAULT_BODY_MASS_KG) -> PaperFigure:
    """Show how closely each dance met its goals.

    Parameters
    ----------
    dances : DataFrame
        One row a dance: `condition`, `is_synthetic` and, for linear_energy, rotational_energy and variety,
        the columns `..._asked`, `..._achieved` (within its segments) and `..._shown` (joins included);
        energies in J per kg.
    body_mass_kg : float
        Energies are shown for this body mass.

    Raises
    ------
    InputError
        If there is no dance.
    """
    if dances.empty:
        raise InputError("there is no dance to show", where="dances", remedy="choreograph one first")
    names = [f"{cell}-{transition}" for cell in ORDER for transition in ("on", "off")]
    table = dances.set_index("condition")
    table = table.loc[[name for name in names if name in table.index]]
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM,
            height_mm=28.0 + 5.2 * len(table),
            simulated=False,
            synthetic=bool(dances["is_synthetic"].any()),
        )
        panels = figure.subplots(1, len(_ENERGIES) + 1, sharey=True)
        for axes, (goal, words) in zip(panels, _ENERGIES, strict=False):
            _draw_goal(axes, table, goal, body_mass_kg)
            axes.set_xlabel(f"{words} (J, {body_mass_kg:g} kg)")
        _draw_goal(panels[-1], table, "variety", 1.0)
        panels[-1].set_xlabel("Variety (mean feature distance)")
        labels = [f"{style.words(name)}, {name.rsplit('-', maxsplit=1)[1]}" for name in table.index]
        panels[0].set_yticks(range(len(labels)), labels)
        panels[0].set_ylabel("Condition, transition cost")
        panels[0].invert_yaxis()
        _explain(figure)
    return figure


def _draw_goal(axes: Axes, table: pd.DataFrame, goal: str, factor: float) -> None:
    rows = np.arange(len(table))
    style.rule(axes, at="x")
    asked, achieved, shown = (
        factor * table[f"{goal}_{kind}"].to_numpy(float) for kind in ("asked", "achieved", "shown")
    )
    axes.vlines(asked, rows - 0.38, rows + 0.38, color=style.INK, linewidth=1.4, zorder=2)
    axes.scatter(shown, rows, s=26.0, facecolor="none", edgecolor=style.INK, linewidths=0.6, zorder=4)
    for row, name in enumerate(table.index):
        axes.scatter(
            achieved[row],
            row,
            s=13.0,
            color=style.colour(name),
            linewidths=0.0,
            zorder=3,
            gid=f"dance {name}",
        )
    axes.tick_params(axis="y", length=0.0)
    axes.margins(x=0.08)


def _explain(figure: Figure) -> None:
    from matplotlib.lines import Line2D

    entries = [
        Line2D(
            [], [], linestyle="", marker="|", color=style.INK, markersize=7.0, markeredgewidth=1.4,
            label="asked",
        ),
        Line2D(
            [], [], linestyle="", marker="o", color=style.FAINT, markersize=3.6,
            label="achieved within segments",
        ),
        Line2D(
            [], [], linestyle="", marker="o", color=style.INK, markerfacecolor="none", markersize=5.1,
            markeredgewidth=0.6, label="shown, joins included",
        ),
    ]  # fmt: skip
    figure.legend(handles=entries, loc="outside lower center", ncols=3)
