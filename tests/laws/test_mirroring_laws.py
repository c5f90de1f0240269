"""Laws of the mirror: twice is never, and what the left did the right does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studykit.motion import energy, features, kinematics, rotation
from studykit.motion.mirroring import mirrored
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY, Skeleton

SWAP = list(NEUTRAL_BODY.mirror)
IMAGE = np.array([-1.0, 1.0, 1.0])
SYMMETRIC = Skeleton(
    joint_names=NEUTRAL_BODY.joint_names,
    parents=NEUTRAL_BODY.parents,
    offsets=(NEUTRAL_BODY.offsets + NEUTRAL_BODY.offsets[SWAP] * IMAGE) / 2.0,
    mirror=NEUTRAL_BODY.mirror,
)
seeds = st.integers(0, 1000)


def wandering(seed: int, skeleton: Skeleton = SYMMETRIC) -> Motion:
    rng = np.random.default_rng(seed)
    turns = rng.normal(scale=0.4, size=(1, 24, 3)) + np.cumsum(
        rng.normal(scale=0.05, size=(30, 24, 3)), axis=0
    )
    return Motion(
        skeleton=skeleton,
        rotations=rotation.exp(turns),
        root_positions=np.cumsum(rng.normal(scale=0.02, size=(30, 3)), axis=0),
        frame_rate_hz=30.0,
    )


def swapped_only(motion: Motion) -> Motion:
    """Wrong: left and right change places, but every joint turns as before."""
    return replace(motion, rotations=motion.rotations[:, SWAP], root_positions=motion.root_positions * IMAGE)


def joint_energies(motion: Motion) -> np.ndarray:
    positions = kinematics.centred_positions(motion.skeleton, motion.rotations)
    return np.stack(
        (
            energy.linear_energy(positions, motion.frame_rate_hz),
            energy.rotational_energy(motion.rotations, motion.frame_rate_hz),
        )
    )


def image_of_features(values: np.ndarray) -> np.ndarray:
    """Swap the sides of the 97 values of a pose; the twist of the trunk changes its direction."""
    kinetic = values[:, : features.KINETIC].reshape(len(values), 24, 3)[:, SWAP].reshape(len(values), -1)
    names = features.GEOMETRIC_NAMES
    other = {"left": "right", "right": "left"}
    columns = []
    for name in names:
        stem, _, side = name.rpartition("_")
        columns.append(names.index(f"{stem}_{other[side]}") if side in other else names.index(name))
    geometric = values[:, features.KINETIC :][:, columns]
    geometric[:, names.index("trunk_twist")] *= -1.0
    return np.concatenate((kinetic, geometric), axis=1)


@settings(max_examples=20, deadline=None)
@given(seed=seeds)
def test_the_mirror_of_the_mirror_is_the_dance_itself(seed) -> None:
    motion = wandering(seed, NEUTRAL_BODY)
    twice = mirrored(mirrored(motion))
    # Reading a quaternion in normalises it, which may cost the last digit.
    assert np.allclose(twice.rotations, motion.rotations, rtol=0.0, atol=1e-15)
    assert np.array_equal(twice.root_positions, motion.root_positions)
    assert twice.skeleton is motion.skeleton
    assert twice.frame_rate_hz == motion.frame_rate_hz


@settings(max_examples=20, deadline=None)
@given(seed=seeds)
def test_every_joint_stands_where_its_image_stood(seed) -> None:
    motion = wandering(seed)
    expected = kinematics.joint_positions(motion)[:, SWAP] * IMAGE
    assert np.allclose(kinematics.joint_positions(mirrored(motion)), expected, rtol=0.0, atol=1e-12)
    # Wrong: the sides swapped without turning the turns round.
    assert np.abs(kinematics.joint_positions(swapped_only(motion)) - expected).max() > 0.05


@settings(max_examples=20, deadline=None)
@given(seed=seeds)
def test_the_mirror_swaps_the_energies_of_the_sides(seed) -> None:
    motion = wandering(seed)
    masses_of_both_sides = pytest.approx(joint_energies(motion)[0, SWAP], rel=1e-9, abs=1e-18)
    assert joint_energies(mirrored(motion))[0] == masses_of_both_sides
    # The inertias are those of the neutral body, whose bones differ from side to side: compare speeds.
    spins = [
        np.sum(kinematics.angular_speeds(one.rotations, 30.0) ** 2, axis=0)
        for one in (mirrored(motion), motion)
    ]
    assert spins[0] == pytest.approx(spins[1][SWAP], rel=1e-9)
    # Wrong: the sum of the travelling changes when joints turn the wrong way on their parents.
    assert joint_energies(swapped_only(motion))[0] != masses_of_both_sides


@settings(max_examples=20, deadline=None)
@given(seed=seeds)
def test_the_mirror_swaps_the_features_of_the_sides(seed) -> None:
    motion = wandering(seed)
    own, image, wrong = (
        features.pose_features(kinematics.centred_positions(one.skeleton, one.rotations), 30.0)
        for one in (motion, mirrored(motion), swapped_only(motion))
    )
    assert np.allclose(image, image_of_features(own), rtol=1e-9, atol=1e-8)
    assert not np.allclose(wrong, image_of_features(own), rtol=0.1, atol=0.1)


@settings(max_examples=20, deadline=None)
@given(seed=seeds, angle=st.floats(-3.0, 3.0))
def test_who_faced_left_faces_right(seed, angle) -> None:
    motion = kinematics.turned(wandering(seed), angle)
    own, image, wrong = (
        kinematics.facing(kinematics.joint_positions(one))
        for one in (motion, mirrored(motion), swapped_only(motion))
    )
    assert np.allclose(np.exp(1j * image), np.exp(-1j * own), rtol=0.0, atol=1e-9)
    assert not np.allclose(np.exp(1j * wrong), np.exp(-1j * own), rtol=0.0, atol=1e-3)


@settings(max_examples=20, deadline=None)
@given(seed=seeds)
def test_the_uneven_sides_of_the_neutral_body_shift_joints_by_centimetres_only(seed) -> None:
    motion = wandering(seed, NEUTRAL_BODY)
    expected = kinematics.joint_positions(motion)[:, SWAP] * IMAGE
    off = np.linalg.norm(kinematics.joint_positions(mirrored(motion)) - expected, axis=-1)
    assert off.max() < 0.04
    own, image = (joint_energies(one) for one in (motion, mirrored(motion)))
    # The sides' bones differ by up to 6 % in length, so their inertias by up to 12 %.
    assert image.sum(axis=1) == pytest.approx(own.sum(axis=1), rel=0.06)


def test_a_body_of_two_joints_of_the_middle_is_mirrored_too() -> None:
    body = Skeleton(
        joint_names=("root", "tip"), parents=(-1, 0), offsets=[[0, 0, 0], [0, 1, 0]], mirror=(0, 1)
    )
    vectors = np.array([[[0.1, 0.2, 0.3], [-0.4, 0.5, -0.6]]])
    motion = Motion(
        skeleton=body,
        rotations=rotation.exp(vectors),
        root_positions=[[1.0, 2.0, 3.0]],
        frame_rate_hz=100.0,
    )
    image = mirrored(motion)
    assert np.allclose(rotation.log(image.rotations), vectors * [1.0, -1.0, -1.0])
    assert image.root_positions.tolist() == [[-1.0, 2.0, 3.0]]
