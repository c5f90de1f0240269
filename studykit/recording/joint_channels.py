"""Which columns of a Motion-BIDS file hold which joint, in which unit and along which axes."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.motion.skeleton import JOINT_NAMES
from studykit.recording import bids_lookup

JOINTS_FILE = "code/joints.toml"
"""Where a study names its tracked points, if their names are not known: ``their_name = "our_name"``."""

# Only names that mean the same joint wherever they are used; a "leg" or an "arm" begins at either end.
_MIDDLE = {
    "pelvis": "pelvis",
    "hips": "pelvis",
    "midhip": "pelvis",
    "root": "pelvis",
    "waist": "pelvis",
    "spinebase": "pelvis",
    "spine1": "spine1",
    "spine2": "spine2",
    "spine3": "spine3",
    "spinemid": "spine2",
    "spinenavel": "spine2",
    "spinechest": "spine3",
    "spineshoulder": "spine3",
    "chest": "spine3",
    "neck": "neck",
    "head": "head",
}
_SIDED = {"clavicle": "collar", "collar": "collar"} | {
    name: name for name in ("hip", "knee", "ankle", "foot", "shoulder", "elbow", "wrist", "hand")
}
_SIDES = {"left": "left", "l": "left", "right": "right", "r": "right"}
_BETWEEN = {"pelvis": ("left_hip", "right_hip"), "neck": ("left_shoulder", "right_shoulder")}
_NEEDED = ("left_hip", "right_hip", "left_shoulder", "right_shoulder")

_METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001}
_SECONDS = {"s": 1.0, "ms": 0.001, "us": 1e-6}
_TOWARDS = {
    "L": (1.0, 0.0, 0.0),
    "R": (-1.0, 0.0, 0.0),
    "S": (0.0, 1.0, 0.0),
    "I": (0.0, -1.0, 0.0),
    "A": (0.0, 0.0, 1.0),
    "P": (0.0, 0.0, -1.0),
}


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class JointChannels:
    """How to read the columns of a motion file.

    Parameters
    ----------
    path : Path
        The table of channels that says so.
    columns : int
        How many there are.
    joints : mapping
        SMPL joint to its x, y and z columns, from 0, and the matrix, m per unit, that turns them into X to
        the left, Y up, Z to the front.
    time : tuple or None
        The column of the time since the first sample and its unit in s; None if there is none.
    """

    path: Path
    columns: int
    joints: Mapping[str, tuple[tuple[int, int, int], Floats]]
    time: tuple[int, float] | None

    def positions(self, values: Floats) -> Floats:
        """Give where all joints of `JOINT_NAMES` are, shape (frame, joint, 3), m; NaN where never tracked."""
        positions = np.full((len(values), len(JOINT_NAMES), 3), np.nan)
        for name, (columns, turn) in self.joints.items():
            positions[:, JOINT_NAMES.index(name)] = values[:, columns] @ turn.T
        for name, (left, right) in _BETWEEN.items():
            if name not in self.joints:
                sides = positions[:, [JOINT_NAMES.index(left), JOINT_NAMES.index(right)]]
                positions[:, JOINT_NAMES.index(name)] = sides.mean(axis=1)
        return positions


def joint_named(name: str) -> str | None:
    """Find the joint of `JOINT_NAMES` that a tracked point's name means; None if it is not known.

    Examples
    --------
    >>> joint_named("ShoulderLeft"), joint_named("R_Knee"), joint_named("SPINE_CHEST"), joint_named("nose")
    ('left_shoulder', 'right_knee', 'spine3', None)
    """
    words = re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+", name)
    sides = {_SIDES[word.lower()] for word in words if word.lower() in _SIDES}
    place = "".join(word.lower() for word in words if word.lower() not in _SIDES)
    if not sides:
        return _MIDDLE.get(place)
    return f"{sides.pop()}_{_SIDED[place]}" if len(sides) == 1 and place in _SIDED else None


def joint_channels(motion: Path, root: Path) -> JointChannels | None:
    """Find the columns of the joints in a motion file.

    Parameters
    ----------
    motion : Path
        A ``*_motion.tsv``.
    root : Path
        The data set.

    Returns
    -------
    JointChannels or None
        None if the file holds no positions at all, as that of another tracking system.

    Raises
    ------
    InputError
        If hips and shoulders are not among the joints, or a unit or axis is not told.
    """
    found = bids_lookup.about(motion, root, "channels.tsv")
    if not found:
        raise InputError("no table says what the columns are", where=motion, remedy="add its *_channels.tsv")
    path, table = found[-1], bids_lookup.rows(found[-1])
    own_names, frames = _own_names(root), _frames(motion, root)
    places: dict[str, dict[str, int]] = {}
    turns: dict[str, Floats] = {}
    time: tuple[int, float] | None = None
    has_positions = False
    for column, row in enumerate(table):
        kind = (row.get("type") or "").upper()
        if kind == "LATENCY":
            time = column, _unit(row, _SECONDS, path, column + 2)
        if kind != "POS":
            continue
        has_positions = True
        point = row.get("tracked_point") or ""
        joint = own_names.get(point) or joint_named(point)
        if joint is not None:
            places.setdefault(joint, {})[(row.get("component") or "").lower()] = column
            turns[joint] = _unit(row, _METRES, path, column + 2) * _axes(row, frames, path)
    if not has_positions:
        return None
    joints = {
        name: ((columns["x"], columns["y"], columns["z"]), turns[name])
        for name, columns in places.items()
        if columns.keys() >= set("xyz")
    }
    missing = [name for name in _NEEDED if name not in joints]
    if missing:
        raise InputError(
            f"no tracked_point is known as {', '.join(missing)}",
            where=path,
            remedy=f'name the points in {root / JOINTS_FILE}, such as Thigh_L = "left_hip"',
        )
    return JointChannels(path=path, columns=len(table), joints=joints, time=time)


def _own_names(root: Path) -> dict[str, str]:
    """Read the study's own names for joints, if it brings some."""
    import tomllib

    path = root / JOINTS_FILE
    if not path.exists():
        return {}
    try:
        names = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"this is no TOML ({error})", where=path, remedy="put it right") from error
    for theirs, ours in names.items():
        if ours not in JOINT_NAMES:
            raise InputError(
                f'"{ours}" is no joint',
                where=f"{path}, {theirs}",
                remedy=f"use one of: {', '.join(JOINT_NAMES)}",
            )
    return names


