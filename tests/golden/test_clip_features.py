"""In its compatible mode, the features of clips are those of the AIST++ program, slips and all."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from studykit.motion.clip_features import (
    GEOMETRIC_CLIP_NAMES,
    geometric_clip_features,
    kinetic_clip_features,
)

HERE = Path(__file__).parent
GOLDEN = json.loads((HERE / "clip_features.json").read_text())


def positions(movement: dict) -> np.ndarray:
    """Make the joints as the script beside this file makes them."""
    script: dict = {"__name__": "make_clip_features"}
    exec((HERE / "make_clip_features.py").read_text(), script)
    return script["positions"](**{key: movement[key] for key in ("frames", "shift_m", "swing_m", "tilt_rad")})


@pytest.mark.parametrize("movement", GOLDEN, ids=lambda one: f"{one['frames']} frames, {one['swing_m']} m")
def test_compatible_features_are_those_of_the_program(movement) -> None:
    joints = positions(movement)
    kinetic = kinetic_clip_features(joints, 60.0, compat="aistpp")
    geometric = geometric_clip_features(joints, 60.0, compat="aistpp")
    # The program gives single precision.
    assert kinetic == pytest.approx(movement["kinetic"], rel=2e-6)
    assert geometric == pytest.approx(movement["geometric"], abs=1e-6)


def test_the_movements_put_every_relation_to_the_test() -> None:
    shares = np.array([movement["geometric"] for movement in GOLDEN])
    sometimes = ((shares > 0.0) & (shares < 1.0)).any(axis=0)
    never = {name for name, so in zip(GEOMETRIC_CLIP_NAMES, sometimes, strict=True) if not so}
    assert not never


def test_correct_features_differ_from_the_programs_where_it_slips() -> None:
    """Were the slips put right unnoticed, or the default to slip, this would fail."""
    movement = GOLDEN[0]
    joints = positions(movement)
    right = kinetic_clip_features(joints, 60.0)
    theirs = np.array(movement["kinetic"])
    for channel in (0, 1):
        assert right[channel::3] == pytest.approx(theirs[channel::3], rel=2e-6)
    assert np.all(theirs[2::3] > 20.0 * right[2::3])
    assert not np.allclose(geometric_clip_features(joints, 60.0), movement["geometric"], atol=0.05)
