"""The whole framework as boxes and arrows, laid out from a list of its stages (Figure 2)."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.figures import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from studykit.figures.canvas import PaperFigure

# Millimetres of the drawing.
_LEFT, _RIGHT, _BETWEEN, _LINE, _PAD = 8.0, 1.5, 6.5, 3.1, 3.0
_STACK_GAP, _LANE_GAP, _EDGE = 3.0, 13.0, 4.5
_ASIDE = 3.0  # arrows that end at the top of a box keep so far from its middle


@dataclass(frozen=True, kw_only=True, slots=True)
class Stage:
    """One box of the framework.

    Parameters
    ----------
    name : str
        What other stages call it.
    words : str
        What is written in its box, lines divided as they are.
    lane : str
        Which part of the framework it belongs to.
    module : str
        Where in the program it is done.
    after : tuple of str
        The stages whose result it takes.
    again : str
        The earlier stage to which it sends back, if it ends a loop.
    """

    name: str
    words: str
    lane: str
    module: str
    after: tuple[str, ...] = ()
    again: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class Box:
    """Where a stage stands: its column, its middle and its height, mm."""

    column: int
    x: float
    y: float
    height: float


def framework(stages: Sequence[Stage]) -> PaperFigure:
    """Show how takes become dances and dances become results (Figure 2).

    Parameters
    ----------
    stages : sequence of Stage
        A graph without cycles, but for `again`.

    Returns
    -------
    PaperFigure
        A row a lane, in the order in which lanes are first named; a box a stage, as far to the right as the
        longest way to it within its lane. Arrows: what a stage takes; dashed: back to an earlier one.

    Raises
    ------
    InputError
        If there is no stage, or one takes the result of a stage that does not exist or waits for itself.
    """
    columns = stage_columns(stages)
    count = max(columns.values()) + 1
    width_mm = (style.PAGE_MM - _LEFT - _RIGHT - (count - 1) * _BETWEEN) / count
    boxes, height_mm = _boxes(stages, columns, width_mm)
    with style.in_style():
        figure = style.sheet(width_mm=style.PAGE_MM, height_mm=height_mm, simulated=False)
        figure.set_layout_engine(None)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set(xlim=(0.0, style.PAGE_MM), ylim=(0.0, height_mm))
        axes.set_axis_off()
        _draw_lanes(axes, stages, boxes)
        for stage in stages:
            for source in stage.after:
                _draw_arrow(
                    axes, _way(boxes, source, stage, stages, width_mm), gid=f"{source} to {stage.name}"
                )
            if stage.again:
                _draw_arrow(
                    axes, _way_back(boxes, stage, stages), linestyle=(0, (3, 1.5)),
                    gid=f"{stage.name} back to {stage.again}",
                )  # fmt: skip
        for stage in stages:
            _draw_box(axes, stage, boxes[stage.name], width_mm, _tint(stages, stage.lane))
    return figure


def stage_columns(stages: Sequence[Stage]) -> dict[str, int]:
    """Give each stage its column: how many stages of its lane come before it at least, one after the other.

    Raises
    ------
    InputError
        If there is no stage, or one takes the result of a stage that does not exist or waits for itself.
    """
    known = {stage.name: stage for stage in stages}
    for stage in stages:
        for source in (*stage.after, *filter(None, [stage.again])):
            if source not in known:
                raise InputError(f'there is no stage "{source}"', where=stage.name, remedy="name one that is")
    columns: dict[str, int] = {}
    waiting = list(stages)
    while waiting:
        ready = [stage for stage in waiting if all(source in columns for source in stage.after)]
        if not ready:
            raise InputError("the stage waits for itself", where=waiting[0].name, remedy="break the cycle")
        for stage in ready:
            before = [columns[one] for one in stage.after if known[one].lane == stage.lane]
            columns[stage.name] = max(before, default=-1) + 1
        waiting = [stage for stage in waiting if stage not in ready]
    if not columns:
        raise InputError("there is no stage", where="figure 2", remedy="give at least one")
    return columns


def _lanes(stages: Sequence[Stage]) -> list[str]:
    return list(dict.fromkeys(stage.lane for stage in stages))


def _tint(stages: Sequence[Stage], lane: str) -> str:
    return style.TINTS[_lanes(stages).index(lane) % len(style.TINTS)]


def _boxes(
    stages: Sequence[Stage], columns: Mapping[str, int], width_mm: float
) -> tuple[dict[str, Box], float]:
    """Stack the boxes of each column of a lane around its middle; give them and the height of the sheet."""
    heights = {stage.name: _PAD + _LINE * (1 + stage.words.count("\n")) for stage in stages}
    stacks: dict[tuple[str, int], list[str]] = defaultdict(list)
    for stage in stages:
        stacks[stage.lane, columns[stage.name]].append(stage.name)
    tall = {
        place: sum(heights[name] for name in names) + _STACK_GAP * (len(names) - 1)
        for place, names in stacks.items()
    }
    lanes = _lanes(stages)
    lane_mm = [max(mm for (lane, _), mm in tall.items() if lane == one) for one in lanes]
    total = sum(lane_mm) + _LANE_GAP * (len(lanes) - 1) + 2.0 * _EDGE
    boxes = {}
    for (lane, column), names in stacks.items():
        number = lanes.index(lane)
        middle = total - _EDGE - sum(lane_mm[:number]) - _LANE_GAP * number - lane_mm[number] / 2.0
        top = middle + tall[lane, column] / 2.0
        for name in names:
            boxes[name] = Box(
                column=column,
                x=_LEFT + column * (width_mm + _BETWEEN) + width_mm / 2.0,
                y=top - heights[name] / 2.0,
                height=heights[name],
            )
            top -= heights[name] + _STACK_GAP
    return boxes, total


def _lane_edge(boxes: Mapping[str, Box], stages: Sequence[Stage], lane: str, side: float) -> float:
    ends = [
        boxes[stage.name].y + side * boxes[stage.name].height / 2.0 for stage in stages if stage.lane == lane
    ]
    return side * max(side * end for end in ends)


def _way(
    boxes: Mapping[str, Box], source: str, stage: Stage, stages: Sequence[Stage], width_mm: float
) -> Floats:
    """Give the corners of an arrow: sideways within a lane, through the gap above the lane between lanes."""
    start, end = boxes[source], boxes[stage.name]
    lanes = {one.name: one.lane for one in stages}
    if lanes[source] == stage.lane:
        left = end.x - width_mm / 2.0
        bend = left - _BETWEEN / 2.0
        return np.array([[start.x + width_mm / 2.0, start.y], [bend, start.y], [bend, end.y], [left, end.y]])
    gap = _lane_edge(boxes, stages, stage.lane, 1.0) + _LANE_GAP / 2.0
    x = end.x - _ASIDE
    return np.array(
        [[start.x, start.y - start.height / 2.0], [start.x, gap], [x, gap], [x, end.y + end.height / 2.0]]
    )


def _way_back(boxes: Mapping[str, Box], stage: Stage, stages: Sequence[Stage]) -> Floats:
    start, end = boxes[stage.name], boxes[stage.again]
    above = _lane_edge(boxes, stages, stage.lane, 1.0) + _LANE_GAP / 5.0
    x = end.x + _ASIDE
    return np.array(
        [[start.x, start.y + start.height / 2.0], [start.x, above], [x, above], [x, end.y + end.height / 2.0]]
    )


def _draw_arrow(axes: Axes, way: Floats, **look: Any) -> None:
    from matplotlib.patches import Polygon

    axes.plot(*way.T, color=style.INK, linewidth=0.8, solid_joinstyle="round", zorder=1, **look)
    leg = way[-1] - way[-2]
    along = leg / (np.linalg.norm(leg) or 1.0)
    across = np.array([-along[1], along[0]])
    tip, base = way[-1], way[-1] - 2.0 * along
    axes.add_patch(Polygon([tip, base + 0.8 * across, base - 0.8 * across], color=style.INK, linewidth=0.0))


def _draw_lanes(axes: Axes, stages: Sequence[Stage], boxes: Mapping[str, Box]) -> None:
    from matplotlib.patches import Rectangle

    for lane in _lanes(stages):
        bottom, top = (_lane_edge(boxes, stages, lane, side) + side * 2.2 for side in (-1.0, 1.0))
        axes.add_patch(
            Rectangle(
                (0.6, bottom), style.PAGE_MM - 1.2, top - bottom, facecolor=_tint(stages, lane), alpha=0.25,
                linewidth=0.0, zorder=0,
            )
        )  # fmt: skip
        axes.text(
            3.6, (bottom + top) / 2.0, lane, rotation=90.0, ha="center", va="center", fontweight="bold",
            fontsize=7.5,
        )  # fmt: skip


def _draw_box(axes: Axes, stage: Stage, box: Box, width_mm: float, tint: str) -> None:
    from matplotlib.patches import FancyBboxPatch

    axes.add_patch(
        FancyBboxPatch(
            (box.x - width_mm / 2.0 + 0.6, box.y - box.height / 2.0 + 0.6), width_mm - 1.2, box.height - 1.2,
            boxstyle="round,pad=0.6", facecolor=tint, edgecolor=style.INK, linewidth=0.7, zorder=2,
            gid=f"stage {stage.name}",
        )
    )  # fmt: skip
    axes.text(
        box.x, box.y, stage.words, ha="center", va="center_baseline", fontsize=7.0, linespacing=1.25, zorder=3
    )
