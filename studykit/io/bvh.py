"""Biovision Hierarchy (BVH): the text format of most motion capture."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.io.packed import read_lines
from studykit.io.skeletal_take import SkeletalTake
from studykit.motion import rotation
from studykit.motion.motion import Motion

MOST_JOINTS = 1000
MOST_NUMBERS = 100_000_000
"""No take holds more (an hour of 24 joints at 120 Hz has 32 million); what says so is not a take."""
LARGEST = 1e7
"""No angle in degrees and no length in any unit in use is larger."""

_AGAIN = "export the take again"
_CHANNELS = {f"{axis}{kind}".lower(): f"{axis}{kind}" for axis in "XYZ" for kind in ("position", "rotation")}
_POSITIONS = ("Xposition", "Yposition", "Zposition")


@dataclass(slots=True)
class _Joint:
    name: str
    parent: int
    offset: tuple[float, ...] = (0.0, 0.0, 0.0)
    channels: tuple[str, ...] = ()


def read_bvh(path: Path) -> SkeletalTake:
    """Read a BVH file, plain or packed (.xz, .gz).

    Raises
    ------
    InputError
        If the file is empty, cut off or not BVH; names the file and the line.

    Notes
    -----
    Position channels of the root add to its OFFSET: the offset is where the root stands at rest, and its
    channels move it from there. Most programs write an offset of zero, so that nothing depends on it; where
    one writes the place of the first frame into both, the whole take is displaced by a constant, and no pose
    or movement is changed. Below the root position channels stand in place of the OFFSET, since the programs
    that write them there (MotionBuilder among others) give the whole way from the parent.
    """
    lines = read_lines(path)
    if not any(line.strip() for line in lines):
        raise InputError("the file is empty", where=path, remedy=_AGAIN)
    joints, motion_line = _read_hierarchy(path, lines)
    frame_time, values = _read_frames(path, lines, motion_line, joints)

    rotations = rotation.identity(len(values), len(joints))
    root_positions = np.tile(np.array(joints[0].offset), (len(values), 1))
    shifts: dict[int, Floats] = {}
    column = 0
    for number, joint in enumerate(joints):
        columns = {name: column + place for place, name in enumerate(joint.channels)}
        turns = [name for name in joint.channels if name.endswith("rotation")]
        if turns:
            angles = np.deg2rad(values[:, [columns[name] for name in turns]])
            rotations[:, number] = turned_in_order("".join(name[0] for name in turns), angles)
        if number == 0:
            for axis, name in enumerate(_POSITIONS):
                if name in columns:
                    root_positions[:, axis] += values[:, columns[name]]
        elif columns.keys() >= set(_POSITIONS):
            shifts[number] = values[:, [columns[name] for name in _POSITIONS]]
        column += len(joint.channels)
    return SkeletalTake(
        path=path,
        joint_names=tuple(joint.name for joint in joints),
        parents=tuple(joint.parent for joint in joints),
        offsets=np.array([joint.offset for joint in joints]),
        rotations=rotations,
        root_positions=root_positions,
        frame_rate_hz=1.0 / frame_time,
        shifts=shifts,
    )


def turned_in_order(axes: str, angles: Floats) -> Floats:
    """Give the rotations of angles about moving axes, any number of them, the first listed outermost.

    Parameters
    ----------
    axes : str
        Letters of X, Y and Z.
    angles : ndarray, shape (..., axis), rad
    """
    turned = rotation.identity(*angles.shape[:-1])
    for column, axis in enumerate(axes):
        half = 0.5 * angles[..., column]
        about = np.zeros((*half.shape, 4))
        about[..., 0], about[..., 1 + "XYZ".index(axis)] = np.cos(half), np.sin(half)
        turned = rotation.multiply(turned, about) if column else about
    return turned


def _read_hierarchy(path: Path, lines: list[str]) -> tuple[list[_Joint], int]:
    """Read the skeleton; give its joints and the number of the line that says MOTION."""
    joints: list[_Joint] = []
    known: set[str] = set()
    open_joints: list[int | None] = []  # None stands for an end site
    pending: int | None = None
    for number, words in _statements(lines):
        match words:
            case ["HIERARCHY"]:
                continue
            case ["ROOT" | "JOINT", name, *rest] if open_joints or not joints:
                pending = len(joints)
                parent = _parent(open_joints, path, number)
                joints.append(_Joint(name=" ".join((name, *rest)), parent=parent))
                _check_new(joints[-1].name, known, path, number)
            case ["End", *_]:
                pending = None
            case ["{"]:
                open_joints.append(pending)
            case ["}"] if open_joints:
                open_joints.pop()
            case ["OFFSET", *numbers] if open_joints:
                _set_offset(joints, open_joints[-1], numbers, path, number)
            case ["CHANNELS", count, *names] if open_joints and open_joints[-1] is not None:
                joints[open_joints[-1]].channels = _checked_channels(count, names, path, number)
            case ["MOTION"] if joints and not open_joints:
                return joints, number
            case _:
                raise _broken(f"not BVH: {lines[number - 1].strip()[:40]!r}", path, number)
    raise _broken("the file ends before its motion", path, len(lines))


def _statements(lines: list[str]) -> Iterator[tuple[int, list[str]]]:
    """Give the words of each line and its number; a brace on a joint's own line comes by itself."""
    for number, line in enumerate(lines, start=1):
        words = line.split()
        if len(words) > 1 and words[-1] == "{" and words[0] in ("ROOT", "JOINT", "End"):
            yield number, words[:-1]
            yield number, ["{"]
        elif words:
            yield number, words


def _broken(problem: str, path: Path, number: int) -> InputError:
    return InputError(problem, where=f"{path}, line {number}", remedy=_AGAIN)


