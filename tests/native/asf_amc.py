"""Writes ASF/AMC as Vicon's programs did: bones with axes of their own, comments, CRLF, long exponents."""

from __future__ import annotations

from pathlib import Path

import numpy as np

RATE_HZ = 120.0
DANCERS = 1
RECIPE = {"format": "asf-amc"}
PERFORMER = "01"
UNIT_M = 0.0254 / 0.45
NAMES = {
    "pelvis": "root",
    "left_hip": "lfemur",
    "right_hip": "rfemur",
    "spine1": "lowerback",
    "left_knee": "ltibia",
    "right_knee": "rtibia",
    "spine2": "upperback",
    "left_ankle": "lfoot",
    "right_ankle": "rfoot",
    "spine3": "thorax",
    "left_foot": "ltoes",
    "right_foot": "rtoes",
    "neck": "upperneck",
    "left_collar": "lclavicle",
    "right_collar": "rclavicle",
    "head": "head",
    "left_shoulder": "lhumerus",
    "right_shoulder": "rhumerus",
    "left_elbow": "lradius",
    "right_elbow": "rradius",
    "left_wrist": "lwrist",
    "right_wrist": "rwrist",
    "left_hand": "lhand",
    "right_hand": "rhand",
}


def about(axis: int, degrees: float) -> np.ndarray:
    """Give the matrix of a turn about X, Y or Z."""
    angle = np.radians(degrees)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[first, first] = matrix[second, second] = np.cos(angle)
    matrix[second, first], matrix[first, second] = np.sin(angle), -np.sin(angle)
    return matrix


def fixed_angles(matrix: np.ndarray) -> tuple[float, float, float]:
    """Give degrees about fixed X, then Y, then Z."""
    return tuple(
        np.degrees(
            [
                np.arctan2(matrix[2, 1], matrix[2, 2]),
                -np.arcsin(matrix[2, 0]),
                np.arctan2(matrix[1, 0], matrix[0, 0]),
            ]
        )
    )


def write(folder: Path, dance: dict[str, np.ndarray]) -> Path:
    """Write 01.asf and 01_01.amc; between joints lie rigid bones, as many joints hang on one."""
    folder.mkdir(parents=True)
    names = [NAMES[str(name)] for name in dance["names"]]
    axes = [(0.0, 0.0, 0.0)] + [(10.0 * n - 100.0, 5.0 * n - 60.0, 7.0 * n) for n in range(1, 24)]
    (folder / "01.asf").write_bytes(skeleton(names, dance, axes).encode())
    path = folder / "01_01.amc"
    path.write_bytes(motion(names, dance, axes).encode())
    return path


def skeleton(names: list[str], dance: dict[str, np.ndarray], axes: list[tuple[float, ...]]) -> str:
    lines = [
        "# made up",
        ":version 1.10",
        ":name VICON",
        ":units",
        "  mass 1.0",
        "  length 0.45",
        "  angle deg",
    ]
    lines += [":documentation", "   made: by hand", ":root", "   order TX TY TZ RX RY RZ", "   axis XYZ"]
    lines += ["   position 0 0 0  ", "   orientation 0 0 0", ":bonedata"]
    tree = []
    for joint in range(1, 24):
        name, parent = names[joint], names[dance["parents"][joint]]
        length = float(np.linalg.norm(dance["offsets"][joint]))
        x, y, z = dance["offsets"][joint] / length
        lines += ["  begin", f"     id {2 * joint}", f"     name to_{name}"]
        lines += [f"     direction {x:.12f} {y:.12f} {z:.12f} ", f"     length {length / UNIT_M:.12f}"]
        lines += ["     axis 0 0 0  XYZ", "  end", "  begin", f"     id {2 * joint + 1}", f"     name {name}"]
        lines += ["     direction 0 1 0", "     length 0"]
        lines += [f"     axis {' '.join(str(degrees) for degrees in axes[joint])}   XYZ", "    dof rx ry rz"]
        lines += [
            "    limits (-180.0 180.0)",
            "           (-90.0 90.0)",
            "           (-180.0 180.0)",
            "  end",
        ]
        tree += [f"    {parent} to_{name}", f"    to_{name} {name}"]
    return "\r\n".join([*lines, ":hierarchy", "  begin", *tree, "  end", ""])


def motion(names: list[str], dance: dict[str, np.ndarray], axes: list[tuple[float, ...]]) -> str:
    frames = [about(2, z) @ about(1, y) @ about(0, x) for x, y, z in axes]
    lines = ["#!OML:ASF made up", ":FULLY-SPECIFIED", ":DEGREES"]
    for frame, world in enumerate(dance["world"][0]):
        lines.append(str(frame + 1))
        for joint, name in enumerate(names):
            parent = dance["parents"][joint]
            local = world[joint] if joint == 0 else world[parent].T @ world[joint]
            angles = fixed_angles(frames[joint].T @ local @ frames[joint])
            place = dance["pelvis"][0, frame] / UNIT_M if joint == 0 else ()
            row = " ".join(f"{number:.10e}".replace("e-0", "e-00") for number in (*place, *angles))
            lines.append(f"{name} {row}")
    return "\r\n".join([*lines, ""])
