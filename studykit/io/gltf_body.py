"""An avatar: the surface of a simple, well-proportioned body around the 24 joints, and what moves it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from studykit.core.arrays import Floats, Integers
from studykit.motion.skeleton import Skeleton

_AROUND = 20
"""Vertices in a ring."""
_BETWEEN = 3
"""Rings from one station to the next."""
_DOME = 4
"""Rings in a rounded end."""
_BEND_M = 0.045
"""On either side of a joint, how far the surface bends with it."""

_Station = tuple[str, str, float, tuple[int, int, int], tuple[int, int]]


@dataclass(frozen=True, kw_only=True, slots=True)
class _Tube:
    """A rounded tube along X, Y or Z of the rest pose.

    Parameters
    ----------
    axis : int
        0 (its sections lie along Y and Z), 1 (X and Z) or 2 (X and Y).
    moved_by : tuple of str
        Joints in the order in which the tube passes them; a tube that begins before the first goes with it.
    stations : tuple
        Of each: two joints, the share of the way between them, a shift from there (x, y, z) and the half
        widths of the section along its two axes, mm.
    domes : tuple of int, mm
        How far the rounded ends stand out.
    """

    axis: int
    moved_by: tuple[str, ...]
    stations: tuple[_Station, ...]
    domes: tuple[int, int]


_MIDDLE = (
    _Tube(
        axis=1,
        moved_by=("pelvis", "spine1", "spine2", "spine3"),
        stations=(
            ("pelvis", "spine1", 0.0, (0, -95, -12), (128, 98)),
            ("pelvis", "spine1", 0.0, (0, -40, -20), (162, 116)),
            ("pelvis", "spine1", 0.0, (0, 30, -14), (153, 106)),
            ("pelvis", "spine1", 1.0, (0, 0, 14), (134, 94)),
            ("spine1", "spine2", 0.7, (0, 0, 14), (136, 98)),
            ("spine2", "spine3", 1.0, (0, 0, -16), (150, 110)),
            ("spine3", "neck", 0.3, (0, 0, -8), (160, 114)),
            ("spine3", "neck", 0.55, (0, 0, -6), (148, 98)),
            ("spine3", "neck", 0.75, (0, 0, -2), (112, 78)),
            ("spine3", "neck", 0.9, (0, 0, 2), (70, 60)),
        ),
        domes=(45, 10),
    ),
    _Tube(
        axis=1,
        moved_by=("spine3", "neck", "head"),
        stations=(
            ("neck", "head", 0.0, (0, -50, 4), (62, 60)),
            ("neck", "head", 0.0, (0, 0, 10), (55, 56)),
            ("neck", "head", 0.7, (0, 0, 0), (52, 57)),
            ("head", "head", 0.0, (0, 0, 16), (54, 68)),
            ("head", "head", 0.0, (0, 28, 24), (66, 87)),
            ("head", "head", 0.0, (0, 75, 22), (74, 98)),
            ("head", "head", 0.0, (0, 120, 16), (75, 97)),
            ("head", "head", 0.0, (0, 152, 12), (66, 86)),
            ("head", "head", 0.0, (0, 178, 9), (50, 66)),
            ("head", "head", 0.0, (0, 194, 7), (31, 42)),
        ),
        domes=(10, 8),
    ),
    _Tube(
        axis=2,
        moved_by=("head",),
        stations=(
            ("head", "head", 0.0, (0, 64, 94), (18, 36)),
            ("head", "head", 0.0, (0, 56, 114), (15, 27)),
            ("head", "head", 0.0, (0, 48, 126), (12, 15)),
        ),
        domes=(8, 6),
    ),
)
_SIDED = (
    _Tube(
        axis=1,
        moved_by=("pelvis", "hip", "knee", "ankle"),
        stations=(
            ("hip", "knee", 0.0, (4, 40, -6), (72, 84)),
            ("hip", "knee", 0.0, (12, -10, -4), (84, 92)),
            ("hip", "knee", 0.2, (8, 0, 4), (82, 88)),
            ("hip", "knee", 0.5, (2, 0, 6), (71, 76)),
            ("hip", "knee", 0.8, (0, 0, 4), (57, 61)),
            ("hip", "knee", 1.0, (0, 0, 4), (53, 57)),
            ("knee", "ankle", 0.15, (0, 0, -4), (53, 57)),
            ("knee", "ankle", 0.35, (2, 0, -8), (55, 60)),
            ("knee", "ankle", 0.65, (0, 0, 0), (42, 46)),
            ("knee", "ankle", 0.88, (0, 0, 4), (34, 39)),
            ("knee", "ankle", 1.0, (0, 0, 6), (35, 42)),
        ),
        domes=(30, 30),
    ),
    _Tube(
        axis=2,
        moved_by=("ankle", "foot"),
        stations=(
            ("ankle", "ankle", 0.0, (0, -44, -34), (32, 36)),
            ("ankle", "ankle", 0.0, (0, -38, 10), (37, 42)),
            ("ankle", "foot", 0.6, (2, -15, 0), (43, 35)),
            ("ankle", "foot", 1.0, (2, -3, 0), (48, 26)),
            ("foot", "foot", 0.0, (-3, -9, 45), (44, 20)),
        ),
        domes=(26, 26),
    ),
    _Tube(
        axis=0,
        moved_by=("spine3", "collar", "shoulder", "elbow", "wrist", "hand"),
        stations=(
            ("collar", "shoulder", -0.3, (0, -8, 2), (44, 54)),
            ("collar", "shoulder", 0.4, (0, -10, 2), (48, 54)),
            ("shoulder", "elbow", 0.0, (0, -8, 0), (51, 53)),
            ("shoulder", "elbow", 0.2, (0, -4, 0), (52, 51)),
            ("shoulder", "elbow", 0.5, (0, 0, 2), (47, 47)),
            ("shoulder", "elbow", 0.85, (0, 0, 0), (39, 40)),
            ("elbow", "wrist", 0.0, (0, 0, 0), (37, 40)),
            ("elbow", "wrist", 0.25, (0, 0, 2), (38, 43)),
            ("elbow", "wrist", 0.7, (0, 0, 0), (29, 33)),
            ("elbow", "wrist", 1.0, (0, 0, 0), (21, 29)),
            ("wrist", "hand", 0.4, (0, 0, 2), (19, 36)),
            ("wrist", "hand", 1.0, (0, 0, 2), (16, 43)),
            ("hand", "hand", 0.0, (48, -2, 2), (12, 38)),
            ("hand", "hand", 0.0, (78, -4, 2), (9, 27)),
        ),
        domes=(20, 16),
    ),
    _Tube(
        axis=2,
        moved_by=("wrist",),
        stations=(
            ("wrist", "hand", 0.35, (0, -4, 28), (20, 15)),
            ("wrist", "hand", 0.75, (8, -6, 48), (17, 12)),
            ("wrist", "hand", 1.0, (6, -8, 72), (14, 10)),
        ),
        domes=(8, 12),
    ),
)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class BodyMesh:
    """The surface of a body in its rest pose, the pelvis at the origin.

    Parameters
    ----------
    vertices, normals : ndarray, shape (vertex, 3), m
        Points of the surface, and the directions in which it faces there.
    joints : ndarray, shape (vertex, 2)
        The one or two joints that move a vertex.
    weights : ndarray, shape (vertex, 2)
        Their shares, of sum 1.
    triangles : ndarray, shape (triangle, 3)
        Vertices, anticlockwise as seen from outside.
    triangle_joints : ndarray, shape (triangle,)
        The joint to whose limb a triangle belongs.
    """

    vertices: Floats
    normals: Floats
    joints: Integers
    weights: Floats
    triangles: Integers
    triangle_joints: Integers


def body_mesh(skeleton: Skeleton) -> BodyMesh:
    """Build the surface of a body with SMPL's 24 joints and the girths of a lean adult.

    Notes
    -----
    Rounded tubes along trunk, neck and head, arms and legs, which overlap where limbs meet. Along a tube the
    surface goes with one joint after the other, with a smooth change of hand around each, so that elbows and
    knees bend without a crease. The right side mirrors the left.
    """
    rest = np.zeros_like(skeleton.offsets)
    for joint, parent in enumerate(skeleton.parents[1:], start=1):
        rest[joint] = rest[parent] + skeleton.offsets[joint]
    places = dict(zip(skeleton.joint_names, rest, strict=True))
    parts = [_surface(tube, places, skeleton) for tube in _MIDDLE]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        own = {name.removeprefix(f"{side}_"): name for name in places}
        parts += [_surface(tube, places, skeleton, own=own, sign=sign) for tube in _SIDED]
    firsts = np.cumsum([0] + [len(part.vertices) for part in parts[:-1]])
    return BodyMesh(
        vertices=np.concatenate([part.vertices for part in parts]),
        normals=np.concatenate([part.normals for part in parts]),
        joints=np.concatenate([part.joints for part in parts]),
        weights=np.concatenate([part.weights for part in parts]),
        triangles=np.concatenate([part.triangles + first for part, first in zip(parts, firsts, strict=True)]),
        triangle_joints=np.concatenate([part.triangle_joints for part in parts]),
    )


def _surface(
    tube: _Tube,
    places: dict[str, Floats],
    skeleton: Skeleton,
    *,
    own: dict[str, str] | None = None,
    sign: float = 1.0,
) -> BodyMesh:
    """Build one tube; `own` gives the full names of a side's joints."""
    names = own or {name: name for name in places}
    vertices, triangles = _rounded(_sections(tube, places, names, sign), tube)
    moved_by = [names[name] for name in tube.moved_by]
    joints = np.array([skeleton.index(name) for name in (*moved_by, moved_by[0])])  # the last moves nothing
    along = np.array([places[name][tube.axis] for name in moved_by])
    onward = float(np.sign(vertices[-1, tube.axis] - vertices[0, tube.axis]))
    shares = np.pad(_shares(onward * vertices[:, tube.axis], onward * along), ((0, 0), (0, 1)))
    strongest = np.argsort(-shares, axis=1, kind="stable")[:, :2]
    corners = onward * vertices[triangles, tube.axis]
    middles = 0.5 * (corners.min(axis=1) + corners.max(axis=1))  # the same for both triangles of a square
    owners = _shares(middles, onward * along).argmax(axis=1)
    return BodyMesh(
        vertices=vertices,
        normals=_normals(vertices, triangles),
        joints=joints[strongest],
        weights=np.take_along_axis(shares, strongest, axis=1),
        triangles=triangles,
        triangle_joints=joints[owners],
    )