def _check_new(name: str, known: set[str], path: Path, number: int) -> None:
    if name in known:
        raise _broken(f"a second joint called {name[:40]!r}", path, number)
    known.add(name)
    if len(known) > MOST_JOINTS:
        raise _broken(f"more than {MOST_JOINTS} joints", path, number)


def _parent(open_joints: list[int | None], path: Path, number: int) -> int:
    parent = open_joints[-1] if open_joints else -1
    if parent is None:
        raise _broken("a joint inside an end site", path, number)
    return parent


def _checked_channels(count: str, names: list[str], path: Path, number: int) -> tuple[str, ...]:
    if count != str(len(names)):
        raise _broken(f"{count[:12]} channels promised, {len(names)} named", path, number)
    if len(names) > len(_CHANNELS):
        raise _broken(f"{len(names)} channels in one joint", path, number)
    known = tuple(_CHANNELS[name.lower()] for name in names if name.lower() in _CHANNELS)
    if len(set(known)) != len(names):
        raise _broken(f"channels {' '.join(names)[:80]}, not all known", path, number)
    return known


def _set_offset(joints: list[_Joint], joint: int | None, numbers: list[str], path: Path, number: int) -> None:
    try:
        offset = tuple(float(one) for one in numbers)
    except ValueError:
        offset = ()
    if len(offset) != 3 or not all(abs(one) <= LARGEST for one in offset):
        raise _broken("an OFFSET needs three numbers", path, number)
    if joint is not None:
        joints[joint].offset = offset


def _read_frames(
    path: Path, lines: list[str], motion_line: int, joints: list[_Joint]
) -> tuple[float, Floats]:
    """Read the frames below MOTION; give the frame time (s) and the values, shape (frame, channel)."""
    channels = sum(len(joint.channels) for joint in joints)
    below = [(n, line) for n, line in enumerate(lines[motion_line:], motion_line + 1) if line.strip()]
    place = f"{path}, line {below[0][0] if below else motion_line + 1}"
    head = [line.replace(":", " ").split() for _, line in below[:2]]
    rows = below[2:]
    try:
        frames, frame_time = int(head[0][-1]), float(head[1][-1])
    except (IndexError, ValueError):
        raise InputError("no number of frames or no frame time", where=place, remedy=_AGAIN) from None
    if frames < 1 or not 1.0 / LARGEST <= frame_time <= LARGEST:
        raise InputError("no frames, or no frame time above zero", where=place, remedy=_AGAIN)
    if len(rows) != frames:
        raise InputError(f"{head[0][-1][:12]} frames promised, {len(rows)} found", where=place, remedy=_AGAIN)
    if not channels or frames * max(channels, 4 * len(joints)) > MOST_NUMBERS:
        problem = f"{frames} frames of {len(joints)} joints with {channels} channels are no take"
        raise InputError(problem, where=place, remedy=_AGAIN)
    # NumPy's fastest reader of numbers, and the one that keeps no word in memory; it does not see lines.
    values = np.empty(0)
    if all(len(line.split()) == channels for _, line in rows):
        with suppress(ValueError, DeprecationWarning), warnings.catch_warnings(action="error"):
            values = np.fromstring("\n".join(line for _, line in rows), sep=" ", dtype=np.float64)
    if values.size != frames * channels or not np.all(np.abs(values) <= LARGEST):
        for number, line in rows:
            if not _is_row(line, channels):
                problem = f"not {channels} finite numbers"
                raise InputError(problem, where=f"{path}, line {number}", remedy=_AGAIN)
        values = np.array([line.split() for _, line in rows], dtype=np.float64)  # such as digits of Arabic
    return frame_time, values.reshape(frames, channels)


def _is_row(line: str, channels: int) -> bool:
    try:
        values = np.array(line.split(), dtype=np.float64)
    except ValueError:
        return False
    return len(values) == channels and bool(np.all(np.abs(values) <= LARGEST))


def bvh_text(motion: Motion) -> str:
    """Write a motion as BVH: centimetres, degrees, Y up, as Blender and MotionBuilder read it."""
    skeleton = motion.skeleton
    out = ["HIERARCHY"]
    opened: list[int] = []  # the order of the channels: joints as they are opened, depth first

    def joint(number: int, depth: int) -> None:
        opened.append(number)
        pad = "\t" * depth
        out.append(f"{pad}{'JOINT' if depth else 'ROOT'} {skeleton.joint_names[number]}")
        x, y, z = 100.0 * skeleton.offsets[number]
        out.extend((f"{pad}{{", f"{pad}\tOFFSET {x:.4f} {y:.4f} {z:.4f}"))
        position = "" if depth else "Xposition Yposition Zposition "
        out.append(f"{pad}\tCHANNELS {3 if depth else 6} {position}Zrotation Xrotation Yrotation")
        children = skeleton.children(number)
        for child in children:
            joint(child, depth + 1)
        if not children:
            out.extend(
                (f"{pad}\tEnd Site", f"{pad}\t{{", f"{pad}\t\tOFFSET {x:.4f} {y:.4f} {z:.4f}", f"{pad}\t}}")
            )
        out.append(f"{pad}}}")

    joint(0, 0)
    # Angles go on beyond half a turn: programs that draw curves through them would else spin the joint back.
    angles = np.unwrap(rotation.to_euler("ZXY", motion.rotations[:, opened]), axis=0)
    values = np.concatenate(
        (100.0 * motion.root_positions, np.rad2deg(angles).reshape(len(motion), -1)), axis=1
    )
    out.extend(("MOTION", f"Frames: {len(motion)}", f"Frame Time: {1.0 / motion.frame_rate_hz:.12f}"))
    form = " ".join(["%.4f"] * values.shape[1])
    out.extend(form % tuple(row) for row in values.tolist())
    return "\n".join(out) + "\n"
