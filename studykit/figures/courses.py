"""Curves of several conditions over the time of a dance, and the stretches in which they differ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from studykit.core.errors import InputError
from studykit.figures import style
from studykit.figures.time_curves import PeopleCurve, draw_people

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from studykit.figures.canvas import PaperFigure

_PANEL_MM, _FRAME_MM = 46.0, 14.0
_HATCH = "////"


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Course:
    """Conditions that were compared at every moment of their dances.

    Parameters
    ----------
    curves : mapping of str to PeopleCurve
        By condition; all of one measure.
    clusters : sequence of (float, float, float)
        Start and end, s, and corrected p of every stretch in which the conditions differ.
    """

    curves: Mapping[str, PeopleCurve]
    clusters: Sequence[tuple[float, float, float]] = ()


def compared_courses(
    courses: Sequence[Course], *, alpha: float = 0.05, simulated: bool = False
) -> PaperFigure:
    """Show how conditions run over the time of a dance, and when they differ.

    Parameters
    ----------
    courses : sequence of Course
        A panel each, from top to bottom.
    alpha : float
        A p below this is significant.
    simulated : bool
        Whether the people were simulated.

    Returns
    -------
    PaperFigure
        Means with their 95 % intervals: intensity is the colour; hard dances are dashed, those without
        transition cost thin. The bar below shows stretches of difference, hatched where p is not below alpha.

    Raises
    ------
    InputError
        If there is nothing to compare.
    """
    if not courses:
        raise InputError("there is nothing to compare", where="courses", remedy="declare [[analysis.curves]]")
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM, height_mm=_FRAME_MM + _PANEL_MM * len(courses), simulated=simulated
        )
        panels = figure.subplots(len(courses), 1, squeeze=False, sharex=True)[:, 0]
        for axes, course in zip(panels, courses, strict=True):
            _draw_course(axes, course, alpha)
        panels[-1].set_xlabel("Time in the dance (s)")
        figure.align_ylabels()
        _explain(figure, courses, alpha)
    return figure


def _look(condition: str) -> tuple[str, object, float]:
    """Give the colour, dashes and width of a condition's line."""
    dashes = (0, (5, 1.5)) if "hard" in condition.split("-") else "-"
    return style.colour(condition), dashes, 0.7 if condition.endswith("-off") else 1.3


def _draw_course(axes: Axes, course: Course, alpha: float) -> None:
    style.rule(axes)
    for condition, curve in course.curves.items():
        colour, dashes, width_pt = _look(condition)
        draw_people(axes, curve, colour)
        axes.lines[-1].set(linestyle=dashes, linewidth=width_pt)
        axes.collections[-1].set_alpha(0.14)  # bands of several conditions lie over each other
        axes.set_ylabel(curve.label)
    for start_s, stop_s, p in course.clusters:
        is_significant = p < alpha
        axes.axvspan(
            start_s, stop_s, ymin=0.0, ymax=0.045, facecolor=style.INK if is_significant else "white",
            edgecolor=style.INK, hatch=None if is_significant else _HATCH, linewidth=0.5, gid="cluster",
        )  # fmt: skip
        words = "p < .001" if p < 0.001 else f"p = {p:.3f}".replace("0.", ".", 1)
        axes.text(
            (start_s + stop_s) / 2.0, 0.06, words, transform=axes.get_xaxis_transform(), ha="center",
            va="bottom", fontsize=6.5, gid="p",
        )  # fmt: skip
    low, high = axes.get_ylim()
    axes.set_ylim(low - 0.16 * (high - low), high)  # room for the bar
    duration_s = max(float(curve.times_s[-1] + curve.times_s[0]) for curve in course.curves.values())
    axes.set_xlim(0.0, duration_s)
    axes.set_xticks(np.arange(0.0, duration_s + 0.1, 4.0 if duration_s <= 64.0 else 16.0))


def _explain(figure: PaperFigure, courses: Sequence[Course], alpha: float) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    conditions = dict.fromkeys(name for course in courses for name in course.curves)
    has_off = any(name.endswith("-off") for name in conditions)
    entries: list[Line2D | Patch] = []
    for name in conditions:
        colour, dashes, width_pt = _look(name)
        words = style.words(name) + (f", {name.rsplit('-', maxsplit=1)[1]}" if has_off else "")
        entries.append(Line2D([], [], color=colour, linestyle=dashes, linewidth=width_pt, label=words))  # type: ignore[arg-type]
    if any(course.clusters for course in courses):
        entries.append(Patch(facecolor=style.INK, label=f"differ, p < {alpha:g}"))
    if any(p >= alpha for course in courses for _, _, p in course.clusters):
        entries.append(
            Patch(facecolor="white", edgecolor=style.INK, hatch=_HATCH, linewidth=0.5, label=f"p ≥ {alpha:g}")
        )
    figure.legend(
        handles=entries, loc="outside lower center", ncols=min(len(entries), 6), handlelength=2.4,
        columnspacing=1.2,
    )  # fmt: skip
