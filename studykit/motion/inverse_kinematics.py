"""How joints are turned, found from where they are."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studykit.core.arrays import Floats
from studykit.motion import kinematics, rotation
from studykit.motion.skeleton import NEUTRAL_BODY, Skeleton

_LEFT_SIDE = (1.0, 0.0, 0.0)
# Limb by limb: the joint whose twist is looked for, and about which axis the joint below it bends (knees
# backwards about +X; elbows forwards, the left about -Y).
_HINGES = {
    "left_hip": ("left_knee", "left_ankle", _LEFT_SIDE),
    "right_hip": ("right_knee", "right_ankle", _LEFT_SIDE),
    "left_shoulder": ("left_elbow", "left_wrist", (0.0, -1.0, 0.0)),
    "right_shoulder": ("right_elbow", "right_wrist", (0.0, 1.0, 0.0)),
}
_TWIST_TIME_S = 0.06  # how far in time a bent limb tells how it is twisted
_UNTWISTED = 0.02  # how much a straight limb is held to its parent, against 1 for one bent at a right angle
_STRAIGHT = 0.03  # squared sine of a bend (10 degrees) that tells nothing
_FRAMES_AT_ONCE = 256
_TURNED_BACK = 1e-3  # length of the sum of two directions below which they count as opposite
_CLOSE_M = 1e-4  # frames that fit as well as this need no improving


class Fit(NamedTuple):
    """A body put where joints were seen.

    Attributes
    ----------
    rotations : ndarray, shape (frame, joint, 4)
        Parent-relative unit quaternions.
    root_positions : ndarray, shape (frame, 3), m
        Where the root is.
    errors : ndarray, shape (frame, joint), m
        How far each joint of the body is from where it was seen.
    """

    rotations: Floats
    root_positions: Floats
    errors: Floats


def fit(positions: Floats, skeleton: Skeleton, *, frame_rate_hz: float, rounds: int = 3) -> Fit:
    """Put a body where its joints were seen, with limbs twisted as their knees and elbows bend.

    Parameters
    ----------
    positions : ndarray, shape (frame, joint, 3), m
        Where the joints of `skeleton` were seen, without gaps; Y up.
    skeleton : Skeleton
        SMPL's 24 joints with the bone lengths of the person.
    frame_rate_hz : float
        Tells how far twists carry over time.
    rounds : int
        How often the closed form is improved; it is exact already where the bones keep their lengths.

    Notes
    -----
    Joints with several bones by Kabsch's algorithm, others by the shortest swing from their parent. A bent
    knee or elbow tells the twist of thigh or upper arm (its plane is the plane of the hinge); straight limbs
    carry the twist of their neighbours in time, by least squares over the whole take on the circle. Then
    Gauss-Newton steps with Levenberg's damping per frame over all turns and the root, with the Jacobian
    d p_k / d delta_j = -[p_k - p_j]_x G_j.
    """
    rotations = _hinged(positions, skeleton, frame_rate_hz)
    root = np.array(positions[:, 0])
    errors = _errors(positions, skeleton, rotations, root)
    off = np.flatnonzero(errors.max(axis=1) > _CLOSE_M) if rounds else np.empty(0, dtype=np.int64)
    for start in range(0, len(off), _FRAMES_AT_ONCE):
        part = off[start : start + _FRAMES_AT_ONCE]
        rotations[part], root[part] = _improved(
            positions[part], skeleton, rotations[part], root[part], rounds
        )
    return Fit(rotations, root, _errors(positions, skeleton, rotations, root))


def _errors(positions: Floats, skeleton: Skeleton, rotations: Floats, root: Floats) -> Floats:
    found = kinematics.centred_positions(skeleton, rotations) + root[:, None]
    return np.asarray(np.linalg.norm(found - positions, axis=-1))


def measured_body(positions: Floats, shape: Skeleton) -> Skeleton:
    """Give a body its bone lengths from where joints were seen: the median of each, each for itself.

    Parameters
    ----------
    positions : ndarray, shape (frame, joint, 3), m
        Where the joints of `shape` were seen.
    shape : Skeleton
        Gives the directions of the bones in the rest pose.
    """
    parents = np.array(shape.parents[1:])
    lengths = np.zeros(len(shape.parents))
    lengths[1:] = np.median(np.linalg.norm(positions[:, 1:] - positions[:, parents], axis=-1), axis=0)
    return replace(shape, offsets=_unit(shape.offsets) * lengths[:, None])


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
            world[:, joint] = rotation.multiply(shortest_swing(start, seen[:, 0]), inherited)
        else:
            world[:, joint] = rotation.from_matrix(_kabsch(rest, seen))
    return kinematics.local_rotations(skeleton, world)


def _hinged(positions: Floats, skeleton: Skeleton, frame_rate_hz: float) -> Floats:
    """Find turns as `rotations_from_positions` does, but with the twists that bent limbs show."""
    rotations = rotations_from_positions(positions, skeleton)
    world = kinematics.global_rotations(skeleton, rotations)
    for name, (middle, end, axis) in _HINGES.items():
        joint, knee, ankle = (skeleton.index(part) for part in (name, middle, end))
        parent = world[:, skeleton.parents[joint]]
        along = rotation.rotate(rotation.inverse(parent), _unit(positions[:, knee] - positions[:, joint]))
        below = rotation.rotate(rotation.inverse(parent), _unit(positions[:, ankle] - positions[:, knee]))
        twist = _twists(along, below, _Hinge.of(skeleton, knee, ankle, axis), frame_rate_hz)
        local = rotation.multiply(rotation.exp(along * twist[:, None]), rotations[:, joint])
        world[:, joint] = rotation.multiply(parent, local)
        # What hangs below keeps its bones where they were seen: each swings anew from its parent.
        chain = joint
        while children := skeleton.children(chain):
            chain = children[0]
            inherited = world[:, skeleton.parents[chain]]
            if grand := skeleton.children(chain):
                start = rotation.rotate(inherited, _unit(skeleton.offsets[grand[0]]))
                seen = _unit(positions[:, grand[0]] - positions[:, chain])
                inherited = rotation.multiply(shortest_swing(start, seen), inherited)
            world[:, chain] = inherited
    return kinematics.local_rotations(skeleton, world)


class _Hinge(NamedTuple):
    """A knee or an elbow in the rest pose: the bone above it, its axis across, and what it is bent by."""

    bone: Floats
    axis: Floats
    aside: float

    @classmethod
    def of(cls, skeleton: Skeleton, knee: int, ankle: int, axis: tuple[float, float, float]) -> _Hinge:
        bone = _unit(skeleton.offsets[knee])
        across = _unit(np.array(axis) - bone * (bone @ np.array(axis)))
        return cls(bone, across, float(across @ _unit(skeleton.offsets[ankle])))


def _twists(along: Floats, below: Floats, hinge: _Hinge, frame_rate_hz: float) -> Floats:
    """Give how far a limb is twisted about itself, against the shortest swing from rest, shape (frame,), rad.

    A hinge keeps the share `aside` of the lower bone along its axis, so the axis stands asin(aside / sine)
    off the normal of the plane in which the limb is bent.
    """
    swing = shortest_swing(np.broadcast_to(hinge.bone, along.shape), along)
    untwisted = rotation.rotate(swing, hinge.axis)
    normal = np.cross(along, below)
    sine = np.linalg.norm(normal, axis=-1)
    across = np.cross(along, untwisted)
    seen = np.arctan2(np.sum(normal * across, axis=-1), np.sum(normal * untwisted, axis=-1))
    seen = seen - np.arcsin(np.clip(hinge.aside / np.maximum(sine, 1e-9), -0.7, 0.7))
    told = np.maximum(sine**2 - _STRAIGHT, 0.0)
    # Without a bend the limb is not twisted against its parent; opposite to rest that means nothing.
    held = _UNTWISTED * 0.5 * (1.0 + along @ hinge.bone)
    # Between frames a limb swings without twisting; `carried` adds up what the swing from rest makes of that.
    step = rotation.multiply(shortest_swing(along[:-1], along[1:]), swing[:-1])
    moved = rotation.rotate(step, hinge.axis)
    made = np.arctan2(np.sum(moved * across[1:], axis=-1), np.sum(moved * untwisted[1:], axis=-1))
    carried = np.concatenate(([0.0], np.cumsum(made)))
    wanted = (told * np.exp(1j * seen) + held) * np.exp(-1j * carried)
    return np.asarray(np.angle(_smoothed(wanted, told + held, frame_rate_hz)) + carried)


def _smoothed(
    wanted: NDArray[np.complex128], weights: Floats, frame_rate_hz: float
) -> NDArray[np.complex128]:
    """Minimise sum w |z - wanted / w|^2 + s sum |z' - z|^2: a tridiagonal system."""
    from scipy.linalg import solveh_banded

    if len(wanted) < 2:
        return wanted
    stiffness = (_TWIST_TIME_S * frame_rate_hz) ** 2
    bands = np.full((2, len(wanted)), -stiffness)
    bands[1] = weights + 2.0 * stiffness + 1e-9
    bands[1, [0, -1]] -= stiffness
    return np.asarray(solveh_banded(bands, wanted))


