"""Acclaim skeletons and motions (ASF, AMC): the format in which the CMU database was published."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.io.bvh import LARGEST, MOST_JOINTS, MOST_NUMBERS, turned_in_order
from studykit.io.packed import read_text
from studykit.io.skeletal_take import SkeletalTake
from studykit.motion import rotation

FRAME_RATE_HZ = 120.0
"""Of the CMU database, whose files do not say."""
INCH_M = 0.0254
"""Lengths are inches divided by the `length` that an ASF file names, 0.45 in the CMU database."""

_AGAIN = "copy the file again"
_ROOT_DOF = ("tx", "ty", "tz", "rx", "ry", "rz")

Line = tuple[int, list[str]]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class AsfSkeleton:
    """What an ASF file says of a performer, in metres.

    Parameters
    ----------
    names : tuple of str
        The bones, parents first, "root" before all; each names the joint at its near end.
    parents : tuple of int
        The parent of each, -1 for the root.
    offsets : ndarray, shape (bone, 3), m
        Where each joint lies from its parent's at rest, in the axes of the world.
    frames : ndarray, shape (bone, 4)
        The axes about which each bone is turned.
    dofs : tuple of tuple of str
        What an AMC row gives for each bone, such as ("rx", "rz"), in its order.
    unit_m : float
        What one unit of the root's way in the AMC file is.
    root_position : ndarray, shape (3,), m
        Where the root stands at rest.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Floats
    frames: Floats
    dofs: tuple[tuple[str, ...], ...]
    unit_m: float
    root_position: Floats


@dataclass(slots=True)
class _Bone:
    line: int
    name: str = ""
    vector: tuple[float, ...] = (0.0, 0.0, 0.0)
    length: float = 0.0
    axis: tuple[float, ...] = (0.0, 0.0, 0.0)
    axis_order: str = "XYZ"
    dof: tuple[str, ...] = ()


def read_asf(path: Path) -> AsfSkeleton:
    """Read a skeleton (.asf), plain or packed.

    Raises
    ------
    InputError
        If the file is no ASF; names the file and the line.
    """
    sections = _sections(path)
    units = {words[0].lower(): words[-1] for _, words in sections["units"] if len(words) == 2}
    (per_inch,) = _numbers([units.get("length", "1")], 1, path, sections["units"][0][0])
    if not per_inch > 0.0:
        place = f"{path}, line {sections['units'][0][0]}"
        raise InputError("the unit of length is no length", where=place, remedy=_AGAIN)
    unit_m = INCH_M / per_inch
    root, position = _root(path, sections["root"])
    bones = {bone.name: bone for bone in (root, *_bones(path, sections["bonedata"]))}
    parents = _parents(path, sections["hierarchy"], bones)
    names = tuple(parents)
    scale = 1.0 if units.get("angle", "deg").lower().startswith("rad") else np.radians(1.0)
    return AsfSkeleton(
        names=names,
        parents=tuple(names.index(parent) if parent else -1 for parent in parents.values()),
        offsets=np.array([_far_end(bones[parent]) if parent else np.zeros(3) for parent in parents.values()])
        * unit_m,
        frames=np.array([_turned(bones[n].axis_order, scale * np.array(bones[n].axis)) for n in names]),
        dofs=tuple(bones[name].dof for name in names),
        unit_m=unit_m,
        root_position=np.array(position) * unit_m,
    )


def read_asf_amc(amc: Path, asf: Path, *, frame_rate_hz: float | None = None) -> SkeletalTake:
    """Read a take (.amc) on its skeleton (.asf); lengths come out in metres.

    The rate is the one given, else what `:SAMPLES-PER-SECOND` says, else 120 frames a second.

    Raises
    ------
    InputError
        If a file is broken or the two do not belong together; names the file and the line.

    Notes
    -----
    A bone is turned by C M C^-1 against its parent, with C its own axes and M the turns about X, Y and Z in
    the order of its `dof`, the first applied first.
    """
    skeleton = read_asf(asf)
    keywords, rows = _rows(amc)
    numbers, degrees = _frames(amc, skeleton, rows), "RADIANS" not in keywords
    rotations = rotation.identity(len(numbers), len(skeleton.names))
    root_positions = np.tile(skeleton.root_position, (len(numbers), 1))
    column = 0
    for bone, dof in enumerate(skeleton.dofs):
        values = numbers[:, column : column + len(dof)]
        column += len(dof)
        turns = [place for place, name in enumerate(dof) if name[0] == "r"]
        if turns:
            angles = np.radians(values[:, turns]) if degrees else values[:, turns]
            moved = _turned("".join(dof[place][1] for place in turns), angles)
            frame = skeleton.frames[bone]
            rotations[:, bone] = rotation.multiply(rotation.multiply(frame, moved), rotation.inverse(frame))
        for place, name in enumerate(dof):
            if name[0] == "t":
                root_positions[:, "xyz".index(name[1])] += values[:, place] * skeleton.unit_m
    return SkeletalTake(
        path=amc,
        joint_names=skeleton.names,
        parents=skeleton.parents,
        offsets=skeleton.offsets,
        rotations=rotations,
        root_positions=root_positions,
        frame_rate_hz=_rate(amc, keywords) if frame_rate_hz is None else frame_rate_hz,
    )