def _unit(row: bids_lookup.Row, known: Mapping[str, float], path: Path, line: int) -> float:
    unit = row.get("units") or ""
    if unit not in known:
        raise InputError(
            f'"units" is "{unit or "n/a"}"',
            where=f"{path}, line {line}",
            remedy=f"use one of: {', '.join(known)}",
        )
    return known[unit]


def _frames(motion: Path, root: Path) -> Mapping[str, str]:
    """Give each frame of reference with where its axes point, as far as told."""
    told = bids_lookup.description(motion, root, "channels.json").get("reference_frame", {})
    levels = told.get("Levels", {}) if isinstance(told, dict) else {}
    return {name: level.get("SpatialAxes", "") for name, level in levels.items() if isinstance(level, dict)}


def _axes(row: bids_lookup.Row, frames: Mapping[str, str], path: Path) -> Floats:
    """Give the matrix whose columns are where the file's x, y and z point."""
    frame = row.get("reference_frame") or ""
    turn = np.array([_TOWARDS[letter] for letter in frames.get(frame, "").upper() if letter in _TOWARDS]).T
    if turn.shape != (3, 3) or abs(np.linalg.det(turn)) < 0.5:
        raise InputError(
            f'where the axes of the reference_frame "{frame or "n/a"}" point is not told',
            where=path.with_suffix(".json"),
            remedy='write it in reference_frame.Levels.*.SpatialAxes, such as "LSA": x left, y up, z front',
        )
    return np.asarray(turn)
