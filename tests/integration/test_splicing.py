"""Calm arms on the bodies of real dancers: what a spared elbow costs of a library, and how it looks."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.splicing import mask_keeps, spliced
from studykit.io.datasets.read import find_recipe
from studykit.library.build import build
from studykit.library.measure import Settings
from studykit.motion import cleaning, kinematics
from studykit.motion.clearance import clearance
from studykit.motion.joint_mask import JointMask, beyond, spare
from studykit.motion.plausibility import implausible
from studykit.motion.skeleton import NEUTRAL_BODY

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def library(shared_data: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory) -> DanceLibrary:
    takes = shared_data("motion/cmu-bvh-acrnn")
    out = tmp_path_factory.mktemp("libraries") / "mirrored"
    return build({takes: find_recipe(takes)}, out, settings=Settings(mirrored=True))


@pytest.fixture(scope="module")
def mask(library: DanceLibrary) -> JointMask:
    return spare("right_elbow").limited(library.speed_limits(25.0))


@pytest.fixture(scope="module")
def new(library: DanceLibrary, mask: JointMask) -> DanceLibrary:
    return spliced(library, mask)


def positions(library: DanceLibrary, rows: np.ndarray) -> np.ndarray:
    return kinematics.centred_positions(NEUTRAL_BODY, np.asarray(library.rotations[rows], dtype=float))


def test_most_of_the_library_can_be_danced_with_a_spared_elbow(library, mask, new) -> None:
    before, after = (mask_keeps(one, mask).all(axis=1).mean() for one in (library, new))
    assert before < 0.25
    assert after > 0.85
    for row in np.flatnonzero(new.segments["spliced_from"] != ""):
        speeds = kinematics.angular_speeds(new.motion(int(row)).rotations, 30.0).max(axis=0)
        assert np.all(speeds <= mask.speed_limits_rad_s * (1.0 + 1e-12))


def test_arms_and_bodies_go_together_at_least_as_well_as_when_danced(library, mask, new) -> None:
    every = np.arange(len(library))
    rows = np.flatnonzero(new.segments["spliced_from"] != "")
    danced, made = (clearance(positions(*pair), "right") for pair in ((library, every), (new, rows)))
    for percentile in (1.0, 5.0, 25.0, 50.0):
        assert np.percentile(made.min(axis=1), percentile) > np.percentile(danced.min(axis=1), percentile)
    assert np.mean(made < 0.0) < 0.5 * np.mean(danced < 0.0)
    # Any arm on any body would cut through it far more often.
    calm = np.resize(np.flatnonzero(mask_keeps(library, mask).all(axis=1)), len(rows))
    arm = list(beyond("right_collar"))
    mixed = np.array(library.rotations[rows], dtype=float)
    mixed[:, :, arm] = np.asarray(library.rotations[calm])[:, :, arm]
    careless = clearance(kinematics.centred_positions(NEUTRAL_BODY, mixed), "right")
    assert np.mean(careless < 0.0) > 3.0 * np.mean(made < 0.0)


def test_no_rule_of_plausible_movement_is_broken(new) -> None:
    for row in np.flatnonzero(new.segments["spliced_from"] != ""):
        motion = new.motion(int(row))
        assert implausible(motion) is None
        excess = cleaning.excesses(positions(new, np.array([row]))[0], motion.root_positions, 30.0)
        assert not cleaning.flagged(excess, "robust").any()
        hand = kinematics.joint_positions(motion)[:, NEUTRAL_BODY.index("right_hand"), 1]
        assert hand.min() > 0.15