def _turned(axes: str, angles: Floats) -> Floats:
    """Turn about fixed axes, the first listed first; angles of shape (..., axis), rad."""
    return turned_in_order(axes[::-1].upper(), angles[..., ::-1])


def _far_end(bone: _Bone) -> Floats:
    direction = np.array(bone.vector)
    return np.asarray(direction / max(float(np.linalg.norm(direction)), 1e-12) * bone.length)


# --- the skeleton ----------------------------------------------------------------------------------------


def _sections(path: Path) -> dict[str, list[Line]]:
    """Cut an ASF file at its keywords; comments and documentation fall out."""
    sections: dict[str, list[Line]] = {"units": [(1, [])]}
    current: list[Line] = []
    for number, line in enumerate(read_text(path).splitlines(), start=1):
        words = line.split("#")[0].split()
        if words and words[0].startswith(":"):
            current = sections.setdefault(words[0][1:].lower(), [])
            words = words[1:]
        if words:
            current.append((number, words))
    for keyword in ("root", "bonedata", "hierarchy"):
        if not sections.get(keyword):
            raise InputError(f"no ASF skeleton: there is no :{keyword}", where=path, remedy=_AGAIN)
    return sections


def _root(path: Path, lines: list[Line]) -> tuple[_Bone, tuple[float, ...]]:
    root = _Bone(line=lines[0][0], name="root", dof=_ROOT_DOF)
    position: tuple[float, ...] = (0.0, 0.0, 0.0)
    for number, (keyword, *words) in lines:
        match keyword.lower():
            case "order":
                root.dof = _dof(words, _ROOT_DOF, path, number)
            case "position":
                position = _numbers(words, 3, path, number)
            case "orientation" if any(_numbers(words, 3, path, number)):
                remedy = "export it with an orientation of 0 0 0"
                raise InputError("the root is turned at rest", where=f"{path}, line {number}", remedy=remedy)
    return root, position


def _bones(path: Path, lines: list[Line]) -> Iterator[_Bone]:
    bone: _Bone | None = None
    seen = {"root"}
    for number, (keyword, *words) in lines:
        if keyword == "begin":
            bone = _Bone(line=number)
        elif keyword == "end" and bone is not None:
            if not bone.name or bone.name in seen:
                problem = f"a second bone called {bone.name[:40]!r}" if bone.name else "a bone without a name"
                raise InputError(problem, where=f"{path}, line {bone.line}", remedy=_AGAIN)
            seen.add(bone.name)
            if len(seen) > MOST_JOINTS:
                problem = f"more than {MOST_JOINTS} bones"
                raise InputError(problem, where=f"{path}, line {bone.line}", remedy=_AGAIN)
            yield bone
            bone = None
        elif bone is not None:
            _set(bone, keyword, words, path, number)


def _set(bone: _Bone, keyword: str, words: list[str], path: Path, number: int) -> None:
    match keyword:
        case "name" if words:
            bone.name = words[0]
        case "direction":
            bone.vector = _numbers(words, 3, path, number)
        case "length":
            (bone.length,) = _numbers(words, 1, path, number)
        case "axis":
            bone.axis = _numbers(words[:3], 3, path, number)
            bone.axis_order = (words[3] if len(words) > 3 else "XYZ").upper()
            if sorted(bone.axis_order) != ["X", "Y", "Z"]:
                problem = f"axes in the order {bone.axis_order[:12]!r}"
                raise InputError(problem, where=f"{path}, line {number}", remedy=_AGAIN)
        case "dof":
            bone.dof = _dof(words, _ROOT_DOF[3:], path, number)


def _dof(words: list[str], allowed: tuple[str, ...], path: Path, number: int) -> tuple[str, ...]:
    dof = tuple(word.lower() for word in words)
    if len(set(dof)) != len(dof) or not set(dof) <= set(allowed):
        raise InputError(
            f"degrees of freedom {' '.join(words)[:40]!r}, not of {' '.join(allowed)}",
            where=f"{path}, line {number}",
            remedy="export bones that keep their lengths",
        )
    return dof