def _improved(
    positions: Floats, skeleton: Skeleton, rotations: Floats, root: Floats, rounds: int
) -> tuple[Floats, Floats]:
    """Take damped Gauss-Newton steps from a start, frame by frame but all at once."""
    joints = len(skeleton.parents)
    weight = np.full(3 * joints + 3, 1e-4)  # m^2/rad^2: what no joint shows stays as it was
    weight[-3:] = 1e-9
    damping = np.full(len(positions), 1e-4)
    start = rotations
    pose = kinematics.posed(skeleton, rotations)
    seen = pose.positions + root[:, None]
    cost = np.sum((seen - positions) ** 2, axis=(1, 2))
    for _ in range(rounds):
        slopes = np.empty((len(seen), 3 * joints, 3 * joints + 3))
        slopes[..., :-3] = kinematics.position_slopes(skeleton, pose, range(joints)).reshape(
            len(seen), 3 * joints, 3 * joints
        )
        slopes[..., -3:] = np.tile(np.eye(3), (joints, 1))
        normal = np.swapaxes(slopes, 1, 2) @ slopes
        away = np.concatenate(
            (rotation.between(start, rotations).reshape(len(seen), -1), np.zeros((len(seen), 3))), axis=1
        )
        pull = np.einsum("fij,fi->fj", slopes, (positions - seen).reshape(len(seen), -1)) - weight * away
        diagonal = np.einsum("fii->fi", normal)
        diagonal += weight + damping[:, None] * (diagonal + 1e-3)
        step = np.linalg.solve(normal, pull[..., None])[..., 0]
        tried = rotation.multiply(rotations, rotation.exp(step[:, :-3].reshape(len(seen), joints, 3)))
        tried_root = root + step[:, -3:]
        tried_pose = kinematics.posed(skeleton, tried)
        tried_seen = tried_pose.positions + tried_root[:, None]
        tried_cost = np.sum((tried_seen - positions) ** 2, axis=(1, 2))
        better = tried_cost < cost
        rotations = np.where(better[:, None, None], tried, rotations)
        root = np.where(better[:, None], tried_root, root)
        pose = kinematics.Pose(
            *(np.where(better[:, None, None], *one) for one in zip(tried_pose, pose, strict=True))
        )
        seen = np.where(better[:, None, None], tried_seen, seen)
        cost = np.where(better, tried_cost, cost)
        damping = np.where(better, damping / 10.0, damping * 10.0)
    return rotations, root


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12))


