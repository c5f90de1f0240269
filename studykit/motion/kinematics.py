"""Where the joints are and how fast they move, from how they are turned."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from studykit.core.arrays import Floats
from studykit.motion import rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY, Skeleton


def global_rotations(skeleton: Skeleton, rotations: Floats) -> Floats:
    """Turn parent-relative rotations into rotations relative to the world.

    Parameters
    ----------
    skeleton : Skeleton
        Gives the parents.
    rotations : ndarray, shape (..., joint, 4)
        Unit quaternions relative to the parent.

    Returns
    -------
    ndarray, shape (..., joint, 4)
    """
    world = np.array(rotations)
    for joints, parents in skeleton.generations:
        world[..., joints, :] = rotation.multiply(world[..., parents, :], rotations[..., joints, :])
    return world


def local_rotations(skeleton: Skeleton, world: Floats) -> Floats:
    """Undo `global_rotations`: make rotations relative to the parent again, shape (..., joint, 4)."""
    parents = np.array(skeleton.parents[1:])
    local = np.array(world)
    local[..., 1:, :] = rotation.multiply(rotation.inverse(world[..., parents, :]), world[..., 1:, :])
    return local


def joint_positions(motion: Motion) -> Floats:
    """Give where every joint is, in every frame (forward kinematics).

    Returns
    -------
    ndarray, shape (frame, joint, 3), m
        World positions; the root lies at `motion.root_positions`.

    Notes
    -----
    p_j = p_parent + G_parent o_j, with G the world rotation and o_j the rest offset.
    """
    positions = centred_positions(motion.skeleton, motion.rotations)
    return positions + motion.root_positions[:, None, :]


def centred_positions(skeleton: Skeleton, rotations: Floats) -> Floats:
    """Give where every joint is from the pelvis, shape (..., joint, 3), m; the pelvis stays at the origin."""
    return posed(skeleton, rotations).positions


class Pose(NamedTuple):
    """How joints are turned in the world, and where they are.

    Attributes
    ----------
    world : ndarray, shape (..., joint, 4)
        Unit quaternions relative to the world.
    positions : ndarray, shape (..., joint, 3), m
        From the pelvis.
    """

    world: Floats
    positions: Floats


def posed(skeleton: Skeleton, rotations: Floats) -> Pose:
    """Pose the body as its joints are turned, parent-relative quaternions of shape (..., joint, 4)."""
    world = global_rotations(skeleton, rotations)
    positions = np.zeros((*rotations.shape[:-1], 3))
    for joints, parents in skeleton.generations:
        bones = rotation.rotate(world[..., parents, :], skeleton.offsets[joints])
        positions[..., joints, :] = positions[..., parents, :] + bones
    return Pose(world, positions)


def position_slopes(
    skeleton: Skeleton, pose: Pose, joints: Sequence[int], *, seen: Sequence[int] | None = None
) -> Floats:
    """Give how joints move from the pelvis when some turn a little further, each about its own axes.

    Parameters
    ----------
    skeleton : Skeleton
        Says which joint hangs on which.
    pose : Pose
        The body from which they turn.
    joints : sequence of int
        Those that turn.
    seen : sequence of int, optional
        Those whose movement is asked for; all if not given.

    Returns
    -------
    ndarray, shape (..., seen joint, 3, 3 x turning joint), m/rad
        For turns R_j exp(delta_j): d p_k / d delta_j = -[p_k - p_j]_x G_j where k hangs on j, zero elsewhere.
    """
    turning, moved = list(joints), list(range(len(skeleton.parents)) if seen is None else seen)
    turns = rotation.to_matrix(pose.world[..., turning, :])
    arms = pose.positions[..., moved, None, :] - pose.positions[..., None, turning, :]
    arms *= descendants(skeleton)[moved][:, turning, None]
    # The columns of G_j crossed with the arms, component by component.
    x, y, z = (turns[..., None, :, axis, :] for axis in range(3))
    a, b, c = (arms[..., axis, None] for axis in range(3))
    slopes = np.stack((y * c - z * b, z * a - x * c, x * b - y * a), axis=-3)
    return slopes.reshape(*slopes.shape[:-2], 3 * len(turning))


def descendants(skeleton: Skeleton) -> Floats:
    """Give 1 where joint k (first axis) hangs, at any depth, on joint j (second axis)."""
    below = np.zeros((len(skeleton.parents),) * 2)
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            below[joint] = below[parent]
            below[joint, parent] = 1.0
    return below


def facing(positions: Floats) -> Floats:
    """Give the direction the body faces, as the angle of its front from +Z towards +X.

    Parameters
    ----------
    positions : ndarray, shape (..., 24, 3), m
        Joint positions in SMPL's order.

    Returns
    -------
    ndarray, shape (...), rad
        From the line across hips and shoulders, as HumanML3D does.
    """
    index = NEUTRAL_BODY.index
    across = (
        positions[..., index("left_hip"), :]
        - positions[..., index("right_hip"), :]
        + positions[..., index("left_shoulder"), :]
        - positions[..., index("right_shoulder"), :]
    )
    # left x up = front: (lx, ly, lz) x (0, 1, 0) = (-lz, 0, lx)
    return np.asarray(np.arctan2(-across[..., 2], across[..., 0]))


def facing_ahead(poses: Floats) -> Floats:
    """Turn poses about the vertical axis until each faces +Z, shape (..., 24, 3), m."""
    return rotation.rotate(rotation.yaw(-facing(poses))[..., None, :], poses)


def turned(motion: Motion, angle_rad: float, *, about: Floats | None = None) -> Motion:
    """Turn a whole motion about the vertical axis.

    Parameters
    ----------
    angle_rad : float
        Positive turns +Z towards +X.
    about : ndarray, shape (3,), m, optional
        The point that stays; the origin if not given.
    """
    turn = rotation.yaw(angle_rad)
    centre = np.zeros(3) if about is None else about
    rotations = np.array(motion.rotations)
    rotations[:, 0] = rotation.multiply(turn, motion.rotations[:, 0])
    root = rotation.rotate(turn, motion.root_positions - centre) + centre
    return Motion(
        skeleton=motion.skeleton, rotations=rotations, root_positions=root, frame_rate_hz=motion.frame_rate_hz
    )


def linear_velocities(positions: Floats, frame_rate_hz: float) -> Floats:
    """Give how fast each joint moves frame to frame (Eq. 7), shape (frame - 1, joint, 3), m/s."""
    return np.diff(positions, axis=0) * frame_rate_hz


def angular_speeds(rotations: Floats, frame_rate_hz: float) -> Floats:
    """Give how fast each joint turns relative to its parent (Eq. 10), shape (frame - 1, joint), rad/s."""
    step = rotation.multiply(rotation.inverse(rotations[:-1]), rotations[1:])
    sine = np.sqrt(step[..., 1] ** 2 + step[..., 2] ** 2 + step[..., 3] ** 2)
    return np.asarray(2.0 * frame_rate_hz * np.arctan2(sine, np.abs(step[..., 0])))


def rest_angles(rotations: Floats) -> Floats:
    """Give how far each joint is turned from its rest pose, shape (..., joint), rad.

    The root has no rest pose: its rotation is the way the dancer faces, and its angle is 0.
    """
    sine = np.linalg.norm(rotations[..., 1:], axis=-1)
    angles = np.asarray(2.0 * np.arctan2(sine, np.abs(rotations[..., 0])))
    angles[..., 0] = 0.0
    return angles
