"""Fitting a body to where its joints should be, over short windows of a movement, smoothly."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from studykit.core.arrays import Booleans, Floats
from studykit.motion import kinematics, rotation
from studykit.motion.skeleton import Skeleton

EDGE = 2
"""Frames at each end of a window that stay as they are: they carry place and speed in and out."""

_SHORTEST_LEVER_M = 0.05
_ENOUGH = 1e-3


class Pull(NamedTuple):
    """What a fit weighs against each other.

    Attributes
    ----------
    weights : ndarray, broadcastable to shape (window, frame, joint)
        How much it matters that a joint is where it should be.
    prior : ndarray, broadcastable to shape (3 x free joint,)
        How much it matters that joints stay turned as they were, about each of their axes; what no position
        shows (twists) is kept.
    smoothness : float
        How much it matters that speeds change little from frame to frame.
    is_lively : bool
        Whether the movement's own changes of speed are left to it, so that only what the fit adds is smooth.
    """

    weights: Floats
    prior: Floats
    smoothness: float
    is_lively: bool


def fitted(
    rotations: Floats, wanted: Floats, skeleton: Skeleton, *, free: Sequence[int], pull: Pull, rounds: int
) -> Floats:
    """Turn the free joints so that the body's joints come to where they are wanted, smoothly in time.

    Parameters
    ----------
    rotations : ndarray, shape (window, frame, joint, 4)
        Windows of a movement. The first and last two frames of each stay as they are.
    wanted : ndarray, shape (window, frame, joint, 3), m
        Where the joints should be, from the pelvis.
    free : sequence of int
        Joints that may be turned.
    pull : Pull
        What weighs how much.
    rounds : int
        Gauss-Newton steps at most; fewer where a step changes no window's cost by a thousandth.

    Returns
    -------
    ndarray, shape (window, frame, joint, 4)

    Notes
    -----
    Least squares over sum_k c_k |p_k - y_k|^2 + sum_j l_j^2 (prior |log(R0_j^-1 R_j)|^2 + smoothness
    |w_j(t) - w_j(t-1)|^2), with w = log(R(t)^-1 R(t+1)), less its start where the fit is lively, and l_j the
    lever of a joint, so that smoothness cuts off the same frequencies everywhere. Steps R_j exp(delta_j)
    with d p_k / d delta_j = -[p_k - p_j]_x G_j; speeds change by differences of delta (the turn of one frame
    is small). The normal equations have dense blocks of three times the free joints on the diagonal and
    multiples of diagonal ones a frame and two away: one banded Cholesky factorisation solves all windows.
    A window's step that does not lower its cost is not taken; the next one is damped (Levenberg).
    """
    if not free:
        return rotations
    problem = _Problem(rotations, wanted, skeleton, list(free), pull)
    damping = np.full(len(rotations), 1e-6)
    found = problem.weighed(rotations)
    for _ in range(rounds):
        tried = problem.weighed(problem.stepped(found, damping))
        better = tried.cost < found.cost
        is_done = np.all(np.abs(found.cost - tried.cost) <= _ENOUGH * found.cost)
        found = found.replaced(tried, better)
        damping = np.where(better, damping / 10.0, np.maximum(damping, 1e-3) * 10.0)
        if is_done:
            break
    return found.rotations


class _Weighed(NamedTuple):
    """Windows of a movement, posed, and all that their cost is made of; the window is the first axis."""

    rotations: Floats
    world: Floats
    positions: Floats
    away: Floats
    """How far the free joints are turned from the start."""
    changes: Floats
    """How much their speeds change from frame to frame."""
    cost: Floats

    def replaced(self, other: _Weighed, which: Booleans) -> _Weighed:
        """Take some windows from another."""
        if which.all():
            return other
        pairs = zip(other, self, strict=True)
        return _Weighed(
            *(np.where(which.reshape(-1, *(1,) * (new.ndim - 1)), new, old) for new, old in pairs)
        )


class _Problem:
    """The least squares of `fitted`."""

    def __init__(
        self, start: Floats, wanted: Floats, skeleton: Skeleton, joints: list[int], pull: Pull
    ) -> None:
        self._start, self._wanted, self._skeleton, self._joints = start, wanted, skeleton, joints
        self._weights = np.broadcast_to(pull.weights, wanted.shape[:-1])
        self._seen = np.flatnonzero(self._weights.any(axis=(0, 1))).tolist()
        levers = np.repeat(np.maximum(_levers(skeleton)[joints], _SHORTEST_LEVER_M) ** 2, 3)
        self._levers, self._prior, self._bend = levers, pull.prior * levers, pull.smoothness * levers
        self._own_changes = self._speed_changes(start) if pull.is_lively else 0.0
        self._differences = np.diff(np.eye(start.shape[1]), 2, axis=0)[:, EDGE:-EDGE]

    def _speed_changes(self, rotations: Floats) -> Floats:
        """Give how each turn of a frame differs from the one before, (window, frame - 2, 3 x joint)."""
        turned = rotations[:, :, self._joints]
        changes = np.diff(rotation.between(turned[:, :-1], turned[:, 1:]), axis=1)
        return changes.reshape(*changes.shape[:2], -1)

    def weighed(self, rotations: Floats) -> _Weighed:
        """Pose the body and give the sum of squares of each window."""
        world, positions = kinematics.posed(self._skeleton, rotations)
        away = rotation.between(self._start[:, :, self._joints], rotations[:, :, self._joints])
        away = away.reshape(*away.shape[:2], -1)
        changes = self._speed_changes(rotations) - self._own_changes
        cost = (
            np.einsum("wfkc,wfk->w", (positions - self._wanted) ** 2, self._weights)
            + np.sum(away**2 * self._prior, axis=(1, 2))
            + np.sum(changes**2 * self._bend, axis=(1, 2))
        )
        return _Weighed(rotations, world, positions, away, changes, cost)

    def stepped(self, at: _Weighed, damping: Floats) -> Floats:
        """Take one Gauss-Newton step, shape (window, frame, joint, 4)."""
        inner = slice(EDGE, -EDGE)
        misses = (at.positions - self._wanted)[:, inner][:, :, self._seen]
        pose = kinematics.Pose(at.world[:, inner], at.positions[:, inner])
        slopes = kinematics.position_slopes(self._skeleton, pose, self._joints, seen=self._seen)
        slopes = slopes.reshape(*slopes.shape[:2], 3 * len(self._seen), slopes.shape[-1])
        weighted = slopes * np.repeat(self._weights[:, inner][:, :, self._seen], 3, axis=-1)[..., None]
        force = -np.einsum("wfij,wfi->wfj", weighted, misses.reshape(*slopes.shape[:3]))
        force -= self._prior * at.away[:, inner]
        force -= self._bend * np.einsum("sf,wsj->wfj", self._differences, at.changes)
        blocks = np.swapaxes(weighted, 2, 3) @ slopes
        np.einsum("wfii->wfi", blocks)[:] += self._prior + damping[:, None, None] * self._levers
        turns = _banded_solution(blocks, self._differences.T @ self._differences, self._bend, force)
        turns = turns.reshape(*turns.shape[:2], -1, 3)
        tried = np.array(at.rotations)
        tried[:, inner, self._joints] = rotation.multiply(
            tried[:, inner][:, :, self._joints], rotation.exp(turns)
        )
        return tried


def _levers(skeleton: Skeleton) -> Floats:
    """Give the way along the bones to the joints beyond each joint, root of the sum of squares, m."""
    reach = np.zeros(len(skeleton.parents))
    for joint, parent in enumerate(skeleton.parents):
        reach[joint] = (reach[parent] if parent >= 0 else 0.0) + skeleton.bone_lengths[joint]
    ways = (reach[:, None] - reach) * kinematics.descendants(skeleton)
    return np.asarray(np.sqrt(np.sum(ways**2, axis=0)))


def _banded_solution(blocks: Floats, coupling: Floats, stiffness: Floats, force: Floats) -> Floats:
    """Solve (blocks on the diagonal + coupling x diag(stiffness)) step = force for all windows at once.

    Parameters
    ----------
    blocks : ndarray, shape (window, frame, n, n)
    coupling : ndarray, shape (frame, frame)
        Pentadiagonal.
    stiffness : ndarray, shape (n,)
    force : ndarray, shape (window, frame, n)
    """
    from scipy.linalg import solveh_banded

    windows, frames, size, _ = blocks.shape
    bands = np.zeros((EDGE * size + 1, windows, frames, size))
    for offset in range(size):
        bands[offset, :, :, : size - offset] = np.diagonal(blocks, -offset, 2, 3)
    for gap in range(EDGE + 1):
        bands[gap * size, :, : frames - gap] += np.diagonal(coupling, -gap)[:, None] * stiffness
    solved = solveh_banded(
        bands.reshape(len(bands), -1), force.reshape(-1), lower=True, overwrite_ab=True, check_finite=False
    )
    return np.asarray(solved).reshape(force.shape)
