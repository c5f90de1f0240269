"""What was asked of the dances, and what they became."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.figures import style
from studykit.figures.samples import ORDER
from studykit.motion.body import DEFAULT_BODY_MASS_KG

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from studykit.choreography.dance import Dance, DanceBlock
    from studykit.figures.canvas import PaperFigure

_GOALS = {
    "linear_energy": "Linear energy",
    "rotational_energy": "Rotational energy",
    "variety": "Variety\n(mean feature distance)",
}
_KINDS = ("asked", "achieved", "shown")


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
    _require_dances(len(dances))
    names = [f"{cell}-{transition}" for cell in ORDER for transition in ("on", "off")]
    table = dances.set_index("condition", drop=False)
    table = table.loc[[name for name in names if name in table.index]]
    labels = [f"{style.words(name)}, {name.rsplit('-', maxsplit=1)[1]}" for name in table.index]
    with style.in_style():
        figure = _drawn(table, labels, body_mass_kg, "J")
        figure.axes[0].set_ylabel("Condition, transition cost")
    return figure


def targets_and_achieved(
    dances: Sequence[Dance], *, body_mass_kg: float = DEFAULT_BODY_MASS_KG
) -> PaperFigure:
    """Show what was asked of a few dances, and of their blocks, and what was found.

    Parameters
    ----------
    dances : sequence of Dance
        From top to bottom. A dance of several blocks has a row for each.
    body_mass_kg : float
        Energies are shown for this body mass: those of a dance or, where dances differ in length or have
        blocks, those of a second.

    Returns
    -------
    PaperFigure
        As `asked_and_achieved`, and beside each row by how much what is shown misses what was asked.

    Raises
    ------
    InputError
        If there is no dance.
    """
    _require_dances(len(dances))
    per_second = any(len(dance.blocks) > 1 for dance in dances)
    per_second |= len({dance.asked.duration_s for dance in dances}) > 1
    table = targets_table(dances, per_second=per_second)
    with style.in_style():
        figure = _drawn(table, list(table["label"]), body_mass_kg, "J/s" if per_second else "J")
        for axes, goal in zip(figure.axes, _GOALS, strict=True):
            _say_misses(axes, table[f"{goal}_asked"].to_numpy(), table[f"{goal}_shown"].to_numpy())
            _widen(axes)
            for row in np.flatnonzero(~table["is_block"].to_numpy())[1:]:
                axes.axhline(row - 0.5, color=style.GRID, linewidth=0.8, zorder=0)
        if table["is_block"].any():
            for text, is_block in zip(figure.axes[0].get_yticklabels(), table["is_block"], strict=True):
                text.set_fontweight("normal" if is_block else "bold")
    return figure


def targets_table(dances: Sequence[Dance], *, per_second: bool) -> pd.DataFrame:
    """Give one row for each dance, and below it one for each of its blocks where there are several.

    Returns
    -------
    DataFrame
        The columns of `asked_and_achieved`, `label` and `is_block`; energies in J per kg of the whole or,
        with `per_second`, of a second.
    """
    import pandas as pd

    rows = []
    for dance in dances:
        start_s = 0.0
        parts: list[tuple[str, Dance | DanceBlock]] = [(style.title(dance).replace(", ", ",\n"), dance)]
        for block in dance.blocks if len(dance.blocks) > 1 else ():
            end_s = start_s + block.asked.duration_s
            parts.append((f"{start_s:g}–{end_s:g} s", block))
            start_s = end_s
        for label, part in parts:
            kinds = zip(_KINDS, (part.asked, part.achieved, part.achieved_blended), strict=True)
            values = {
                f"{goal}_{kind}": getattr(measures, goal)
                / (measures.duration_s if per_second and goal != "variety" else 1.0)
                for kind, measures in kinds
                for goal in _GOALS
            }
            row = {"label": label, "condition": dance.condition, "is_synthetic": dance.is_synthetic}
            rows.append(row | {"is_block": part is not dance} | values)
    return pd.DataFrame(rows)


def _require_dances(count: int) -> None:
    if not count:
        raise InputError("there is no dance to show", where="dances", remedy="choreograph one first")


def _drawn(table: pd.DataFrame, labels: Sequence[str], body_mass_kg: float, unit: str) -> PaperFigure:
    lines = max(1 + label.count("\n") for label in labels)
    figure = style.sheet(
        width_mm=style.PAGE_MM,
        height_mm=31.5 + (1.8 + 3.4 * lines) * len(table),
        simulated=False,
        synthetic=bool(table["is_synthetic"].any()),
    )
    panels = figure.subplots(1, len(_GOALS), sharey=True)
    for axes, (goal, words) in zip(panels, _GOALS.items(), strict=True):
        is_energy = goal != "variety"
        _draw_goal(axes, table, goal, body_mass_kg if is_energy else 1.0)
        axes.set_xlabel(f"{words}\n({unit}, {body_mass_kg:g} kg)" if is_energy else words)
    panels[0].set_yticks(range(len(labels)), labels)
    panels[0].invert_yaxis()
    _explain(figure)
    return figure


def _say_misses(axes: Axes, asked: Floats, shown: Floats) -> None:
    for row, (target, value) in enumerate(zip(asked, shown, strict=True)):
        if target > 0.0:
            axes.text(
                1.02, row, f"{100.0 * (value / target - 1.0):+.1f} %".replace("-", "−"),
                transform=axes.get_yaxis_transform(), va="center", fontsize=6.5, gid="miss",
            )  # fmt: skip


def _widen(axes: Axes) -> None:
    """Show a tenth at least on both sides: misses of a single dance are not to fill the panel."""
    low, high = axes.get_xlim()
    middle = (low + high) / 2.0
    axes.set_xlim(min(low, 0.9 * middle), max(high, 1.1 * middle))
    axes.locator_params(axis="x", nbins=4)


def _draw_goal(axes: Axes, table: pd.DataFrame, goal: str, factor: float) -> None:
    rows = np.arange(len(table))
    style.rule(axes, at="x")
    asked, achieved, shown = (factor * table[f"{goal}_{kind}"].to_numpy(float) for kind in _KINDS)
    axes.vlines(asked, rows - 0.38, rows + 0.38, color=style.INK, linewidth=1.4, zorder=2, gid="asked")
    axes.scatter(
        shown, rows, s=26.0, facecolor="none", edgecolor=style.INK, linewidths=0.6, zorder=4, gid="shown"
    )
    for row, name in enumerate(table["condition"]):
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