def _sections(tube: _Tube, places: dict[str, Floats], names: dict[str, str], sign: float) -> Floats:
    """Give the sections of a tube: centre (x, y, z) and half widths, shape (section, 5), m.

    They follow a Catmull-Rom curve through the stations.
    """
    rows = np.array(
        [
            (
                *(1.0 - share) * places[names[start]]
                + share * places[names[end]]
                + np.array(shift) * (sign * 1e-3, 1e-3, 1e-3),
                *(1e-3 * half for half in halves),
            )
            for start, end, share, shift, halves in tube.stations
        ]
    )
    padded = np.concatenate((2.0 * rows[:1] - rows[1:2], rows, 2.0 * rows[-1:] - rows[-2:-1]))
    before, here, there, after = (padded[k : len(padded) - 3 + k, None] for k in range(4))
    t = np.arange(_BETWEEN)[None, :, None] / _BETWEEN
    curve = here + 0.5 * t * (
        there
        - before
        + t * (2.0 * before - 5.0 * here + 4.0 * there - after + t * (3.0 * (here - there) + after - before))
    )
    return np.concatenate((curve.reshape(-1, 5), rows[-1:]))


def _rounded(sections: Floats, tube: _Tube) -> tuple[Floats, Integers]:
    """Give the vertices and triangles of a tube with rounded ends; the poles come first and last."""
    onward = np.sign(sections[-1, tube.axis] - sections[0, tube.axis])
    angles = 0.5 * np.pi * np.arange(_DOME) / _DOME
    domes = []
    for section, dome, way in ((sections[0], tube.domes[0], -onward), (sections[-1], tube.domes[1], onward)):
        rows = np.tile(section, (_DOME, 1))
        rows[:, 3:] *= np.cos(angles)[:, None]
        rows[:, tube.axis] += way * 1e-3 * dome * np.sin(angles)
        pole = section[:3].copy()
        pole[tube.axis] += way * 1e-3 * dome
        domes.append((rows[1:], pole))
    rows = np.concatenate((domes[0][0][::-1], sections, domes[1][0]))
    first, second = (axis for axis in range(3) if axis != tube.axis)
    turn = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    rings = np.repeat(rows[:, None, :3], _AROUND, axis=1)
    rings[..., first] += rows[:, None, 3] * np.cos(turn)
    rings[..., second] += rows[:, None, 4] * np.sin(turn)
    vertices = np.concatenate((domes[0][1][None], rings.reshape(-1, 3), domes[1][1][None]))

    ring = 1 + np.arange(len(rows) * _AROUND).reshape(len(rows), _AROUND)
    following = np.roll(ring, -1, axis=1)
    last = np.full(_AROUND, len(vertices) - 1)
    triangles = np.concatenate(
        (
            np.stack((np.zeros_like(last), ring[0], following[0]), axis=-1),
            np.stack((ring[:-1], ring[1:], following[:-1]), axis=-1).reshape(-1, 3),
            np.stack((following[:-1], ring[1:], following[1:]), axis=-1).reshape(-1, 3),
            np.stack((last, following[-1], ring[-1]), axis=-1),
        )
    )
    corners = vertices[triangles] - vertices.mean(axis=0)
    if np.linalg.det(corners).sum() < 0.0:  # six times the volume: negative if the surface is inside out
        triangles = triangles[:, ::-1]
    return vertices, triangles


def _shares(along: Floats, joints_along: Floats) -> Floats:
    """Give how much each joint of a tube moves its points, shape (point, joint), of sum 1."""
    gaps = np.diff(joints_along)
    room = 0.5 * np.minimum(gaps, np.append(gaps[1:], np.inf))
    half = np.minimum(room, _BEND_M)
    way = np.clip((along[:, None] - joints_along[1:] + half) / (2.0 * half), 0.0, 1.0)
    passed = np.pad(way * way * (3.0 - 2.0 * way), ((0, 0), (1, 1)))
    passed[:, 0] = 1.0
    return np.asarray(passed[:, :-1] - passed[:, 1:])


def _normals(vertices: Floats, triangles: Integers) -> Floats:
    """Give the mean direction of the triangles around each vertex, by their areas, of length 1."""
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    facing = np.cross(b - a, c - a)
    normals = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], facing)
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))
