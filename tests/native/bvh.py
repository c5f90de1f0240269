"""Writes BVH text of a skeleton with SMPL's joints, metres, with its own order of angles."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

RATE_HZ = None
DANCERS = 1
RECIPE = {"format": "bvh", "skeleton": "smpl"}
RECOGNISED = False
# Numbers in the text have seven digits behind the point; degrees.
ROTATION_TOLERANCE = 1e-6
POSITION_TOLERANCE_M = 1e-6


def write(folder: Path, dance: dict[str, np.ndarray]) -> Path:
    """Write one take."""
    names, parents, offsets = dance["names"], dance["parents"], dance["offsets"]
    vectors, pelvis = dance["vectors"][0], dance["pelvis"][0]
    order: list[int] = []

    def joint(number: int, indent: str) -> list[str]:
        order.append(number)
        word = "ROOT" if number == 0 else "JOINT"
        places = "Xposition Yposition Zposition " if number == 0 else ""
        lines = [f"{indent}{word} {names[number]}", f"{indent}{{"]
        lines.append(f"{indent}\tOFFSET " + " ".join(f"{x:.9f}" for x in offsets[number]))
        lines.append(f"{indent}\tCHANNELS {6 if number == 0 else 3} {places}Zrotation Xrotation Yrotation")
        children = [child for child, parent in enumerate(parents) if parent == number]
        for child in children:
            lines += joint(child, indent + "\t")
        if not children:
            lines += [f"{indent}\tEnd Site", f"{indent}\t{{", f"{indent}\t\tOFFSET 0 0.05 0", f"{indent}\t}}"]
        return [*lines, f"{indent}}}"]

    lines = ["HIERARCHY", *joint(0, ""), "MOTION", f"Frames: {len(vectors)}"]
    lines.append(f"Frame Time: {1.0 / float(dance['rate']):.10f}")
    for frame, place in zip(vectors[:, order], pelvis, strict=True):
        if np.all(np.isfinite(frame)):
            angles = Rotation.from_rotvec(frame).as_euler("ZXY", degrees=True)
        else:
            angles = frame
        lines.append(" ".join(f"{x:.9f}" for x in (*place, *angles.reshape(-1))))
    path = folder / "salsa" / "01.bvh"
    path.parent.mkdir(parents=True)
    path.write_text("\n".join(lines) + "\n")
    return path
