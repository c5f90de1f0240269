"""Dances as strips of poses, with the hearts and the accuracy of those who danced them (Figure 6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.core.arrays import Floats, frozen
from studykit.core.errors import InputError
from studykit.figures import style
from studykit.figures.samples import mean_interval
from studykit.motion.skeleton import NEUTRAL_BODY

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

    from studykit.figures.canvas import PaperFigure

_VIEW_RAD = np.deg2rad(25.0)  # a quarter view: kicks towards the viewer stay visible
_STRIP_MM, _CURVE_MM, _TITLE_MM = 25.0, 11.5, 5.0
_BONES = tuple((parent, joint) for joint, parent in enumerate(NEUTRAL_BODY.parents) if parent >= 0)
_HEAD = NEUTRAL_BODY.index("head")
_HEAD_RADIUS_M = 0.10


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class DanceStrip:
    """One dance as Figure 6 shows it: some of its poses, and two curves of those who danced it.

    Parameters
    ----------
    condition : str
        For example "light-easy-on".
    duration_s : float
        Length of the dance, s.
    poses : array_like, shape (pose, 24, 3), m
        Joint positions in SMPL's order: Y up, the ground at height 0, pelvis above the origin.
    pose_times_s : array_like, shape (pose,), s
        When each pose comes.
    intensity : array_like, shape (pose, 24)
        How hard each joint works around each pose, in one unit for all dances.
    times_s : array_like, shape (time,), s
        Where the curves were sampled, from the start of the dance.
    heart_rate_bpm : array_like, shape (participant, time), beats a minute
        NaN where unknown.
    distance_m : array_like, shape (participant, time), m
        Distance (DTW) between the dancer and the guide; NaN where unknown.
    """

    condition: str
    duration_s: float
    poses: Floats
    pose_times_s: Floats
    intensity: Floats
    times_s: Floats
    heart_rate_bpm: Floats
    distance_m: Floats

    def __post_init__(self) -> None:
        joints, poses, times = len(NEUTRAL_BODY.joint_names), len(self.poses), len(self.times_s)
        shapes: dict[str, tuple[int | None, ...]] = {
            "poses": (poses, joints, 3),
            "pose_times_s": (poses,),
            "intensity": (poses, joints),
            "times_s": (times,),
            "heart_rate_bpm": (None, times),
            "distance_m": (None, times),
        }
        for name, shape in shapes.items():
            object.__setattr__(self, name, frozen(getattr(self, name), shape=shape, name=name))


def four_dances(strips: Sequence[DanceStrip], *, simulated: bool) -> Figure:
    """Show dances as strips of poses above heart rate and movement distance over time (Figure 6).

    Parameters
    ----------
    strips : sequence of DanceStrip
        One a row, from top to bottom; all share one colour scale, one ground line a strip and the axes of
        their curves.
    simulated : bool
        Whether people or devices were simulated.

    Returns
    -------
    Figure
        Bones are coloured by the intensity of the joint that they move, divided by the highest of all
        joints, poses and dances. Curves: mean over participants with its 95 % interval.

    Raises
    ------
    InputError
        If there is no dance to show.
    """
    if not strips:
        raise InputError("there is no dance to show", where="figure 6", remedy="give at least one strip")
    highest = max(float(strip.intensity.max()) for strip in strips) or 1.0
    with style.in_style():
        height = 14.0 + len(strips) * (_STRIP_MM + 2 * _CURVE_MM + _TITLE_MM)
        figure = style.sheet(width_mm=style.PAGE_MM, height_mm=height, simulated=simulated)
        colours = _colours()
        rows = figure.add_gridspec(
            3 * len(strips), 1, height_ratios=[_STRIP_MM + _TITLE_MM, _CURVE_MM, _CURVE_MM] * len(strips)
        )
        curves: list[list[Axes]] = [[], []]
        bodies = []
        for row, strip in enumerate(strips):
            poses, heart, distance = (figure.add_subplot(rows[3 * row + part]) for part in range(3))
            _draw_poses(poses, strip, highest, colours)
            _draw_curve(heart, strip, strip.heart_rate_bpm, "Heart rate\n(beats/min)")
            _draw_curve(distance, strip, strip.distance_m, "DTW\n(m)")
            heart.tick_params(labelbottom=False)
            distance.tick_params(labelbottom=row == len(strips) - 1)
            bodies.append(poses)
            curves[0].append(heart)
            curves[1].append(distance)
        for same in curves:
            _share_height(same)
        curves[1][-1].set_xlabel("Time in the dance (s)")
        figure.align_ylabels()
        _draw_scale(figure, colours, bodies)
    return figure


def _colours() -> ScalarMappable:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, PowerNorm

    import matplotlib as mpl

    # The palest tenth is cut off: it would vanish on paper. The square root lets light dances show.
    shades = mpl.colormaps[style.INTENSITY_MAP](np.linspace(0.08, 0.92, 256))
    return ScalarMappable(
        PowerNorm(0.5, vmin=0.0, vmax=1.0), LinearSegmentedColormap.from_list("intensity", shades)
    )


def _draw_poses(axes: Axes, strip: DanceStrip, highest: float, colours: ScalarMappable) -> None:
    from matplotlib.collections import LineCollection

    intensity, variety, *_ = strip.condition.split("-")
    axes.set_title(f"{intensity.capitalize()} – {variety.capitalize()}", fontweight="bold", pad=2.0)
    turn = np.array([[np.cos(_VIEW_RAD), 0.0, -np.sin(_VIEW_RAD)], [np.sin(_VIEW_RAD), 0.0, np.cos(_VIEW_RAD)]])
    metres_to_s = _seconds_a_metre(strip)
    for pose, time_s, share in zip(
        strip.poses, strip.pose_times_s, strip.intensity / highest, strict=True
    ):
        across, depth = turn @ pose.T
        screen = np.column_stack((time_s + across * metres_to_s, pose[:, 1]))
        order = sorted(_BONES, key=lambda bone: float(depth[bone[0]] + depth[bone[1]]))
        lines = [screen[list(bone)] for bone in order]
        worked = colours.to_rgba(np.array([share[joint] for _, joint in order]))
        axes.add_collection(LineCollection(lines, colors=style.INK, linewidths=3.4, capstyle="round"))
        axes.add_collection(LineCollection(lines, colors=worked, linewidths=2.5, capstyle="round"))
        _draw_head(axes, screen[_HEAD], metres_to_s, colours.to_rgba(share[_HEAD]))
    axes.axhline(0.0, color=style.INK, linewidth=0.7, zorder=0)
    top = max(1.95, float(strip.poses[..., 1].max()) + 0.12)
    axes.set(xlim=(0.0, strip.duration_s), ylim=(-0.06, top), xticks=[], yticks=[])
    axes.spines[:].set_visible(False)


def _seconds_a_metre(strip: DanceStrip) -> float:
    """Scale bodies sideways as upright: the strip's axes show seconds across and metres up."""
    metres_up_a_mm = 2.0 / _STRIP_MM
    seconds_across_a_mm = strip.duration_s / (style.PAGE_MM - 34.0)
    return seconds_across_a_mm / metres_up_a_mm


