"""Put two bodies into one space, so that only how they move is left to compare."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studykit.core.arrays import Booleans, Floats, Integers
from studykit.core.errors import InputError
from studykit.motion import rotation
from studykit.motion.kinematics import facing
from studykit.motion.motion import JointTracks
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY

COMMON_JOINTS: tuple[str, ...] = (
    "left_shoulder",
    "right_shoulder",
    "left_elbow",
    "right_elbow",
    "left_wrist",
    "right_wrist",
    "left_hip",
    "right_hip",
    "left_knee",
    "right_knee",
    "left_ankle",
    "right_ankle",
    "neck",
    "head",
    "spine3",
)
"""The joints that are compared: those that depth cameras see reliably."""

COMMON_WEIGHTS: tuple[float, ...] = tuple(
    1.5 if name.endswith(("wrist", "ankle")) else 0.5 if name.endswith("hip") else 1.0
    for name in COMMON_JOINTS
)
"""How much each of `COMMON_JOINTS` counts: the ends of the limbs more, the hips less."""

_FACING_JOINTS = ("left_hip", "right_hip", "left_shoulder", "right_shoulder")


def resampled(tracks: JointTracks, times_s: Floats, *, longest_gap_s: float) -> Floats:
    """Give where the joints were at given moments, on straight lines between the frames that saw them.

    Parameters
    ----------
    tracks : JointTracks
        What a camera saw, at its own times.
    times_s : array_like, shape (frame,), s
        The moments wanted, on the same clock.
    longest_gap_s : float
        Over a longer time without sight of a joint, s, nothing is assumed.

    Returns
    -------
    ndarray, shape (frame, joint, 3), m
        NaN where a joint was not seen closely enough before and after.
    """
    times = np.asarray(times_s, dtype=np.float64)
    positions = np.full((len(times), len(tracks.joint_names), 3), np.nan)
    seen = np.asarray(np.isfinite(tracks.positions).all(axis=-1))
    for joint in range(positions.shape[1]):
        known, places = tracks.times_s[seen[:, joint]], tracks.positions[seen[:, joint], joint]
        if not len(known):
            continue
        after = np.searchsorted(known, times)  # known[after - 1] < time <= known[after]
        before = np.searchsorted(known, times, side="right") - 1
        inside = (before >= 0) & (after < len(known))
        before, after = before.clip(0), after.clip(max=len(known) - 1)
        near = inside & (known[after] - known[before] <= longest_gap_s)
        for axis in range(3):
            positions[near, joint, axis] = np.interp(times[near], known, places[:, axis])
    return positions


def common_space(positions: Floats, joint_names: Sequence[str], *, frame_rate_hz: float = 30.0) -> Floats:
    """Put a movement into the space in which dancer and guide are compared.

    The pelvis moves to the origin of every frame. The body is turned, once, so that it faces +Z in the first
    second in which its hips and shoulders are seen (later turns are part of the dance and stay). Each bone is
    given the length that it has in `NEUTRAL_BODY`, so that a tall dancer can match a short guide.

    Parameters
    ----------
    positions : array_like, shape (frame, joint, 3), m
        Y up; NaN where a joint was not seen.
    joint_names : sequence of str
        Names of SMPL joints, in any order; "pelvis", hips and shoulders are needed, joints that are missing
        altogether count as never seen.
    frame_rate_hz : float
        Frames a second.

    Returns
    -------
    ndarray, shape (frame, 15, 3), m
        `COMMON_JOINTS` in their order; NaN where one was not seen. A frame without the pelvis is not seen.

    Raises
    ------
    InputError
        If a joint's name is unknown, or hips, shoulders and pelvis are never seen together.

    Notes
    -----
    p_j = p_parent + L_j u_j down the tree, with u_j the direction of the bone in this frame and L_j its
    length in `NEUTRAL_BODY`. Where the parent is not seen, the nearest seen ancestor stands in, and the way
    from it keeps its direction and is scaled by the ratio of the lengths of the bones that it spans: in
    `NEUTRAL_BODY` to this body's own (their medians over time).
    """
    body = _all_joints(np.asarray(positions, dtype=np.float64), joint_names)
    body = body - body[:, :1]
    front = facing(body)
    known = np.flatnonzero(np.isfinite(front) & np.isfinite(body[:, 0, 0]))
    if not len(known):
        raise InputError(
            "pelvis, hips and shoulders are never seen together, so the body's front is unknown",
            remedy="place the camera so that it sees the whole body and record again",
        )
    first_second = front[known[known < known[0] + max(1, round(frame_rate_hz))]]
    middle = np.angle(np.mean(np.exp(1j * first_second)))
    away = np.median(np.angle(np.exp(1j * (first_second - middle))))  # angles jump at pi, differences do not
    turned = rotation.rotate(rotation.yaw(-(middle + away)), body)
    return _with_reference_bones(turned)[:, [NEUTRAL_BODY.index(name) for name in COMMON_JOINTS]]


def same_front(guide: Floats, danced: Floats, band_frames: int) -> Floats:
    """Turn a dancer, once, so that the whole dance fits the guide's as well as it can.

    The first second alone is no safe front: who follows a guide that begins with a turn a little late would
    count as standing wrong to the end, and a dance would seem hard because it begins with a turn.

    Parameters
    ----------
    guide, danced : ndarray, shape (frame, joint, 3), m
        In one space and of one length; NaN where a joint of the dancer was not seen.
    band_frames : int
        How many frames early or late the dancer may be.

    Returns
    -------
    ndarray, shape (frame, joint, 3), m
        The dancer, turned about the vertical.

    Notes
    -----
    For each delay the best turn is the angle of sum g conj(d), with g and d the places of guide and dancer on
    the ground as complex numbers z + ix; the delay with the smallest mean squared distance is taken.
    """
    is_seen = np.asarray(np.isfinite(danced).all(axis=-1))
    places = np.where(is_seen[..., None], danced, 0.0)
    latest = min(band_frames, len(guide) - 1)
    turned = _correlated(guide[..., 2] + 1j * guide[..., 0], places[..., 2] - 1j * places[..., 0], latest)
    one, other = (
        np.concatenate(parts, axis=1)
        for parts in (
            (-2.0 * guide[..., 1], np.sum(guide**2, axis=-1), np.ones_like(guide[:, :1, 0])),
            (places[..., 1], is_seen, np.sum(places**2, axis=(1, 2))[:, None]),
        )
    )
    pairs = _correlated(np.ones((len(guide), 1)), is_seen.sum(axis=1)[:, None], latest).real.round()
    squares = _correlated(one, other, latest).real - 2.0 * np.abs(turned)
    best = np.argmin(np.where(pairs > 0, squares / np.maximum(pairs, 1.0), np.inf))
    return rotation.rotate(rotation.yaw(float(np.angle(turned[best]))), danced)


def _correlated(first: NDArray[Any], second: NDArray[Any], latest: int) -> NDArray[np.complex128]:
    """Give the sum over frames t and columns of first[t] second[t + delay], from delay -latest to latest."""
    size = 2 ** int(len(first) + latest).bit_length()  # so long that the end does not meet the beginning
    spectra = np.conj(np.fft.fft(np.conj(first), size, axis=0)) * np.fft.fft(second, size, axis=0)
    return np.asarray(np.fft.ifft(spectra.sum(axis=1))[np.arange(-latest, latest + 1)])


def _all_joints(positions: Floats, joint_names: Sequence[str]) -> Floats:
    """Give the 24 SMPL joints in their order, NaN where one is missing, shape (frame, 24, 3)."""
    if positions.ndim != 3 or positions.shape[1:] != (len(joint_names), 3):
        raise ValueError(
            f"positions has the shape {positions.shape}, expected (frame, {len(joint_names)}, 3)"
        )
    unknown = sorted(set(joint_names) - set(JOINT_NAMES))
    if unknown:
        raise InputError(
            f'"{unknown[0]}" is no joint of the body model',
            where="joint_names",
            remedy="map it to an SMPL joint",
        )
    missing = sorted({"pelvis", *_FACING_JOINTS} - set(joint_names))
    if missing:
        raise InputError(
            f'the joint "{missing[0]}" is missing', where="joint_names", remedy="use a skeleton that has it"
        )
    body = np.full((len(positions), len(JOINT_NAMES), 3), np.nan)
    body[:, [NEUTRAL_BODY.index(name) for name in joint_names]] = positions
    return body


def _with_reference_bones(body: Floats) -> Floats:
    """Give every bone its length in `NEUTRAL_BODY`, keeping its direction, shape (frame, 24, 3)."""
    frames = np.arange(len(body))
    seen = np.asarray(np.isfinite(body).all(axis=-1))
    parents = np.array(NEUTRAL_BODY.parents)
    reference, own = NEUTRAL_BODY.bone_lengths, _own_bone_lengths(body, parents)
    ancestors = _nearest_seen_ancestors(seen, parents)
    reference_reach, own_reach = _reach(reference, parents), _reach(own, parents)
    rebuilt = np.full_like(body, np.nan)
    rebuilt[:, 0] = body[:, 0]
    for joint in range(1, len(parents)):
        ancestor = ancestors[:, joint]
        way = body[:, joint] - body[frames, ancestor]
        length = np.linalg.norm(way, axis=-1)
        with np.errstate(invalid="ignore", divide="ignore"):
            of_bone = reference[joint] / length
            spanned = (reference_reach[joint] - reference_reach[ancestor]) / (
                own_reach[joint] - own_reach[ancestor]
            )
        # Two joints in one place have no direction between them; they stay together.
        scale = np.where(length > 0.0, np.where(ancestor == parents[joint], of_bone, spanned), 0.0)
        rebuilt[:, joint] = rebuilt[frames, ancestor] + scale[:, None] * way
    return rebuilt


def _own_bone_lengths(body: Floats, parents: Integers) -> Floats:
    """Give the median length of each bone, shape (24,), m; that of a bone never seen follows the others."""
    lengths = np.linalg.norm(body - body[:, parents], axis=-1)
    known = np.isfinite(lengths).any(axis=0)
    known[0] = False
    medians = np.zeros(len(parents))
    medians[known] = np.nanmedian(lengths[:, known], axis=0)
    reference = NEUTRAL_BODY.bone_lengths
    size = medians[known].sum() / reference[known].sum()
    return np.where(known, medians, size * reference)


def _reach(lengths: Floats, parents: Integers) -> Floats:
    """Give the length of the bones from the root to each joint, shape (24,), m."""
    reach = np.zeros(len(parents))
    for joint in range(1, len(parents)):
        reach[joint] = reach[parents[joint]] + lengths[joint]
    return reach


def _nearest_seen_ancestors(seen: Booleans, parents: Integers) -> Integers:
    """Give each joint's nearest seen joint towards the root, in each frame, shape (frame, 24)."""
    ancestors = np.zeros(seen.shape, dtype=np.int64)
    for joint in range(1, len(parents)):
        parent = parents[joint]
        ancestors[:, joint] = np.where(seen[:, parent], parent, ancestors[:, parent])
    return ancestors
