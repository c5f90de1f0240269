"""Two poses between which a dance jumps, and how far every joint is moved by it (Figure 4)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from studykit.choreography.dance import Dance
from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.figures import body, style
from studykit.figures.film import at_joins, letters
from studykit.motion.skeleton import JOINT_NAMES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from studykit.figures.canvas import PaperFigure

_HANDS = tuple(JOINT_NAMES.index(f"{side}_hand") for side in ("left", "right"))
_TURNS_RAD = np.deg2rad(np.linspace(-60.0, 60.0, 25))
_BEFORE, _AFTER = style.FAINT, style.INK


def meeting_segments(dance: Dance) -> PaperFigure:
    """Show where two segments of a dance meet, and how far each joint lies apart there (Figure 4).

    Parameters
    ----------
    dance : Dance
        Of its joins, the one with the largest displacement (Delta of Eq. 3) is shown.

    Returns
    -------
    PaperFigure
        Left: the last pose of a segment that blending leaves alone and the first of the next, 0.4 s apart,
        pelvis on pelvis and facing the same way, seen from where the jump of the hand that moves more shows
        best; lines join the same joint of both, that of the hand is bold. Right: the same distances and their
        mean. The title says Delta at the join itself, as found before blending.

    Raises
    ------
    InputError
        If the dance has only one segment.
    """
    if len(dance.segments) < 2:
        raise InputError(
            "the dance has no join", where=dance.condition, remedy="give a dance of two segments or more"
        )
    poses = at_joins(dance)
    distances = displacements_m(poses)
    join = int(np.argmax(dance.displacements_m))
    hand = max(_HANDS, key=lambda joint: float(distances[join, joint]))
    names = letters(dance)
    with style.in_style():
        figure = style.sheet(
            width_mm=style.COLUMN_MM, height_mm=84.0, simulated=False, synthetic=dance.is_synthetic
        )
        left, right = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
        _draw_poses(left, poses[join], distances[join], hand)
        left.set_title(
            style.title(dance).replace(", ", ",\n") + f"\n{names[join]} to {names[join + 1]}: "
            f"Δ = {1000.0 * dance.displacements_m[join]:.0f} mm",
            fontweight="bold",
        )
        _draw_distances(right, distances[join], hand)
        _explain(figure)
    return figure


def displacements_m(poses: Floats) -> Floats:
    """Give how far every joint lies apart in pairs of poses, shape (join, 24), m.

    Parameters
    ----------
    poses : ndarray, shape (join, 2, 24, 3), m
        See `film.at_joins`.
    """
    return np.asarray(np.linalg.norm(poses[:, 1] - poses[:, 0], axis=-1))


def turned_to_show(poses: Floats, joint: int) -> Floats:
    """Turn two poses about the vertical, by 60 degrees at most, so that the jump of a joint is seen best.

    Parameters
    ----------
    poses : ndarray, shape (2, 24, 3), m
    joint : int
        Number of the joint.

    Returns
    -------
    ndarray, shape (2, 24, 3), m
    """
    candidates = []
    for angle in sorted(_TURNS_RAD, key=abs):
        turned = poses.copy()
        across, near = poses[..., 0], poses[..., 2]
        turned[..., 0] = np.cos(angle) * across + np.sin(angle) * near
        turned[..., 2] = np.cos(angle) * near - np.sin(angle) * across
        screen, _ = body.seen(turned)
        candidates.append((float(np.linalg.norm(screen[1, joint] - screen[0, joint])), turned))
    return max(candidates, key=lambda candidate: candidate[0])[1]


def _draw_poses(axes: Axes, poses: Floats, distances: Floats, hand: int) -> None:
    seen = [body.seen(pose) for pose in turned_to_show(poses, hand)]
    for (screen, depth), colour in zip(seen, (_BEFORE, _AFTER), strict=True):
        body.draw_body(axes, screen, colour, depth=depth, outlines="white", widths_pt=(2.2, 0.45))
        body.draw_head(axes, screen[body.HEAD], face=colour, edge="white")
    ends = np.stack([screen for screen, _ in seen], axis=1)
    for joint, line in enumerate(ends):
        is_hand = joint == hand
        axes.plot(
            *line.T, color=style.INTENSITY["intense"], linewidth=1.6 if is_hand else 0.5, zorder=5 + is_hand,
            marker="o", markersize=3.0 if is_hand else 1.2, gid=f"jump {JOINT_NAMES[joint]}",
        )  # fmt: skip
    outer = max(ends[hand], key=lambda place: abs(place[0]))
    side = float(np.sign(outer[0]) or 1.0)
    axes.annotate(
        f"{1000.0 * distances[hand]:.0f} mm", outer, xytext=(4.0 * side, 0.0), textcoords="offset points",
        ha="left" if side > 0.0 else "right", va="center", color=style.INTENSITY["intense"],
        fontweight="bold", zorder=8, bbox={"facecolor": "white", "alpha": 0.75, "linewidth": 0.0, "pad": 0.5},
    )  # fmt: skip
    axes.set_aspect("equal")
    axes.margins(0.10)
    axes.set_axis_off()


def _draw_distances(axes: Axes, distances: Floats, hand: int) -> None:
    order = np.argsort(distances, kind="stable")
    rows = np.arange(len(order))
    millimetres = 1000.0 * distances[order]
    style.rule(axes, at="x")
    axes.hlines(rows, 0.0, millimetres, color=style.FAINT, linewidth=0.6)
    faces = [style.INTENSITY["intense"] if joint == hand else style.INK for joint in order]
    sizes = np.where(order == hand, 18.0, 7.0)
    axes.scatter(millimetres, rows, s=sizes, color=faces, zorder=3, gid="distances")
    mean = float(millimetres.mean())
    axes.axvline(mean, color=style.INTENSITY["light"], linewidth=1.0, linestyle=(0, (4, 1.5)), gid="mean")
    axes.text(
        mean, 1.005, f"mean {mean:.0f} mm", transform=axes.get_xaxis_transform(), ha="center", va="bottom",
        color=style.INTENSITY["light"], fontsize=7.0,
    )  # fmt: skip
    axes.set_yticks(rows, [JOINT_NAMES[joint].replace("_", " ") for joint in order], fontsize=5.5)
    axes.set(xlim=(0.0, None), ylim=(-0.8, len(order) - 0.2))
    axes.tick_params(axis="y", length=0.0)
    axes.set_xlabel("Jump (mm)")


def _explain(figure: PaperFigure) -> None:
    from matplotlib.lines import Line2D

    entries = [
        Line2D([], [], color=_BEFORE, linewidth=2.2, label="pose p, before blending"),
        Line2D([], [], color=_AFTER, linewidth=2.2, label="pose q, after it"),
        Line2D(
            [], [], color=style.INTENSITY["intense"], linewidth=0.8, marker="o", markersize=2.0, label="jump"
        ),
    ]
    figure.legend(handles=entries, loc="outside lower center", ncols=3, columnspacing=1.0, handlelength=1.4)
