"""What was asked of the dances, what they became, and what it did to those who danced them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.figures import style
from studykit.figures.outcomes import WITH_TRANSITION
from studykit.figures.samples import ORDER

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_GOALS = (
    ("linear_energy", "Linear energy (J)", True),
    ("rotational_energy", "Rotational energy (J)", True),
    ("variety", "Variety", False),
)
BODY_MASS_KG = 73.5
"""The body mass with which energies are shown when no other is given."""


def heart_rate_against_energy(trials: pd.DataFrame, *, body_mass_kg: float = BODY_MASS_KG) -> Figure:
    """Show how heart rate follows the energy asked of a dance, within each participant.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`.
    body_mass_kg : float
        Energies are stored per mass fraction; they are shown for this body mass.

    Raises
    ------
    InputError
        If fewer than two valid trials of the conditions with transition cost have both numbers.
    """
    energy = body_mass_kg * (trials["linear_energy_asked"] + trials["rotational_energy_asked"])
    table = trials.assign(x=energy, y=trials["heart_rate_mean_bpm"])
    return _within_participants(table, "Linear + rotational energy asked (J)", "Mean heart rate (beats/min)")


def movement_against_variety(trials: pd.DataFrame) -> Figure:
    """Show how movement distance follows the variety of a dance, within each participant.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`.

    Raises
    ------
    InputError
        If fewer than two valid trials of the conditions with transition cost have both numbers.
    """
    table = trials.assign(x=trials["variety_achieved"], y=trials["dtw_m"])
    return _within_participants(table, "Variety achieved", "Movement (DTW) distance (m)")


def asked_and_achieved(dances: pd.DataFrame, *, body_mass_kg: float = BODY_MASS_KG) -> Figure:
    """Show how closely each dance met its goals.

    Parameters
    ----------
    dances : DataFrame
        One row a dance: `condition`, `simulated` and, for linear_energy, rotational_energy and variety,
        the columns `..._asked` and `..._achieved`; energies per mass fraction.
    body_mass_kg : float
        Energies are shown for this body mass.
    """
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM, height_mm=66.0, simulated=bool(dances["simulated"].any())
        )
        panels = figure.subplots(1, len(_GOALS))
        for axes, (goal, words, is_energy) in zip(panels, _GOALS, strict=True):
            _draw_goal(axes, dances, goal, body_mass_kg if is_energy else 1.0)
            axes.set_title(words)
            axes.set_xlabel("Asked")
        panels[0].set_ylabel("Achieved")
        _explain_conditions(figure)
    return figure


def _draw_goal(axes: Axes, dances: pd.DataFrame, goal: str, factor: float) -> None:
    asked = factor * dances[f"{goal}_asked"].to_numpy(float)
    achieved = factor * dances[f"{goal}_achieved"].to_numpy(float)
    everything = np.concatenate((asked, achieved))
    margin = 0.12 * (np.ptp(everything) or 1.0)
    ends = (everything.min() - margin, everything.max() + margin)
    style.rule(axes)
    axes.plot(ends, ends, color=style.FAINT, linewidth=0.8, linestyle=(0, (4, 3)), zorder=1)
    for condition, x, y in zip(dances["condition"], asked, achieved, strict=True):
        intensity, variety, transition = str(condition).split("-")
        colour = style.INTENSITY[intensity]
        axes.plot(
            x,
            y,
            marker=style.MARKERS[variety],
            color=colour,
            markerfacecolor=colour if transition == "on" else "white",
            markersize=6.0,
            linestyle="",
            gid=f"dance {condition}",
        )
    axes.set(xlim=ends, ylim=ends)
    axes.set_box_aspect(1.0)


def _within_participants(table: pd.DataFrame, x_label: str, y_label: str) -> Figure:
    kept = table[table["is_valid"].astype(bool) & table["condition"].isin(WITH_TRANSITION)]
    kept = kept[kept["x"].notna() & kept["y"].notna()]
    if len(kept) < 2:
        raise InputError(
            f"fewer than two valid trials have both {x_label} and {y_label}",
            where="trials",
            remedy="record more performances of the conditions with transition cost, then draw again",
        )
    with style.in_style():
        figure = style.sheet(
            width_mm=style.COLUMN_MM, height_mm=78.0, simulated=bool(table["simulated"].any())
        )
        axes = figure.add_subplot()
        style.rule(axes)
        for _, one in kept.groupby("participant"):
            _draw_common_slope(axes, one, _common_slope(kept))
        for condition in WITH_TRANSITION:
            some = kept[kept["condition"] == condition]
            if not some.empty:
                _draw_condition(axes, some, condition)
        axes.set(xlabel=x_label, ylabel=y_label)
        _explain_conditions(figure, with_transition_only=True)
    return figure


def _common_slope(kept: pd.DataFrame) -> float:
    """Give the one slope that fits all participants best, each with an intercept of their own."""
    centred = kept[["x", "y"]] - kept.groupby("participant")[["x", "y"]].transform("mean")
    squares = float((centred["x"] ** 2).sum())
    return float((centred["x"] * centred["y"]).sum()) / squares if squares else 0.0


def _draw_common_slope(axes: Axes, one: pd.DataFrame, slope: float) -> None:
    ends: Floats = np.array([one["x"].min(), one["x"].max()])
    line = one["y"].mean() + slope * (ends - one["x"].mean())
    axes.plot(ends, line, color=style.FAINT, linewidth=0.5, alpha=0.5, zorder=1)


def _draw_condition(axes: Axes, some: pd.DataFrame, condition: str) -> None:
    intensity, variety, *_ = condition.split("-")
    colour, marker = style.INTENSITY[intensity], style.MARKERS[variety]
    axes.scatter(
        some["x"],
        some["y"],
        s=11.0,
        marker=marker,
        color=colour,
        alpha=0.5,
        linewidths=0.0,
        gid=f"participants {condition}",
        zorder=2,
    )
    axes.plot(
        some["x"].mean(),
        some["y"].mean(),
        marker=marker,
        markersize=7.0,
        color=style.INK,
        markerfacecolor=colour,
        zorder=3,
    )


def _explain_conditions(figure: Figure, *, with_transition_only: bool = False) -> None:
    from matplotlib.lines import Line2D

    names = [f"{cell}-{on}" for cell in ORDER for on in (("on",) if with_transition_only else ("on", "off"))]
    entries = []
    for name in names:
        intensity, variety, transition = name.split("-")
        words = f"{intensity.capitalize()} – {variety.capitalize()}"
        if not with_transition_only:
            words += f", transition {transition}"
        colour = style.INTENSITY[intensity]
        entries.append(
            Line2D(
                [], [], linestyle="", marker=style.MARKERS[variety], color=colour, label=words,
                markersize=4.5, markerfacecolor=colour if transition == "on" else "white",
            )
        )  # fmt: skip
    figure.legend(handles=entries, loc="outside lower center", ncols=2 if with_transition_only else 4)
