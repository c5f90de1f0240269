"""From segments to the movement that is shown: joined, smoothed where they meet, feet on the floor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from studykit.core.arrays import Booleans, Floats, Integers
from studykit.motion import foot_contact, kinematics, stage
from studykit.motion.blending import Blend, joined
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY
from studykit.motion.window_fit import EDGE, Pull, fitted

REACH = 10
"""Frames before and after a join that smoothing and feet may change."""

_HALF = REACH + EDGE
_SMOOTHING = Pull(weights=np.array(0.5), prior=np.array(0.5), smoothness=8.0, is_lively=False)
_LEGS = tuple(
    NEUTRAL_BODY.index(f"{side}_{part}") for part in ("hip", "knee", "ankle") for side in ("left", "right")
)
_KNEES = tuple(NEUTRAL_BODY.index(name) for name in ("left_knee", "right_knee"))
_BALL, _ANKLE = 1e4, 30.0  # how much it matters that they stand still, against the turns of the legs


def animate(
    segments: Sequence[Motion],
    *,
    blend: Blend = "offset",
    is_cleaned: bool = True,
    stage_m: tuple[float, float] | None = None,
    held: Sequence[int] = (),
) -> Motion:
    """Play segments one after the other as a dancer would: without a jolt and without sliding feet.

    No frame is added or lost. Joints are turned otherwise than in the segments only within ten frames of a
    join; the root goes on from where each segment ended.

    Parameters
    ----------
    segments : sequence of Motion
        Same skeleton and frame rate (30 Hz), the floor at height zero; at least 24 frames each.
    blend : {"offset", "bridge"}
        See `studykit.motion.blending.joined`.
    is_cleaned : bool
        Whether to smooth the joins and hold the feet that stand, or to leave it at the blend.
    stage_m : (float, float), m, optional
        Width (x) and depth (z) of a rectangle about the start that the root shall not leave. How far it
        would have gone: `studykit.motion.stage.excess_m` of the way without.
    held : sequence of int
        Joints that turn as the blend has them, whatever it costs: the injured ones.

    Raises
    ------
    ValueError
        If a segment is too short to be cleaned.

    Notes
    -----
    The blend's joints are the keypoints of an inverse kinematics that also wants smooth speeds, over twenty
    frames at each join (`window_fit.fitted`). Then the root is led by the foot that stands, the way is bent
    to the stage, and hips, knees and ankles bring the standing feet to where they stood.
    """
    if is_cleaned and min(map(len, segments)) < 2 * _HALF:
        raise ValueError(f"a segment of {min(map(len, segments))} frames, expected at least {2 * _HALF}")
    motion = joined(segments, blend=blend)
    rotations, roots = np.array(motion.rotations), np.array(motion.root_positions)
    joins = np.cumsum([len(segment) for segment in segments])[:-1]
    windows = joins[:, None] + np.arange(-_HALF, _HALF)
    stands = np.concatenate(
        [foot_contact.contacts(kinematics.joint_positions(s), s.frame_rate_hz) for s in segments]
    )
    is_smoothed = is_cleaned and len(joins) > 0
    if is_smoothed:
        rotations[windows] = _smoothed(rotations[windows], motion, held)
        _lead(roots, rotations, windows, motion, stands)
    if stage_m is not None:
        roots = stage.kept_on(roots, np.asarray(stands.any(axis=1)), stage_m)
    if is_smoothed:
        rotations[windows] = _standing(rotations[windows], roots[windows], motion, stands[windows], held)
    return Motion(
        skeleton=motion.skeleton,
        rotations=rotations,
        root_positions=roots,
        frame_rate_hz=motion.frame_rate_hz,
    )


def _smoothed(rotations: Floats, motion: Motion, held: Sequence[int]) -> Floats:
    """Turn joints within windows so that speeds change smoothly and the body stays where it is."""
    skeleton = motion.skeleton
    free = [j for j in range(len(skeleton.parents)) if skeleton.children(j) and j not in held]
    wanted = kinematics.centred_positions(skeleton, rotations)
    return fitted(rotations, wanted, skeleton, free=free, pull=_SMOOTHING, rounds=1)


def _lead(roots: Floats, rotations: Floats, windows: Integers, motion: Motion, stands: Booleans) -> None:
    """Let the root go with the feet that stand, and all that follows with the root (in place)."""
    points = kinematics.centred_positions(motion.skeleton, rotations[windows])[:, :, foot_contact.POINTS]
    points += roots[windows][:, :, None]
    for window, seen in zip(windows, points, strict=True):
        moved = np.cumsum(foot_contact.root_steps(seen, stands[window]), axis=0)
        roots[window[1:]] += moved
        roots[window[-1] + 1 :] += moved[-1]


def _standing(
    rotations: Floats, roots: Floats, motion: Motion, stands: Booleans, held: Sequence[int]
) -> Floats:
    """Bring the feet that stand to where they stand, by the legs alone."""
    wanted = kinematics.centred_positions(motion.skeleton, rotations)
    points = wanted[:, :, foot_contact.POINTS] + roots[:, :, None]
    holds = [foot_contact.footholds(*window) for window in zip(points, stands, strict=True)]
    places, is_held = np.stack([h.places for h in holds]), np.stack([h.is_held for h in holds])
    wanted[:, :, foot_contact.POINTS] = places - roots[:, :, None]
    weights = np.zeros(wanted.shape[:-1])
    weights[:, :, foot_contact.POINTS] = is_held * np.array([_ANKLE, _ANKLE, _BALL, _BALL])
    free = [joint for joint in _LEGS if joint not in held]
    # Knees are hinges about their own X axis.
    prior = np.array([(0.1, 10.0, 10.0) if joint in _KNEES else (0.1, 0.1, 0.1) for joint in free]).ravel()
    pull = Pull(weights=weights, prior=prior, smoothness=6.0, is_lively=True)
    return fitted(rotations, wanted, motion.skeleton, free=free, pull=pull, rounds=8)