def _draw_head(axes: Axes, centre: Floats, metres_to_s: float, colour: Any) -> None:
    from matplotlib.patches import Ellipse

    width, height = 2.0 * _HEAD_RADIUS_M * metres_to_s, 2.0 * _HEAD_RADIUS_M
    middle = (float(centre[0]), float(centre[1]) + 0.05)
    axes.add_patch(Ellipse(middle, width, height, facecolor=colour, edgecolor=style.INK, lw=0.5, zorder=3))


def _draw_curve(axes: Axes, strip: DanceStrip, values: Floats, axis_label: str) -> None:
    style.rule(axes)
    colour = style.INTENSITY.get(strip.condition.split("-", maxsplit=1)[0], style.INK)
    intervals = [mean_interval(column) for column in values.T]
    axes.fill_between(
        strip.times_s,
        [interval.low for interval in intervals],
        [interval.high for interval in intervals],
        color=colour,
        alpha=0.22,
        linewidth=0.0,
    )
    axes.plot(strip.times_s, [interval.mean for interval in intervals], color=colour, linewidth=1.1)
    axes.set_xlim(0.0, strip.duration_s)
    axes.set_xticks(np.arange(0.0, strip.duration_s + 0.1, 4.0))
    axes.set_ylabel(axis_label, fontsize=6.5, rotation=0, ha="right", va="center")


def _share_height(axes: Sequence[Axes]) -> None:
    low = min(one.get_ylim()[0] for one in axes)
    high = max(one.get_ylim()[1] for one in axes)
    for one in axes:
        one.set_ylim(low, high)


def _draw_scale(figure: PaperFigure, colours: ScalarMappable, bodies: Sequence[Axes]) -> None:
    bar = figure.colorbar(colours, ax=list(figure.axes), location="bottom", shrink=0.4, aspect=38, pad=0.01)
    bar.set_label("Joint intensity (share of the highest of all joints, poses and dances)", fontsize=7.0)
    bar.set_ticks([0.0, 0.1, 0.25, 0.5, 1.0])
    bar.outline.set_linewidth(0.5)  # type: ignore[operator]
