"""Motions and tracks refuse what cannot be a movement."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import rotation
from studykit.motion.motion import JointTracks, Motion
from studykit.motion.skeleton import NEUTRAL_BODY

STILL = {
    "skeleton": NEUTRAL_BODY,
    "rotations": rotation.identity(3, 24),
    "root_positions": np.zeros((3, 3)),
    "frame_rate_hz": 59.94,
}
TRACKS = {
    "positions": np.zeros((2, 1, 3)),
    "confidence": np.ones((2, 1)),
    "times_s": [0.0, 0.03],
    "joint_names": ("pelvis",),
}


def test_a_motion_knows_its_length_and_cannot_be_changed() -> None:
    motion = Motion(**STILL)
    assert len(motion) == 3
    assert motion.duration_s == pytest.approx(3 / 59.94)
    with pytest.raises(ValueError, match="read-only"):
        motion.rotations[0, 0, 0] = 0.0


def test_small_errors_of_length_are_normalised_away() -> None:
    motion = Motion(**(STILL | {"rotations": 1.0005 * rotation.identity(3, 24)}))
    assert np.linalg.norm(motion.rotations, axis=-1) == pytest.approx(np.ones((3, 24)), abs=1e-15)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"rotations": rotation.identity(3, 23)}, r"expected \(frame, 24, 4\)"),
        ({"rotations": np.zeros((3, 24, 4))}, "unit length"),
        ({"rotations": np.full((3, 24, 4), np.nan)}, "unit length"),
        ({"root_positions": np.zeros((2, 3))}, "root_positions has the shape"),
        ({"root_positions": np.full((3, 3), np.inf)}, "root_positions must be finite"),
        ({"frame_rate_hz": 0.0}, "positive rate"),
        ({"frame_rate_hz": float("nan")}, "positive rate"),
    ],
)
def test_what_is_no_motion(change: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Motion(**(STILL | change))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"times_s": [0.0, 0.0]}, "increase strictly"),
        ({"confidence": [[0.0], [1.1]]}, "between 0 and 1"),
        ({"positions": np.zeros((2, 2, 3))}, "positions has the shape"),
    ],
)
def test_what_are_no_tracks(change: dict, message: str) -> None:
    assert len(JointTracks(**TRACKS)) == 2
    with pytest.raises(ValueError, match=message):
        JointTracks(**(TRACKS | change))
