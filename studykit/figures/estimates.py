"""Estimates with their intervals, one a row: pairs of conditions, or defensible choices of an analysis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from studykit.core.errors import InputError
from studykit.figures import style

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from studykit.figures.canvas import PaperFigure

_COLUMNS = ("outcome", "estimate", "low", "high", "p")
_ROW_MM, _PANEL_MM, _FRAME_MM = 4.6, 14.0, 13.0


def forest(pairs: pd.DataFrame, *, alpha: float = 0.05, simulated: bool = False) -> PaperFigure:
    """Show by how much pairs of conditions differ, in the unit of each outcome.

    Parameters
    ----------
    pairs : DataFrame
        One row a pair: `outcome` (words with the unit; a panel each), `a`, `b` (conditions), `estimate` (the
        Hodges-Lehmann shift of a - b), `low`, `high` (its interval) and `p` (corrected).
    alpha : float
        A p below this is significant.
    simulated : bool
        Whether the people were simulated.

    Raises
    ------
    InputError
        If a column is missing, or there is no pair.
    """
    _require(pairs, ("a", "b", *_COLUMNS), "pairs")
    labels = [f"{_condition(a)}  −  {_condition(b)}" for a, b in zip(pairs["a"], pairs["b"], strict=True)]
    return _rows(pairs.assign(label=labels), alpha=alpha, simulated=simulated)


def sensitivity(table: pd.DataFrame, *, alpha: float = 0.05, simulated: bool = False) -> PaperFigure:
    """Show what comes out if the analysis is done in other defensible ways.

    Parameters
    ----------
    table : DataFrame
        One row a choice: `choice` (words), `outcome` (words with the unit; a panel each), `estimate`, `low`,
        `high`, `p`. The first choice of an outcome is the declared one; a dashed line marks its estimate.
    alpha : float
        A p below this is significant.
    simulated : bool
        Whether the people were simulated.

    Raises
    ------
    InputError
        If a column is missing, or there is no choice.
    """
    _require(table, ("choice", *_COLUMNS), "sensitivity")
    return _rows(table.assign(label=table["choice"]), alpha=alpha, simulated=simulated, has_reference=True)


def _require(table: pd.DataFrame, columns: Sequence[str], where: str) -> None:
    missing = [column for column in columns if column not in table.columns]
    if missing or table.empty:
        problem = f'there is no column "{missing[0]}"' if missing else "there is no row"
        raise InputError(problem, where=where, remedy=f"give {', '.join(columns)}")


def _condition(name: str) -> str:
    """Give a condition in words, with its transition where its name has one."""
    parts = name.split("-")
    return style.words(name) + (f", {parts[2]}" if len(parts) > 2 else "")


def _rows(table: pd.DataFrame, *, alpha: float, simulated: bool, has_reference: bool = False) -> PaperFigure:
    outcomes = list(dict.fromkeys(table["outcome"]))
    counts = [int((table["outcome"] == outcome).sum()) for outcome in outcomes]
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM,
            height_mm=_FRAME_MM + sum(_PANEL_MM + _ROW_MM * count for count in counts),
            simulated=simulated,
        )
        panels = figure.subplots(
            len(outcomes), 1, squeeze=False, height_ratios=[count + 0.6 for count in counts]
        )
        for axes, outcome in zip(panels[:, 0], outcomes, strict=True):
            _draw_panel(axes, table[table["outcome"] == outcome], alpha, has_reference=has_reference)
            axes.set_xlabel(outcome)
        _explain(figure, alpha, has_reference=has_reference)
    return figure


def _draw_panel(axes: Axes, rows: pd.DataFrame, alpha: float, *, has_reference: bool) -> None:
    places = np.arange(len(rows))
    style.rule(axes, at="x")
    axes.axvline(0.0, color=style.INK, linewidth=0.7, zorder=1)
    estimates, ps = rows["estimate"].to_numpy(float), rows["p"].to_numpy(float)
    if has_reference:
        axes.axvline(estimates[0], color=style.INTENSITY["light"], linewidth=0.9, linestyle=(0, (4, 1.5)))
    is_significant = ps < alpha
    axes.hlines(places, rows["low"], rows["high"], color=style.INK, linewidth=1.1, gid="intervals", zorder=2)
    for which, face in ((is_significant, style.INK), (~is_significant, "white")):
        axes.scatter(
            estimates[which], places[which], s=20.0, marker="s", facecolor=face, edgecolor=style.INK,
            linewidths=0.9, zorder=3, gid="estimates",
        )  # fmt: skip
    numbers = rows[["estimate", "low", "high", "p"]].to_numpy(float)
    largest = float(np.nanmax(np.abs(numbers[:, :3]), initial=1e-9))
    decimals = max(0, 2 - int(np.floor(np.log10(largest))))  # three digits of the largest
    for place, (estimate, low, high, p) in enumerate(numbers):
        told = [f"{value:.{decimals}f}" for value in (estimate, low, high)]
        words = f"{told[0]} [{told[1]}, {told[2]}]   {_p_words(p)}"
        axes.text(
            1.015, place, words.replace("-", "−"), transform=axes.get_yaxis_transform(), va="center",
            fontsize=6.5, gid="p",
        )  # fmt: skip
    axes.set_yticks(places, list(rows["label"]), fontsize=7.0)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0.0)
    axes.margins(x=0.06)


def _p_words(p: float) -> str:
    if not np.isfinite(p):
        return ""
    return "p < .001" if p < 0.001 else f"p = {p:.3f}".replace("0.", ".", 1)


def _explain(figure: PaperFigure, alpha: float, *, has_reference: bool) -> None:
    from matplotlib.lines import Line2D

    entries = [
        Line2D(
            [], [], color=style.INK, marker="s", markersize=4.0, markerfacecolor=face, linewidth=1.1,
            label=words,
        )
        for face, words in ((style.INK, f"p < {alpha:g}"), ("white", f"p ≥ {alpha:g}"))
    ]  # fmt: skip
    if has_reference:
        entries.append(
            Line2D(
                [], [], color=style.INTENSITY["light"], linewidth=0.9, linestyle=(0, (4, 1.5)),
                label="the declared analysis",
            )
        )  # fmt: skip
    figure.legend(handles=entries, loc="outside lower center", ncols=len(entries))
