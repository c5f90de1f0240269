"""Which joints do the work in a dance library, on a drawn body and as bars."""

from __future__ import annotations

from typing import TYPE_CHECKING

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.figures import body, style
from studykit.motion.skeleton import JOINT_NAMES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from studykit.figures.canvas import PaperFigure

_KINDS = (
    "head", "neck", "collar", "shoulder", "elbow", "wrist", "hand", "spine3", "spine2", "spine1", "pelvis",
    "hip", "knee", "ankle", "foot",
)  # fmt: skip
_TITLES = ("Linear energy", "Rotational energy")


def joint_intensity(library: DanceLibrary) -> PaperFigure:
    """Show which joints spend the energy of a library's segments, on a body and as bars.

    Parameters
    ----------
    library : DanceLibrary
        One segment or more.

    Returns
    -------
    PaperFigure
        For linear and for rotational energy, each joint's share of the sum over all joints and segments, in
        per cent; on the body, the area of a disc.

    Raises
    ------
    InputError
        If the library is empty or nothing in it moves.
    """
    energies = [values.sum(axis=0) for values in (library.linear_energies, library.rotational_energies)]
    if any(not one.sum() > 0.0 for one in energies):
        raise InputError("nothing moves in the library", where=library.name, remedy="add takes")
    shares = [100.0 * one / one.sum() for one in energies]
    with style.in_style():
        figure = style.sheet(
            width_mm=style.PAGE_MM, height_mm=92.0, simulated=False, synthetic=library.is_synthetic
        )
        panels = figure.subplots(1, 4, width_ratios=(1.0, 1.15, 1.15, 1.0))
        for side, share in enumerate(shares):
            _draw_body(panels[3 * side], share)
            _draw_bars(panels[1 + side], share)
            panels[1 + side].set_title(_TITLES[side], fontweight="bold")
            panels[1 + side].set_xlabel("Share (%)")
        panels[2].set_yticklabels([])
        figure.legend(handles=_signs(), loc="outside lower center", ncols=3)
    return figure


def _draw_body(axes: Axes, shares: Floats) -> None:
    places = body.standing()
    for bone in body.BONES:
        axes.plot(*places[list(bone)].T, color=style.FAINT, linewidth=2.0, zorder=1)
    drawn = axes.scatter(
        places[:, 0],
        places[:, 1],
        s=0.2 + 13.0 * shares,
        color=style.INK,
        alpha=0.72,
        linewidths=0.0,
        zorder=2,
    )
    drawn.set_gid("joints")
    body.draw_head(axes, places[body.HEAD], edge=style.FAINT, linewidth=1.2)
    body.name_sides(axes, places)


def _draw_bars(axes: Axes, shares: Floats) -> None:
    style.rule(axes, at="x")
    for row, kind in enumerate(_KINDS):
        if kind in JOINT_NAMES:
            axes.barh(row, shares[JOINT_NAMES.index(kind)], height=0.62, color=style.FAINT, gid=kind)
            continue
        for side, shift, face in (("left", -0.19, style.INK), ("right", 0.19, "white")):
            name = f"{side}_{kind}"
            axes.barh(
                row + shift, shares[JOINT_NAMES.index(name)], height=0.36, color=face,
                edgecolor=style.INK, linewidth=0.6, gid=name,
            )  # fmt: skip
    axes.set_yticks(range(len(_KINDS)), [kind.capitalize() for kind in _KINDS])
    axes.set_ylim(len(_KINDS) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0.0)
    axes.margins(x=0.04)


def _signs() -> list[object]:
    from matplotlib.patches import Patch

    return [
        Patch(facecolor=style.INK, edgecolor=style.INK, linewidth=0.6, label="left"),
        Patch(facecolor="white", edgecolor=style.INK, linewidth=0.6, label="right"),
        Patch(color=style.FAINT, label="middle"),
    ]
