"""Masses, radii of gyration and lengths are those worked out by hand from Winter (2009) and Huston (2009)."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import body
from studykit.motion.skeleton import AIST_BODY, JOINT_NAMES, NEUTRAL_BODY

# Joint: share of mass, radius of gyration, length (m), inertia per body mass (1e-4 m2); the right side only
# where its bone differs. A stature of 1.759 m; lengths rounded to a millimetre.
TABLE = {
    "pelvis": (0.142, 0.503, 0.125, 5.61),
    "left_hip": (0.100, 0.323, 0.421, 18.5),
    "right_hip": (0.100, 0.323, 0.429, 19.2),
    "spine1": (0.0695, 0.503, 0.151, 4.01),
    "left_knee": (0.0465, 0.302, 0.447, 8.5),
    "right_knee": (0.0465, 0.302, 0.448, 8.5),
    "spine2": (0.0695, 0.503, 0.066, 0.77),
    "left_ankle": (0.00725, 0.475, 0.150, 0.37),
    "right_ankle": (0.00725, 0.475, 0.150, 0.37),
    "spine3": (0.1844, 0.503, 0.244, 27.8),
    "left_foot": (0.00725, 0.475, 0.117, 0.22),
    "right_foot": (0.00725, 0.475, 0.117, 0.22),
    "neck": (0.0405, 0.495, 0.093, 0.86),
    "left_collar": (0.0158, 0.503, 0.108, 0.47),
    "right_collar": (0.0158, 0.503, 0.114, 0.52),
    "head": (0.0405, 0.495, 0.227, 5.11),
    "left_shoulder": (0.028, 0.322, 0.292, 2.48),
    "right_shoulder": (0.028, 0.322, 0.285, 2.36),
    "left_elbow": (0.016, 0.303, 0.278, 1.14),
    "right_elbow": (0.016, 0.303, 0.285, 1.19),
    "left_wrist": (0.003, 0.297, 0.096, 0.024),
    "right_wrist": (0.003, 0.297, 0.095, 0.024),
    "left_hand": (0.003, 0.297, 0.094, 0.024),
    "right_hand": (0.003, 0.297, 0.095, 0.024),
}


def test_every_joint_carries_what_the_table_says() -> None:
    segments = body.segments()
    assert segments.masses == pytest.approx([TABLE[name][0] for name in JOINT_NAMES], abs=1e-12)
    assert segments.gyration_radii == pytest.approx([TABLE[name][1] for name in JOINT_NAMES], abs=1e-12)
    assert segments.lengths == pytest.approx([TABLE[name][2] for name in JOINT_NAMES], abs=0.0011)
    assert segments.inertias * 1e4 == pytest.approx([TABLE[name][3] for name in JOINT_NAMES], rel=0.025)


def test_the_whole_body() -> None:
    segments = body.segments()
    assert segments.masses.sum() == pytest.approx(1.0, abs=1e-12)
    assert segments.inertias.sum() == pytest.approx(1.082e-2, rel=1e-3)


@pytest.mark.parametrize(("skeleton", "scale"), [(NEUTRAL_BODY, 1.117), (AIST_BODY, 1.074)])
def test_long_bones_are_scaled_to_a_living_person(skeleton, scale) -> None:
    knee = skeleton.index("left_knee")
    thigh = body.segments(skeleton).lengths[skeleton.index("left_hip")]
    assert thigh / skeleton.bone_lengths[knee] == pytest.approx(scale, abs=1e-3)


def test_lengths_grow_with_stature_and_masses_do_not() -> None:
    usual, tall = body.segments(), body.segments(stature_m=1.1 * body.DEFAULT_STATURE_M)
    assert tall.lengths == pytest.approx(1.1 * usual.lengths, rel=1e-12)
    assert np.array_equal(tall.masses, usual.masses)
