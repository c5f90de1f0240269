"""Writes optical markers as Qualisys does: header lines, then tabs; millimetres, Z up, NaN where lost."""

from __future__ import annotations

from pathlib import Path

import numpy as np

RATE_HZ = None
DANCERS = 1
RECIPE = {"format": "markers", "skeleton": "mocap-toolbox", "units_m": 0.001, "up": "Z"}
RECOGNISED = False
ROTATION_TOLERANCE = None
POSITION_TOLERANCE_M = 0.01
JOINTS = (1, 2, 4, 5, 7, 8, 10, 11, 15, 16, 17, 18, 19, 20, 21, 22, 23)
# Around each joint, so that the mean of its markers is the joint.
AROUND = {
    "head": {
        "Head_FL": (60, 0, 80),
        "Head_FR": (-60, 0, 80),
        "Head_BL": (60, 0, -80),
        "Head_BR": (-60, 0, -80),
    },
    "left_shoulder": {"Shoulder_L": (0, 0, 0)},
    "right_shoulder": {"Shoulder_R": (0, 0, 0)},
    "spine3": {"Spine": (0, 0, -90), "Sternum": (0, 0, 90)},
    "left_hip": {"Hip_FL": (0, 0, 90), "Hip_BL": (0, 0, -90)},
    "right_hip": {"Hip_FR": (0, 0, 90), "Hip_BR": (0, 0, -90)},
    "left_elbow": {"Elbow_L": (0, 0, 0)},
    "right_elbow": {"Elbow_R": (0, 0, 0)},
    "left_wrist": {"Radius_L": (0, 20, 0), "Ulna_L": (0, -20, 0)},
    "right_wrist": {"Radius_R": (0, 20, 0), "Ulna_R": (0, -20, 0)},
    "left_hand": {"Finger_L": (0, 0, 0)},
    "right_hand": {"Finger_R": (0, 0, 0)},
    "left_knee": {"Knee_L": (0, 0, 0)},
    "right_knee": {"Knee_R": (0, 0, 0)},
    "left_ankle": {"Ankle_L": (0, 0, 0)},
    "right_ankle": {"Ankle_R": (0, 0, 0)},
    "left_foot": {"Pinkie_L": (30, 0, 0), "BigToe_L": (-30, 0, 0)},
    "right_foot": {"Pinkie_R": (-30, 0, 0), "BigToe_R": (30, 0, 0)},
}


def write(folder: Path, dance: dict[str, np.ndarray]) -> Path:
    """Write one table; a marker is lost now and then."""
    names = [str(name) for name in dance["names"]]
    markers = {}
    for joint, around in AROUND.items():
        number = names.index(joint)
        for name, place in around.items():
            turned = dance["world"][0][:, number] @ np.array(place, dtype=float)
            markers[name] = 1000.0 * dance["joints"][0][:, number] + turned
    markers["Head_FL"][3:5] = np.nan
    table = np.stack(list(markers.values()), axis=1)[..., [0, 2, 1]] * [1.0, -1.0, 1.0]
    header = [
        f"NO_OF_FRAMES\t{len(table)}",
        "NO_OF_CAMERAS\t8",
        f"NO_OF_MARKERS\t{len(markers)}",
        f"FREQUENCY\t{float(dance['rate']):g}",
        "NO_OF_ANALOG\t0",
        "ANALOG_FREQUENCY\t0",
        "DESCRIPTION\t--",
        "TIME_STAMP\t2007-10-24, 14:17:51\t85780.28415623",
        "DATA_INCLUDED\t3D",
        "MARKER_NAMES\t" + "\t".join(markers),
    ]
    rows = ["\t".join(f"{number:.3f}" for number in row) for row in table.reshape(len(table), -1)]
    path = folder / "walk01.tsv"
    path.parent.mkdir(parents=True)
    path.write_text("\n".join([*header, *rows]) + "\n")
    return path
