"""Bodies drawn as sticks: as they stand, or as they pose."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.core.arrays import Floats
from studykit.figures import style
from studykit.motion import kinematics, rotation
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable

VIEW_RAD = float(np.deg2rad(25.0))
"""A quarter view: kicks towards the viewer stay visible."""
BONES = tuple((parent, joint) for joint, parent in enumerate(NEUTRAL_BODY.parents) if parent >= 0)
HEAD = NEUTRAL_BODY.index("head")

_HEAD_RADIUS_M = 0.10
_HEAD_RISE_M = 0.05
_LOWERED_ARM_RAD = 1.05
# The palest part is cut off: it would vanish on paper.
_SHADES = (0.08, 0.92)


def standing() -> Floats:
    """Give a body that stands with lowered arms, seen from the front, shape (24, 2), m.

    The dancer's left is on the right.
    """
    rest = rotation.identity(24)
    for name, sign in (("left_shoulder", -1.0), ("right_shoulder", 1.0)):
        rest[JOINT_NAMES.index(name)] = rotation.exp(np.array([0.0, 0.0, sign * _LOWERED_ARM_RAD]))
    return kinematics.centred_positions(NEUTRAL_BODY, rest)[:, :2]


def seen(positions: Floats) -> tuple[Floats, Floats]:
    """Look at bodies from a quarter to their front.

    Parameters
    ----------
    positions : ndarray, shape (..., 24, 3), m
        Joints of bodies that face +Z.

    Returns
    -------
    screen : ndarray, shape (..., 24, 2), m
        Across and up.
    depth : ndarray, shape (..., 24), m
        Higher is nearer.
    """
    flat = positions[..., [0, 2]]
    across, near = (np.cos(VIEW_RAD), -np.sin(VIEW_RAD)), (np.sin(VIEW_RAD), np.cos(VIEW_RAD))
    return np.stack((flat @ across, positions[..., 1]), axis=-1), flat @ near


def draw_body(
    axes: Axes,
    screen: Floats,
    shades: Any,
    *,
    depth: Floats | None = None,
    outlines: Any = style.INK,
    widths_pt: tuple[float, Any] = (2.3, 0.45),
) -> None:
    """Draw a body of which each half of a bone has the colour of its joint.

    Parameters
    ----------
    screen : ndarray, shape (24, 2)
        Where the joints are on the axes.
    shades, outlines : sequence of colours, one a joint, or one colour
        Of bones and of their rims.
    depth : ndarray, shape (24,), optional
        Nearer bones, of higher depth, are drawn over others.
    widths_pt : tuple of float and of float or one a joint
        Thickness of bones without their rims, and that of rims, in points.
    """
    from matplotlib.collections import LineCollection

    order = BONES if depth is None else sorted(BONES, key=lambda bone: float(depth[list(bone)].sum()))
    joints = [joint for bone in order for joint in bone]
    lines = [
        (screen[near], (screen[near] + screen[far]) / 2.0)
        for bone in order
        for near, far in (bone, bone[::-1])
    ]
    width_pt, rim_pt = widths_pt
    rims = 2.0 * np.broadcast_to(np.asarray(rim_pt, dtype=float), len(JOINT_NAMES))
    for colours, widths in ((outlines, width_pt + rims[joints]), (shades, width_pt)):
        picked = colours if isinstance(colours, str) else [colours[joint] for joint in joints]
        axes.add_collection(LineCollection(lines, colors=picked, linewidths=widths, capstyle="round"))


def draw_head(
    axes: Axes,
    place: Floats,
    *,
    face: Any = "none",
    edge: Any = style.INK,
    linewidth: float = 0.5,
    scale: tuple[float, float] = (1.0, 1.0),
) -> None:
    """Draw a head at its joint; `scale` says how many units of each axis a metre takes."""
    from matplotlib.patches import Ellipse

    axes.add_patch(
        Ellipse(
            (float(place[0]), float(place[1]) + _HEAD_RISE_M * scale[1]),
            2.0 * _HEAD_RADIUS_M * scale[0],
            2.0 * _HEAD_RADIUS_M * scale[1],
            facecolor=face,
            edgecolor=edge,
            linewidth=linewidth,
            zorder=3,
        )
    )


def name_sides(axes: Axes, places: Floats) -> None:
    """Write R and L beside the hands of a standing body, and let nothing but the body be seen."""
    for words, name, shift in (("R", "right_hand", -0.13), ("L", "left_hand", 0.13)):
        place = places[JOINT_NAMES.index(name)]
        axes.text(place[0] + shift, place[1] - 0.12, words, ha="center", color=style.FAINT)
    axes.set_aspect("equal")
    axes.margins(0.12)
    axes.set_axis_off()


def shades(highest: float, *, power: float = 0.5) -> ScalarMappable:
    """Give the colours of intensities from 0 to the highest; the square root lets the light ones show."""
    import matplotlib as mpl
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, PowerNorm

    colours = mpl.colormaps[style.INTENSITY_MAP](np.linspace(*_SHADES, 256))
    return ScalarMappable(
        PowerNorm(power, vmin=0.0, vmax=highest), LinearSegmentedColormap.from_list("intensity", colours)
    )


def topmost(joints: Sequence[str]) -> tuple[str, ...]:
    """Leave out the joints that hang on another of the list, and write the rest as words.

    Examples
    --------
    >>> topmost(["right_elbow", "right_wrist", "right_hand", "left_hip"])
    ('left hip', 'right elbow')
    """
    numbers = sorted(JOINT_NAMES.index(name) for name in joints)
    return tuple(
        JOINT_NAMES[joint].replace("_", " ")
        for joint in numbers
        if NEUTRAL_BODY.parents[joint] not in numbers
    )
