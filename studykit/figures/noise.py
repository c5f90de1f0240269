"""What the noise rules took out: of one take, and of all."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from studykit.core.arrays import Booleans, Floats
from studykit.core.errors import InputError
from studykit.figures import style
from studykit.motion import kinematics
from studykit.motion.cleaning import (
    ACCELERATION_LIMIT_M_S2,
    SPEED_LIMIT_M_S,
    clean_runs,
    excesses,
    flagged,
)
from studykit.motion.motion import Motion
from studykit.motion.resampling import resampled
from studykit.motion.segmentation import FRAME_RATE_HZ, SEGMENT_FRAMES, SEGMENT_S, segment_starts
from studykit.motion.skeleton import JOINT_NAMES

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from studykit.figures.canvas import PaperFigure

_KEPT = "#0072B2"
_RULES = (("robust", "Robust rule"), ("paper", "The paper's rule"))


def cleaning(motion: Motion, *, take: str = "", synthetic: bool = False) -> PaperFigure:
    """Show what the noise rules find in a take, and which segments they leave.

    Parameters
    ----------
    motion : Motion
        The take on studykit's body, at its own rate.
    take : str, optional
        Its name.
    synthetic : bool, optional
        Whether it was made up rather than danced by a person.

    Returns
    -------
    PaperFigure
        Speed and acceleration of the joint that goes farthest in each frame, with their limits; the same for
        the paper's limit, which each joint has of its own; then flagged frames and kept segments by both
        rules.

    Raises
    ------
    InputError
        If the take is shorter than one segment.
    """
    whole = resampled(motion, FRAME_RATE_HZ)
    way = whole.root_positions
    if len(whole) < SEGMENT_FRAMES:
        raise InputError(
            f"the take lasts {whole.duration_s:.2f} s", where=take or "take", remedy="give 4 s or more"
        )
    positions = kinematics.centred_positions(whole.skeleton, whole.rotations)
    excess = excesses(positions, whole.root_positions, FRAME_RATE_HZ)
    with style.in_style():
        figure = style.sheet(width_mm=style.PAGE_MM, height_mm=116.0, simulated=False, synthetic=synthetic)
        *curves, bars = figure.subplots(4, 1, sharex=True, height_ratios=(1.0, 1.0, 1.0, 0.85))
        for axes, values, limit, words in (
            (curves[0], excess["speed"], SPEED_LIMIT_M_S, "Speed (m/s)"),
            (curves[1], excess["acceleration"], ACCELERATION_LIMIT_M_S2, "Acceleration\n(m/s²)"),
            (curves[2], excess["paper"], 1.0, "Acceleration as\nshare of the\npaper's limit"),
        ):
            _draw_excess(axes, values, limit)
            axes.set_ylabel(words)
        _draw_way(curves[0], np.diff(way, axis=0) * FRAME_RATE_HZ, SPEED_LIMIT_M_S)
        _draw_way(curves[1], np.diff(way, 2, axis=0) * FRAME_RATE_HZ**2, ACCELERATION_LIMIT_M_S2)
        _draw_rules(bars, [flagged(excess, "robust"), flagged(excess, "paper")])
        bars.set_xlim(0.0, len(whole) / FRAME_RATE_HZ)
        bars.set_xlabel("Time in the take (s)")
        bars.locator_params(axis="x", steps=[1, 2, 5, 10], integer=True)
        figure.align_ylabels()
        if take:
            curves[0].set_title(take, fontweight="bold")
        _explain(figure)
    return figure


def yield_by_take(table: pd.DataFrame, *, rows: int = 40, synthetic: bool = False) -> PaperFigure:
    """Show how much of each take was kept, the worst first.

    Parameters
    ----------
    table : DataFrame
        A library's table of takes: `take`, `segments_possible`, `segments_kept`, `segments_paper`.
    rows : int
        Takes shown at most.
    synthetic : bool, optional
        Whether any take was made up rather than danced by a person.

    Raises
    ------
    InputError
        If no take is long enough for a segment.
    """
    fits = table[table["segments_possible"] > 0]
    if fits.empty:
        raise InputError("no take has a segment", where="table", remedy="give takes of 4 s or more")
    shares = 100.0 * fits["segments_kept"] / fits["segments_possible"]
    order = np.lexsort((fits["take"].astype(str), -fits["segments_possible"], shares))[:rows]
    shown, share = fits.iloc[order], shares.iloc[order]
    paper = 100.0 * shown["segments_paper"] / shown["segments_possible"]
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM * 0.8,
            height_mm=30.0 + 3.9 * len(shown),
            simulated=False,
            synthetic=synthetic,
        )
        axes = figure.add_subplot()
        style.rule(axes, at="x")
        places = np.arange(len(shown), dtype=np.float64)
        axes.barh(places, share, height=0.7, color=_KEPT, linewidth=0.0, gid="kept")
        axes.scatter(
            paper, places, s=11.0, marker="D", facecolor="white", edgecolor=style.INK, linewidths=0.8,
            zorder=3, clip_on=False, gid="paper",
        )  # fmt: skip
        right = max(100.0, float(share.max()))
        for place, kept, possible in zip(
            places, shown["segments_kept"], shown["segments_possible"], strict=True
        ):
            axes.text(
                1.03 * right, float(place), f"{kept} / {possible}", va="center", fontsize=6.5, color=style.INK
            )
        axes.set_yticks(places, [_short(str(name)) for name in shown["take"]], fontsize=6.5)
        axes.set(xlim=(0.0, right), ylim=(len(shown) - 0.4, -0.6))
        axes.tick_params(axis="y", length=0.0)
        axes.set_xlabel("Segments kept (% of those that fit side by side; numbers at the right)")
        axes.set_title(_summary(fits, len(shown)))
        _explain_yield(figure)
    return figure


def _draw_excess(axes: Axes, excess: Floats, limit: float) -> None:
    """Draw the worst joint of each frame and what is over the limit; name the worst of all."""
    times = np.arange(len(excess)) / FRAME_RATE_HZ
    worst = limit * excess.max(axis=1)
    measured = worst > 0.0  # the ends have no speed or acceleration
    axes.plot(times[measured], worst[measured], color=style.INK, linewidth=0.7, gid="worst joint")
    over = worst > limit
    axes.scatter(
        times[over], worst[over], s=7.0, marker="x", color=style.WARNING, linewidths=0.8, zorder=3, gid="over"
    )
    axes.axhline(limit, color=style.WARNING, linewidth=0.9, linestyle=(0, (4.0, 2.0)))
    axes.set_yscale("log")
    axes.set_ylim(
        max(float(np.percentile(worst[measured], 2.0)) / 1.5, limit / 300.0),
        2.6 * max(float(worst.max()), limit),
    )
    frame = int(np.argmax(worst))
    place = min(max(times[frame], 0.02 * times[-1]), 0.98 * times[-1])
    side = "right" if place > 0.8 * times[-1] else "left"
    name = JOINT_NAMES[int(np.argmax(excess[frame]))].replace("_", " ")
    axes.text(place, 1.25 * worst[frame], name, fontsize=6.5, ha=side, va="bottom", color=style.INK)
    _plain_numbers(axes)


def _draw_way(axes: Axes, steps: Floats, limit: float) -> None:
    """Draw how the pelvis goes through the room, on the axes of the joints."""
    sizes = np.linalg.norm(steps, axis=1)
    times = np.arange(1, len(sizes) + 1) / FRAME_RATE_HZ
    axes.plot(times, sizes, color=style.FAINT, linewidth=0.6, linestyle=(0, (1.0, 1.2)), gid="pelvis")
    over = sizes > limit
    axes.scatter(times[over], sizes[over], s=7.0, marker="x", color=style.WARNING, linewidths=0.8, zorder=3)


def _plain_numbers(axes: Axes) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.yaxis.set_major_locator(LogLocator(base=10.0, numticks=5))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.tick_params(axis="y", which="minor", length=0.0)


def _draw_rules(axes: Axes, bad: list[Booleans]) -> None:
    for row, (own, (name, rule)) in enumerate(zip(bad, _RULES, strict=True)):
        starts = segment_starts(clean_runs(own))
        axes.broken_barh(
            [(start / FRAME_RATE_HZ + 0.04, SEGMENT_S - 0.08) for start in starts],
            (row - 0.26, 0.26),
            facecolor=_KEPT,
            gid=f"kept {name}",
        )
        edges = np.flatnonzero(np.diff(np.concatenate(([False], own, [False])).astype(int)))
        stretches = [(int(start), int(stop)) for start, stop in zip(edges[::2], edges[1::2], strict=True)]
        axes.broken_barh(
            [(start / FRAME_RATE_HZ, (stop - start) / FRAME_RATE_HZ) for start, stop in stretches],
            (row + 0.04, 0.2),
            facecolor=style.WARNING,
            edgecolor=style.WARNING,
            linewidth=0.3,
            gid=f"flagged {name}",
        )
        fits = len(own) // SEGMENT_FRAMES
        words = f"{rule}: {len(starts)} of {fits} segments kept, {own.mean():.0%} of frames flagged"
        axes.text(
            0.0, row - 0.3, words, fontsize=6.5, ha="left", va="bottom", color=style.INK,
        )  # fmt: skip
    axes.set(yticks=[], ylim=(len(bad) - 0.68, -0.62))
    axes.spines["left"].set_visible(False)


def _explain(figure: Figure) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries = [
        Line2D([], [], color=style.INK, linewidth=0.7, label="worst joint of each frame"),
        Line2D(
            [],
            [],
            color=style.FAINT,
            linewidth=0.6,
            linestyle=(0, (1.0, 1.2)),
            label="pelvis through the room",
        ),
        Line2D([], [], color=style.WARNING, linewidth=0.9, linestyle=(0, (4.0, 2.0)), label="limit"),
        Line2D([], [], color=style.WARNING, linestyle="", marker="x", markersize=3.5, label="over it"),
        Patch(color=style.WARNING, label="flagged"),
        Patch(color=_KEPT, label="segment kept"),
    ]
    figure.legend(handles=entries, loc="outside lower center", ncols=6)


def _explain_yield(figure: Figure) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries = [
        Patch(color=_KEPT, label="kept"),
        Line2D(
            [], [], linestyle="", marker="D", markersize=3.4, markerfacecolor="white",
            markeredgecolor=style.INK, markeredgewidth=0.8, label="the paper's rule would keep",
        ),
    ]  # fmt: skip
    figure.legend(handles=entries, loc="outside lower center", ncols=2)


def _summary(fits: pd.DataFrame, shown: int) -> str:
    kept, possible = int(fits["segments_kept"].sum()), int(fits["segments_possible"].sum())
    which = f"The {shown} worst of {len(fits)} takes" if shown < len(fits) else f"All {shown} takes"
    return f"{which}; {kept} of {possible} segments of all takes are kept"


def _short(name: str, *, longest: int = 34) -> str:
    return name if len(name) <= longest else f"…{name[1 - longest :]}"