def _parents(path: Path, lines: list[Line], bones: dict[str, _Bone]) -> dict[str, str]:
    """Give the parent of every bone that hangs on the root, parents first."""
    parents = {"root": ""}
    for number, (parent, *children) in lines:
        if parent in ("begin", "end") and not children:
            continue
        for child in children:
            if parent not in parents or child in parents or child not in bones:
                problem = f"{child[:40]!r} cannot hang on {parent[:40]!r}"
                raise InputError(problem, where=f"{path}, line {number}", remedy=_AGAIN)
            parents[child] = parent
    return parents


def _numbers(words: list[str], count: int, path: Path, number: int) -> tuple[float, ...]:
    try:
        values = tuple(float(word) for word in words)
    except ValueError:
        values = ()
    if len(values) != count or not all(abs(value) <= LARGEST for value in values):
        problem = f"{count} number{'s' * (count > 1)} wanted, not {' '.join(words)[:40]!r}"
        raise InputError(problem, where=f"{path}, line {number}", remedy=_AGAIN)
    return values


# --- the motion ------------------------------------------------------------------------------------------


def _rate(path: Path, keywords: dict[str, Line]) -> float:
    if "SAMPLES-PER-SECOND" not in keywords:
        return FRAME_RATE_HZ
    number, words = keywords["SAMPLES-PER-SECOND"]
    (rate,) = _numbers(words, 1, path, number)
    if not rate > 0.0:
        raise InputError(
            "no :SAMPLES-PER-SECOND above zero", where=f"{path}, line {number}", remedy="write the true rate"
        )
    return rate


def _frames(path: Path, skeleton: AsfSkeleton, rows: list[tuple[int, str]]) -> Floats:
    """Give the values of all rows, shape (frame, degree of freedom)."""
    sizes = {name: len(dof) for name, dof in zip(skeleton.names, skeleton.dofs, strict=True) if dof}
    height = 1 + len(sizes)
    # The bones of a frame may come in any order, but in the same one in every frame.
    order = [line.split(maxsplit=1)[0] for _, line in rows[1:height]]
    if len(rows) // height * len(skeleton.names) * 4 > MOST_NUMBERS:
        raise InputError("more frames than a take has", where=path, remedy=_AGAIN)
    starts, width = {}, 1
    for name in order:
        starts[name] = width
        width += 1 + sizes.get(name, 0)
    frames = len(rows) // height
    words = " ".join(line for _, line in rows).split()
    if (
        not rows
        or starts.keys() != sizes.keys()
        or len(words) != frames * width
        or not all(word.isdecimal() for word in words[::width])
        or any(words[start::width] != [name] * frames for name, start in starts.items())
    ):
        raise _misfit(path, rows, order, sizes)
    columns = [starts[name] + 1 + place for name, size in sizes.items() for place in range(size)]
    try:
        values = np.array([words[column::width] for column in columns], dtype=np.float64).T
    except ValueError:
        values = np.array([np.nan])
    if not np.all(np.abs(values) <= LARGEST):
        for number, line in rows:
            numbers = line.split()[1:]
            _numbers(numbers, len(numbers), path, number)
    return values


def _misfit(path: Path, rows: list[tuple[int, str]], order: list[str], sizes: dict[str, int]) -> InputError:
    """Find the first row that is not as it is in the first frame and in the skeleton."""
    for place, (number, line) in enumerate(rows):
        words, row = line.split(), place % (1 + len(sizes))
        if row == 0:
            fits, wanted = len(words) == 1 and words[0].isdecimal(), "the number of a frame"
        else:
            name = order[row - 1]
            fits, wanted = words[0] == name and len(words) == 1 + sizes.get(name, -1), f"{name[:40]!r}"
        if not fits:
            return InputError(
                f"{' '.join(words)[:40]!r} stands where {wanted} should, with what its skeleton has",
                where=f"{path}, line {number}",
                remedy="put the skeleton beside it that belongs to it, or copy the file again",
            )
    problem = "ends within a frame" if rows else "there are no frames"
    return InputError(problem, where=f"{path}, line {rows[-1][0] if rows else 1}", remedy=_AGAIN)


def _rows(path: Path) -> tuple[dict[str, Line], list[tuple[int, str]]]:
    """Give the keywords of an AMC file, with what they say, and its rows, without comments."""
    keywords: dict[str, Line] = {}
    rows: list[tuple[int, str]] = []
    for number, line in enumerate(read_text(path).splitlines(), start=1):
        start = line.lstrip()[:1]
        if start == ":":
            keyword, *words = line.split()
            keywords[keyword[1:].upper()] = (number, words)
        elif start and start != "#":
            rows.append((number, line))
    if "FULLY-SPECIFIED" not in keywords:
        problem = "no AMC motion: nothing says :FULLY-SPECIFIED"
        raise InputError(problem, where=path, remedy=_AGAIN)
    return keywords, rows
