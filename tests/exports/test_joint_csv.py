"""Tables of joints are read back to the last digit by whatever reads CSV."""

from __future__ import annotations

import csv
import io

import numpy as np
from numpy.typing import NDArray

from studykit.io.joint_table import joint_table_text
from studykit.motion.motion import Motion
from studykit.motion.skeleton import JOINT_NAMES


def test_every_number_comes_back(motion: Motion, joints: NDArray[np.float64]) -> None:
    table = np.genfromtxt(io.StringIO(joint_table_text(motion)), delimiter=",", names=True)
    assert table.dtype.names is not None
    assert table.dtype.names[0] == "time_s"
    assert np.array_equal(table["time_s"], np.arange(60) / 30.0)
    for joint, name in enumerate(JOINT_NAMES):
        for axis, letter in enumerate("xyz"):
            assert np.array_equal(table[f"{name}_{letter}"], joints[:, joint, axis])
    assert (len(table), len(table.dtype.names)) == (60, 1 + 3 * 24)


def test_a_digit_less_would_be_noticed(motion: Motion, joints: NDArray[np.float64]) -> None:
    rows = list(csv.DictReader(io.StringIO(joint_table_text(motion))))
    heights = [float(row["left_elbow_y"]) for row in rows]
    wanted = joints[:, JOINT_NAMES.index("left_elbow"), 1].tolist()
    assert heights == wanted
    assert [float(f"{height:.15g}") for height in heights] != wanted
