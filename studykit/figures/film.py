"""Dances as rows of poses over time, in which what comes back and what jumps can be seen (Figure 3)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from studykit.choreography.dance import Dance
from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.figures import body, style
from studykit.motion import kinematics, rotation
from studykit.motion.blending import HALF_WINDOW
from studykit.motion.skeleton import JOINT_NAMES

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from studykit.figures.canvas import PaperFigure

SEGMENTS_A_ROW = 8

# Metres of the drawing: a segment is as wide as a body with its arms out.
_WIDE_M, _BAND_M, _AIR_M = 1.72, 0.34, 0.34
_LEFT_M, _RIGHT_M = 0.75, 0.15
_JOIN_SCALE, _JOIN_DROP_M = 0.72, 0.92  # bodies at joins are smaller; their pelvis is so far below the floor
_BOTTOM_M = 1.98
_TITLE_MM, _LEGEND_MM = 6.0, 12.0


def film_strip(dance: Dance) -> PaperFigure:
    """Show one dance as rows of poses; see `film_strips`."""
    return film_strips([dance])


def film_strips(dances: Sequence[Dance]) -> PaperFigure:
    """Show dances as rows of poses: which segments come back, and how bodies jump where segments meet.

    Parameters
    ----------
    dances : sequence of Dance
        From top to bottom, for example the same goal with and without the transition cost.

    Returns
    -------
    PaperFigure
        Above: the pose in the middle of each segment, turned to the reader. The same segment has the same
        letter; one that comes back has a colour, and a prime when left and right are exchanged. Below, small:
        the last pose before a join and the first after it that blending leaves alone, and how far joints
        jump between the segments (Eq. 3). Spared joints have a colour of their own.

    Raises
    ------
    InputError
        If there is no dance to show.
    """
    if not dances:
        raise InputError("there is no dance to show", where="film strip", remedy="give at least one")
    rows = [(dance, first) for dance in dances for first in range(0, len(dance.segments), SEGMENTS_A_ROW)]
    top_m = max(1.8, *(float(middles(dance)[..., 1].max()) + 0.16 for dance in dances))
    width_m = _LEFT_M + SEGMENTS_A_ROW * _WIDE_M + _RIGHT_M
    row_mm = (top_m + _BAND_M + _AIR_M + _BOTTOM_M) / width_m * style.PAGE_MM
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM,
            height_mm=len(rows) * row_mm + len(dances) * _TITLE_MM + _LEGEND_MM,
            simulated=False,
            synthetic=any(dance.is_synthetic for dance in dances),
        )
        panels = figure.subplots(len(rows), 1, squeeze=False)[:, 0]
        for axes, (dance, first) in zip(panels, rows, strict=True):
            _draw_row(axes, dance, first, top_m)
            axes.set(
                xlim=(-_LEFT_M, width_m - _LEFT_M),
                ylim=(-_BOTTOM_M, top_m + _BAND_M + _AIR_M),
                aspect="equal",
            )
            axes.set_axis_off()
            if first == 0:
                axes.set_title(style.title(dance), fontweight="bold", pad=2.0)
        _explain(figure, dances)
    return figure


def letters(dance: Dance) -> tuple[str, ...]:
    """Name the segments of a dance: the same letter for the same segment, a prime for its mirror image.

    Examples
    --------
    A dance of a segment, another, its mirror image and the first again: A, B, B′, A.
    """
    names: dict[tuple[str, float, str], str] = {}
    firsts: dict[str, bool] = {}
    found = []
    for segment in dance.segments:
        name = names.setdefault((segment.take, segment.start_s, segment.spliced_from), _letter(len(names)))
        is_first = firsts.setdefault(name, segment.mirrored)
        found.append(name + ("" if is_first == segment.mirrored else "′"))
    return tuple(found)


def _letter(number: int) -> str:
    alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
    return (alphabet[number // 26 - 1] if number >= 26 else "") + alphabet[number % 26]


def middles(dance: Dance) -> Floats:
    """Give the pose in the middle of each segment, shape (segment, 24, 3), m.

    Each body faces the reader, its pelvis above the origin; the lowest joint of the dance is at height 0.
    """
    edges = _edges(dance)
    frames = (edges[:-1] + edges[1:]) // 2
    motion = dance.motion
    bodies = kinematics.centred_positions(motion.skeleton, motion.rotations)
    heights = motion.root_positions[:, 1]
    lowest = float((bodies[..., 1].min(axis=1) + heights).min())
    turned = _facing_reader(bodies[frames], kinematics.facing(bodies[frames]))
    turned[..., 1] += (heights[frames] - lowest)[:, None]
    return turned


def at_joins(dance: Dance) -> Floats:
    """Give the poses on both sides of each join, shape (join, 2, 24, 3), m, seen from before the join.

    They are the nearest that blending leaves alone (what cleans a join may move them a little); the pelvis is
    at the origin.
    """
    motion = dance.motion
    joins = _edges(dance)[1:-1]
    frames = np.stack((joins - HALF_WINDOW - 1, joins + HALF_WINDOW), axis=1)
    bodies = kinematics.centred_positions(motion.skeleton, motion.rotations[frames])
    facing = kinematics.facing(bodies[:, :1])
    return _facing_reader(bodies, np.broadcast_to(facing, frames.shape))


def _edges(dance: Dance) -> np.ndarray:
    return np.round(np.linspace(0, len(dance.motion), len(dance.segments) + 1)).astype(int)


def _facing_reader(bodies: Floats, facing: Floats) -> Floats:
    turn = rotation.exp(np.stack((0.0 * facing, -facing, 0.0 * facing), axis=-1))
    return np.array(rotation.rotate(turn[..., None, :], bodies))


def _draw_row(axes: Axes, dance: Dance, first: int, top_m: float) -> None:
    names = letters(dance)
    colours = _colours(names)
    spared = () if dance.mask is None else dance.mask.spared
    shades = [style.SPARED if name in spared else style.BODY for name in JOINT_NAMES]
    last = min(first + SEGMENTS_A_ROW, len(names))
    poses, joins = middles(dance)[first:last], at_joins(dance)
    axes.plot([0.0, (last - first) * _WIDE_M], [0.0, 0.0], color=style.INK, linewidth=0.7, zorder=0)
    for place, (number, pose) in enumerate(zip(range(first, last), poses, strict=True)):
        left = place * _WIDE_M
        _draw_band(axes, left, top_m, names[number], colours[names[number].rstrip("′")])
        screen, depth = body.seen(pose)
        screen = screen + np.array([left + _WIDE_M / 2.0, 0.0])
        body.draw_body(axes, screen, shades, depth=depth, outlines="white", widths_pt=(1.9, 0.45))
        body.draw_head(axes, screen[body.HEAD], face=shades[body.HEAD], edge="white")
        if number:
            _draw_join(axes, left, joins[number - 1], dance.displacements_m[number - 1])
            axes.plot(
                [left, left],
                [-0.30, top_m],
                color=style.FAINT,
                linewidth=0.6,
                linestyle=(0, (1, 2)),
                zorder=0,
            )
        axes.text(left, top_m + _BAND_M + 0.06, f"{_start_s(dance, number):g} s", ha="center", fontsize=6.5)


def _start_s(dance: Dance, number: int) -> float:
    return float(_edges(dance)[number]) / dance.motion.frame_rate_hz


def _colours(names: Sequence[str]) -> dict[str, str]:
    """Give a colour to each letter that comes back; where there are too many they begin again."""
    plain = [name.rstrip("′") for name in names]
    again = [name for name in dict.fromkeys(plain) if plain.count(name) > 1]
    tints = {name: style.TINTS[number % len(style.TINTS)] for number, name in enumerate(again)}
    return {name: tints.get(name, "white") for name in plain}


def _draw_band(axes: Axes, left: float, bottom: float, name: str, colour: str) -> None:
    from matplotlib.patches import Rectangle

    axes.add_patch(
        Rectangle(
            (left + 0.03, bottom), _WIDE_M - 0.06, _BAND_M, facecolor=colour, edgecolor=style.INK,
            linewidth=0.5, gid=f"segment {name}",
        )
    )  # fmt: skip
    middle = (left + _WIDE_M / 2.0, bottom + _BAND_M / 2.0)
    axes.text(*middle, name, ha="center", va="center_baseline", fontsize=8.0, fontweight="bold")


def _draw_join(axes: Axes, place: float, poses: Floats, displacement_m: float) -> None:
    for pose, colour in zip(poses, (style.FAINT, style.INK), strict=True):
        screen, depth = body.seen(pose)
        screen = screen * _JOIN_SCALE + np.array([place, -_JOIN_DROP_M])
        body.draw_body(axes, screen, colour, depth=depth, outlines="white", widths_pt=(1.3, 0.45))
        body.draw_head(axes, screen[body.HEAD], face=colour, edge="white", scale=(_JOIN_SCALE, _JOIN_SCALE))
    axes.text(
        place, -_BOTTOM_M + 0.02, f"{1000.0 * displacement_m:.0f} mm", ha="center", va="bottom", fontsize=6.5,
        gid="displacement",
    )  # fmt: skip


def _explain(figure: Figure, dances: Sequence[Dance]) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries: list[Artist] = []
    if any(len(dance.segments) > 1 for dance in dances):
        entries = [
            Line2D([], [], color=style.FAINT, label="before a join"),
            Line2D([], [], color=style.INK, label="after it; below, how far joints jump"),
        ]
    if any(len(set(letters(dance))) < len(dance.segments) for dance in dances):
        tint = Patch(facecolor=style.TINTS[0], edgecolor=style.INK, linewidth=0.5)
        is_mirrored = any(name.endswith("′") for dance in dances for name in letters(dance))
        tint.set_label("segment that comes back" + (" (A′: mirrored)" if is_mirrored else ""))
        entries.insert(0, tint)
    if any(dance.mask is not None for dance in dances):
        entries.append(Line2D([], [], color=style.SPARED, label="spared joints"))
    if entries:
        figure.legend(handles=entries, loc="outside lower center", ncols=len(entries))
