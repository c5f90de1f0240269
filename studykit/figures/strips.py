"""Dances as strips of poses, with the hearts and the accuracy of those who danced them (Figure 6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.core.arrays import Floats, frozen
from studykit.core.errors import InputError
from studykit.figures import body, style
from studykit.figures.time_curves import PeopleCurve, draw_people
from studykit.motion import energy, kinematics
from studykit.motion.motion import Motion
from studykit.motion.skeleton import JOINT_NAMES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

    from studykit.figures.canvas import PaperFigure

POSES = 8
"""How many poses of a dance are shown."""

_STRIP_MM, _CURVE_MM, _GAP_MM = 26.0, 12.0, 5.0


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class DanceStrip:
    """One dance as Figure 6 shows it: its movement, and two curves of those who danced it.

    Parameters
    ----------
    condition : str
        For example "light-easy-on".
    motion : Motion
        The dance.
    times_s : array_like, shape (time,), s
        Where the curves were sampled, from the start of the dance.
    heart_rate_bpm : array_like, shape (participant, time), beats a minute
        NaN where unknown.
    distance_m : array_like, shape (participant, time), m
        Distance (DTW) between the dancer and the guide; NaN where unknown.
    """

    condition: str
    motion: Motion
    times_s: Floats
    heart_rate_bpm: Floats
    distance_m: Floats

    def __post_init__(self) -> None:
        times = len(self.times_s)
        for name, shape in (
            ("times_s", (times,)),
            ("heart_rate_bpm", (None, times)),
            ("distance_m", (None, times)),
        ):
            object.__setattr__(self, name, frozen(getattr(self, name), shape=shape, name=name))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Poses:
    """Some poses of a dance, and how hard each joint works around them.

    Parameters
    ----------
    times_s : ndarray, shape (pose,), s
    positions : ndarray, shape (pose, 24, 3), m
        Pelvis above the origin, lowest joint of the dance at height 0.
    intensity : ndarray, shape (pose, 24), J per kg
        Linear and rotational energy (Eq. 8 and 11), averaged over the poses of the stretch of the dance
        around this one.
    """

    times_s: Floats
    positions: Floats
    intensity: Floats


def poses(motion: Motion, *, count: int = POSES) -> Poses:
    """Choose poses evenly from a dance: the middle one of each of `count` equal stretches."""
    edges = np.round(np.linspace(0, len(motion), count + 1)).astype(int)
    middles = (edges[:-1] + edges[1:]) // 2
    world = kinematics.joint_positions(motion)
    centred = kinematics.centred_positions(motion.skeleton, motion.rotations)
    rate = motion.frame_rate_hz
    intensity = [
        (
            energy.linear_energy(centred[first:last], rate)
            + energy.rotational_energy(motion.rotations[first:last], rate)
        )
        / (last - first)
        for first, last in pairwise(edges)
    ]
    positions = world[middles] - world[middles][:, :1] * [1.0, 0.0, 1.0]
    positions[..., 1] -= world[..., 1].min()
    return Poses(times_s=middles / rate, positions=positions, intensity=np.array(intensity))


def four_dances(strips: Sequence[DanceStrip], *, simulated: bool, synthetic: bool = False) -> PaperFigure:
    """Show dances as strips of poses above heart rate and movement distance over time (Figure 6).

    Parameters
    ----------
    strips : sequence of DanceStrip
        One a row, from top to bottom; all share one colour scale and the axes of their curves.
    simulated : bool
        Whether people or devices were simulated.
    synthetic : bool, optional
        Whether any of the dances was made up rather than danced by a person.

    Returns
    -------
    PaperFigure
        Each half of a bone has the colour of its joint: that joint's energy divided by the highest of all
        joints, poses and dances. Curves: mean over participants with its 95 % interval.

    Raises
    ------
    InputError
        If there is no dance to show.
    """
    if not strips:
        raise InputError("there is no dance to show", where="figure 6", remedy="give at least one strip")
    shown = [poses(strip.motion) for strip in strips]
    highest = max(float(one.intensity.max()) for one in shown) or 1.0
    row_mm = _STRIP_MM + 2.0 * _CURVE_MM + _GAP_MM
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM,
            height_mm=16.0 + len(strips) * row_mm,
            simulated=simulated,
            synthetic=synthetic,
        )
        colours = body.shades(1.0)
        grid = figure.add_gridspec(
            3 * len(strips), 1, height_ratios=[_STRIP_MM + _GAP_MM, _CURVE_MM, _CURVE_MM] * len(strips)
        )
        panels = [
            [figure.add_subplot(grid[3 * row + part]) for part in range(3)] for row in range(len(strips))
        ]
        for strip, bodies, (top, heart, distance) in zip(strips, shown, panels, strict=True):
            draw_poses(top, strip.motion, bodies, lambda joint: colours.to_rgba(joint / highest))
            top.set_title(style.words(strip.condition), fontweight="bold", pad=1.0)
            _draw_curve(heart, strip, strip.heart_rate_bpm, "Heart rate\n(beats/min)")
            _draw_curve(distance, strip, strip.distance_m, "DTW\n(m)")
            heart.tick_params(labelbottom=False)
            distance.tick_params(labelbottom=distance is panels[-1][2])
        for part in (1, 2):
            _share_height([row[part] for row in panels])
        panels[-1][2].set_xlabel("Time in the dance (s)")
        figure.align_ylabels()
        draw_scale(figure, colours)
    return figure


def draw_poses(
    axes: Axes,
    motion: Motion,
    bodies: Poses,
    colour_of: Any,
    *,
    spared: Sequence[str] = (),
    size_mm: tuple[float, float] | None = None,
) -> None:
    """Draw the poses of a dance over a line of time.

    Parameters
    ----------
    colour_of : callable
        Turns intensities, shape (24,), into colours.
    spared : sequence of str, optional
        Joints that get a rim of their own.
    size_mm : (float, float), optional
        Width and height of the axes on paper, so that bodies are as wide as they are tall.
    """
    is_spared = [name in spared for name in JOINT_NAMES]
    rims = [style.SPARED if one else style.INK for one in is_spared]
    rim_pt = np.where(is_spared, 1.0, 0.45)
    wide_mm, high_mm = size_mm or (style.PAGE_MM - 20.0, _STRIP_MM)
    duration_s = motion.duration_s
    top_m = max(1.85, float(bodies.positions[..., 1].max()) + 0.12)
    # Bodies are as wide as they are tall: the strip's axes show seconds across and metres up.
    seconds_a_metre = duration_s / wide_mm * high_mm / (top_m + 0.06)
    for time_s, pose, work in zip(bodies.times_s, bodies.positions, bodies.intensity, strict=True):
        screen, depth = body.seen(pose)
        screen = screen * [seconds_a_metre, 1.0] + [time_s, 0.0]
        shades = colour_of(work)
        body.draw_body(axes, screen, shades, depth=depth, outlines=rims, widths_pt=(2.3, rim_pt))
        body.draw_head(axes, screen[body.HEAD], face=shades[body.HEAD], scale=(seconds_a_metre, 1.0))
    axes.axhline(0.0, color=style.INK, linewidth=0.7, zorder=0)
    axes.set(xlim=(0.0, duration_s), ylim=(-0.06, top_m), xticks=[], yticks=[])
    axes.spines[:].set_visible(False)
    for artist in (*axes.collections, *axes.patches):
        artist.set_clip_on(False)  # an arm may reach beyond the first or the last second


def _draw_curve(axes: Axes, strip: DanceStrip, values: Floats, axis_label: str) -> None:
    style.rule(axes)
    curve = PeopleCurve(label=axis_label, times_s=strip.times_s, values=values)
    draw_people(axes, curve, style.colour(strip.condition))
    duration_s = strip.motion.duration_s
    axes.set_xlim(0.0, duration_s)
    axes.set_xticks(np.arange(0.0, duration_s + 0.1, 4.0 if duration_s <= 64.0 else 16.0))
    axes.set_ylabel(axis_label, fontsize=7.0, rotation=0, ha="right", va="center")


def _share_height(axes: Sequence[Axes]) -> None:
    low = min(one.get_ylim()[0] for one in axes)
    high = max(one.get_ylim()[1] for one in axes)
    for one in axes:
        one.set_ylim(low, high)
        one.locator_params(axis="y", nbins=3)


def draw_scale(figure: Figure, colours: ScalarMappable) -> None:
    """Say what the colours of poses mean."""
    bar = figure.colorbar(colours, ax=list(figure.axes), location="bottom", shrink=0.4, aspect=38, pad=0.01)
    bar.set_label("Joint energy, as a share of the highest of all joints and poses")
    bar.set_ticks([0.0, 0.1, 0.25, 0.5, 1.0])
    bar.ax.minorticks_off()
