"""How what the dances ask goes together with what people do, within each person."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from studykit.core.arrays import Floats
from studykit.figures import style
from studykit.figures.outcomes import draw_mean, draw_participants, mean_sign
from studykit.figures.samples import ORDER, beside_each_other, valid_trials
from studykit.motion.body import DEFAULT_BODY_MASS_KG

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from studykit.figures.canvas import PaperFigure


def heart_rate_against_energy(
    trials: pd.DataFrame, *, body_mass_kg: float = DEFAULT_BODY_MASS_KG
) -> PaperFigure:
    """Show how heart rate follows the energy of a dance, within each participant.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`.
    body_mass_kg : float
        Energies are stored per mass; they are shown for this body mass.

    Raises
    ------
    InputError
        If no valid trial of the conditions with transition cost has all numbers.
    """
    columns = ["linear_energy_asked", "rotational_energy_asked", "heart_rate_mean_bpm"]
    kept = valid_trials(trials, columns, transition="on")
    energy = body_mass_kg * (kept["linear_energy_asked"] + kept["rotational_energy_asked"])
    table = kept.assign(x=energy, y=kept["heart_rate_mean_bpm"])
    return _within_participants(
        table,
        f"Linear + rotational energy of the dance (J, {body_mass_kg:g} kg)",
        "Mean heart rate (beats/min)",
    )


def movement_against_variety(trials: pd.DataFrame) -> PaperFigure:
    """Show how movement distance follows the variety of a dance, within each participant.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`.

    Raises
    ------
    InputError
        If no valid trial of the conditions with transition cost has both numbers.
    """
    kept = valid_trials(trials, ["variety_achieved", "dtw_m"], transition="on")
    table = kept.assign(x=kept["variety_achieved"], y=kept["dtw_m"])
    return _within_participants(
        table, "Variety of the dance (mean feature distance)", "Movement (DTW) distance (m)"
    )


def _within_participants(table: pd.DataFrame, x_label: str, y_label: str) -> PaperFigure:
    places = _places(table)
    half_width = 0.012 * (np.ptp(list(places.values())) or 1.0)
    with style.in_style():
        figure = style.sheet(
            width_mm=style.COLUMN_MM, height_mm=82.0, simulated=bool(table["simulated"].any())
        )
        axes = figure.add_subplot()
        style.rule(axes)
        slope = _common_slope(table)
        for _, one in table.groupby("participant"):
            _draw_common_slope(axes, one, slope)
        for condition, place in places.items():
            values = table.loc[table["condition"] == condition, "y"].to_numpy(float)
            shifts = beside_each_other(values, half_width=half_width)
            draw_participants(axes, place + shifts, values, condition)
            draw_mean(axes, place + 2.3 * half_width, values, condition)
        axes.set(xlabel=x_label, ylabel=y_label)
        axes.margins(x=0.06)
        _explain(figure, list(places))
    return figure


def _places(table: pd.DataFrame) -> dict[str, float]:
    """Give each condition its place across; those that would cover each other move a little apart."""
    means = table.groupby("condition")["x"].mean()
    known = [f"{cell}-on" for cell in ORDER if f"{cell}-on" in means.index]
    apart = 0.08 * (float(np.ptp(means.to_numpy())) or 1.0)
    places: dict[str, float] = {}
    for name in known:
        near = [other for other in known if abs(means[other] - means[name]) < apart]
        middle = float(np.mean([means[other] for other in near]))
        places[name] = middle + apart * (near.index(name) - (len(near) - 1) / 2.0)
    return places


def _common_slope(table: pd.DataFrame) -> float:
    """Give the one slope that fits all participants best, each with an intercept of their own."""
    centred = table[["x", "y"]] - table.groupby("participant")[["x", "y"]].transform("mean")
    squares = float((centred["x"] ** 2).sum())
    return float((centred["x"] * centred["y"]).sum()) / squares if squares else 0.0


def _draw_common_slope(axes: Axes, one: pd.DataFrame, slope: float) -> None:
    ends: Floats = np.array([one["x"].min(), one["x"].max()])
    line = one["y"].mean() + slope * (ends - one["x"].mean())
    axes.plot(ends, line, color=style.FAINT, linewidth=0.5, alpha=0.5, zorder=1)


def _explain(figure: Figure, conditions: list[str]) -> None:
    from matplotlib.lines import Line2D

    entries = [
        Line2D(
            [], [], linestyle="", marker=style.marker(name), color=style.colour(name), markersize=4.5,
            label=style.words(name),
        )
        for name in conditions
    ]  # fmt: skip
    entries.append(Line2D([], [], color=style.FAINT, linewidth=0.7, label="participant, common slope"))
    figure.legend(
        handles=[*entries, mean_sign(figure.axes[0])],
        loc="outside lower center",
        ncols=3,
        columnspacing=1.2,
        handlelength=1.4,
    )