def shortest_swing(start: Floats, end: Floats) -> Floats:
    """Give the shortest turns that carry the directions `start` onto `end`, shape (..., 4).

    Parameters
    ----------
    start, end : ndarray, shape (..., 3)
        Vectors of any length but zero.
    """
    start, end = np.broadcast_arrays(_unit(start), _unit(end))
    middle = start + end
    length = np.sqrt(np.einsum("...c,...c->...", middle, middle))[..., None]
    is_turned_back = length[..., 0] < _TURNED_BACK
    swings = np.empty((*start.shape[:-1], 4))
    # Half the angle has the cosine |a + b| / 2, and a x b = sin(half) |a + b| along the axis.
    swings[..., :1] = 0.5 * length
    swings[..., 1:] = _cross(start, end) / np.where(is_turned_back[..., None], 1.0, length)
    if is_turned_back.any():
        swings[is_turned_back] = _swings_back(start[is_turned_back], end[is_turned_back])
    return swings


def _swings_back(start: Floats, end: Floats) -> Floats:
    """Give the shortest turns between nearly opposite directions, shape (direction, 4)."""
    axis = np.cross(start, end)
    sine = np.linalg.norm(axis, axis=-1, keepdims=True)
    angle = np.arctan2(sine, np.sum(start * end, axis=-1, keepdims=True))
    # Vectors on one line have no cross product: any axis across serves to turn one about.
    across = np.cross(start, np.eye(3)[np.argmin(np.abs(start), axis=-1)])
    return rotation.exp(_unit(np.where(sine < 1e-9, across, axis)) * angle)


def _cross(first: Floats, second: Floats) -> Floats:
    """Give cross products, shape (..., 3): `np.cross` takes four times as long on short arrays."""
    a, b, c = (first[..., n] for n in range(3))
    x, y, z = (second[..., n] for n in range(3))
    return np.stack((b * z - c * y, c * x - a * z, a * y - b * x), axis=-1)


def _kabsch(rest: Floats, seen: Floats) -> Floats:
    """Matrices that best turn `rest` (bone, 3) onto `seen` (frame, bone, 3), shape (frame, 3, 3)."""
    covariance = np.einsum("fbi,bj->fij", seen, rest)
    left, _, right = np.linalg.svd(covariance)
    handed = np.ones((len(seen), 3))
    handed[:, 2] = np.sign(np.linalg.det(left @ right))
    return np.asarray((left * handed[:, None, :]) @ right)
