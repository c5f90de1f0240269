"""How joints are turned, found from where they are."""

from __future__ import annotations

import numpy as np

from studykit.core.arrays import Floats
from studykit.motion import kinematics, rotation
from studykit.motion.skeleton import NEUTRAL_BODY, Skeleton


def rotations_from_positions(
    positions: Floats, skeleton: Skeleton = NEUTRAL_BODY, *, shortest_bone_m: float = 0.0
) -> Floats:
    """Find how every joint is turned when only positions are known, as from a camera.

    Each joint takes the turn that best carries its rest bones onto the seen ones. A joint with a single bone
    keeps its parent's turn but for the shortest swing, since the twist about a bone cannot be seen.

    Parameters
    ----------
    positions : ndarray, shape (frame, joint, 3), m
        Joint positions without gaps; only directions of bones matter, not lengths.
    skeleton : Skeleton
        Gives the rest bones.
    shortest_bone_m : float
        A joint whose only bone is shorter than this keeps its parent's turn: the trembling of a camera turns
        short bones most, and with them all that hangs on them.

    Returns
    -------
    ndarray, shape (frame, joint, 4)
        Parent-relative unit quaternions.

    Notes
    -----
    Kabsch's algorithm where a joint has several bones; parents first.
    """
    frames = len(positions)
    world = rotation.identity(frames, len(skeleton.parents))
    for joint, parent in enumerate(skeleton.parents):
        inherited = world[:, parent] if parent >= 0 else rotation.identity(frames)
        children = skeleton.children(joint)
        tells = len(children) > 1 or any(
            skeleton.bone_lengths[child] >= shortest_bone_m for child in children
        )
        if not tells:
            world[:, joint] = inherited
            continue
        rest = _unit(skeleton.offsets[list(children)])
        seen = _unit(positions[:, list(children)] - positions[:, [joint]])
        if len(children) == 1:
            start = rotation.rotate(inherited, rest[0])
            world[:, joint] = rotation.multiply(_swing(start, seen[:, 0]), inherited)
        else:
            world[:, joint] = rotation.from_matrix(_kabsch(rest, seen))
    return kinematics.local_rotations(skeleton, world)


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12))


def _swing(start: Floats, end: Floats) -> Floats:
    """Shortest turns that carry unit vectors `start` onto `end`, shape (frame, 4)."""
    axis = np.cross(start, end)
    sine = np.linalg.norm(axis, axis=-1, keepdims=True)
    angle = np.arctan2(sine, np.sum(start * end, axis=-1, keepdims=True))
    # Vectors on one line have no cross product: any axis across serves to turn one about.
    across = np.cross(start, np.eye(3)[np.argmin(np.abs(start), axis=-1)])
    return rotation.exp(_unit(np.where(sine < 1e-9, across, axis)) * angle)


def _kabsch(rest: Floats, seen: Floats) -> Floats:
    """Matrices that best turn `rest` (bone, 3) onto `seen` (frame, bone, 3), shape (frame, 3, 3)."""
    covariance = np.einsum("fbi,bj->fij", seen, rest)
    left, _, right = np.linalg.svd(covariance)
    handed = np.ones((len(seen), 3))
    handed[:, 2] = np.sign(np.linalg.det(left @ right))
    return np.asarray((left * handed[:, None, :]) @ right)
