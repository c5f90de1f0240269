"""SMPL's joints from COCO's seventeen points, which know nothing of spine, feet and hands."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from studykit.core.arrays import Floats
from studykit.motion import kinematics, rotation
from studykit.motion.inverse_kinematics import fit, measured_body
from studykit.motion.motion import Motion
from studykit.motion.retargeting import leg_length
from studykit.motion.skeleton import AIST_BODY, Skeleton

COCO_JOINTS = (
    "nose",
    "left_eye",
    "right_eye",
    "left_ear",
    "right_ear",
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
)
"""COCO's points in their order."""

_SPINE = ("spine1", "spine2", "spine3", "neck")
_NOT_SEEN = [f"{side}_{joint}" for side in ("left", "right") for joint in ("ankle", "foot", "wrist", "hand")]


def body_from_coco(points: Floats, *, frame_rate_hz: float) -> Motion:
    """Find how SMPL's joints are turned when only COCO's points were seen.

    Parameters
    ----------
    points : ndarray, shape (frame, 17, 3), m
        Y up, without gaps, in the order of `COCO_JOINTS`.
    frame_rate_hz : float
        Frames a second.

    Returns
    -------
    Motion
        On a body with the bone lengths that were seen.

    Notes
    -----
    Shoulders, elbows, wrists, hips, knees and ankles are where they were seen. Hips and the line to the
    shoulders give the turn of the pelvis, which lies above the middle of the hips as in the rest pose;
    shoulders and that line give the turn of the chest; the spine between has the curve of the rest pose,
    turned step by step from one to the other. Nose, eyes and ears give the turn of the head, half of which
    the neck takes. Ankles and wrists are not turned.
    """
    seen = {name: points[:, number] for number, name in enumerate(COCO_JOINTS)}
    body = _of_size(seen)
    rest = dict(zip(body.joint_names, kinematics.centred_positions(body, rotation.identity(24)), strict=True))
    pelvis_turn = _turn(seen, rest, "hip", rotation.identity(len(points)))
    chest_turn = _turn(seen, rest, "shoulder", pelvis_turn)
    places = _trunk(seen, rest, pelvis_turn, chest_turn)
    head_turn = _head_turn(seen, chest_turn)
    half = rotation.slerp(chest_turn, head_turn, np.array(0.5))
    places["head"] = places["neck"] + rotation.rotate(half, rest["head"] - rest["neck"])
    for side in ("left", "right"):
        for limb, end in (("ankle", "foot"), ("wrist", "hand")):
            offset = rest[f"{side}_{end}"] - rest[f"{side}_{limb}"]
            places[f"{side}_{end}"] = seen[f"{side}_{limb}"] + rotation.rotate(pelvis_turn, offset)
    known = seen | places
    positions = np.stack([known[name] for name in body.joint_names], axis=1)
    person = measured_body(positions, body)
    found = fit(positions, person, frame_rate_hz=frame_rate_hz, rounds=0)
    rotations = np.array(found.rotations)
    world = kinematics.global_rotations(person, rotations)
    neck, head = person.index("neck"), person.index("head")
    rotations[:, head] = rotation.multiply(rotation.inverse(world[:, neck]), head_turn)
    rotations[:, [person.index(name) for name in _NOT_SEEN]] = rotation.identity()
    return Motion(
        skeleton=person,
        rotations=rotations,
        root_positions=places["pelvis"],
        frame_rate_hz=frame_rate_hz,
    )


def _of_size(seen: dict[str, Floats]) -> Skeleton:
    """Give the body of AIST++ the leg length that was seen."""
    bones = [
        (f"{s}_{a}", f"{s}_{b}") for s in ("left", "right") for a, b in (("hip", "knee"), ("knee", "ankle"))
    ]
    lengths = [np.median(np.linalg.norm(seen[end] - seen[start], axis=-1)) for start, end in bones]
    scale = max(float(np.sum(lengths)) / 2.0 / leg_length(AIST_BODY), 1e-6)
    return replace(AIST_BODY, offsets=AIST_BODY.offsets * scale)


def _middle(places: dict[str, Floats], joint: str) -> Floats:
    return np.asarray(0.5 * (places[f"left_{joint}"] + places[f"right_{joint}"]))


def _axes(left: Floats, up: Floats) -> Floats:
    """Make matrices whose columns point left, up and to the front; `left` is kept, `up` gives way."""
    first = _unit(left)
    second = _unit(up - np.sum(up * first, axis=-1, keepdims=True) * first)
    return np.stack((first, second, np.cross(first, second)), axis=-1)


def _turned(left: Floats, up: Floats, else_turned: Floats) -> Floats:
    """Give the turns that carry X to `left` and Y near `up`; another where the two lie on one line."""
    across = np.linalg.norm(np.cross(left, up), axis=-1)
    tells = across > 1e-9 + 0.01 * np.linalg.norm(left, axis=-1) * np.linalg.norm(up, axis=-1)
    known = tells[:, None]
    axes = _axes(np.where(known, left, [1.0, 0.0, 0.0]), np.where(known, up, [0.0, 1.0, 0.0]))
    return np.where(known, rotation.from_matrix(axes), else_turned)


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12))


def _turn(seen: dict[str, Floats], rest: dict[str, Floats], joint: str, else_turned: Floats) -> Floats:
    """Give how the line between two joints and the length of the trunk are turned from rest."""
    now, then = (
        (
            places[f"left_{joint}"] - places[f"right_{joint}"],
            _middle(places, "shoulder") - _middle(places, "hip"),
        )
        for places in (seen, rest)
    )
    at_rest = rotation.from_matrix(_axes(*then))
    turned = _turned(*now, rotation.multiply(else_turned, at_rest))
    return rotation.multiply(turned, rotation.inverse(at_rest))


def _trunk(
    seen: dict[str, Floats], rest: dict[str, Floats], pelvis_turn: Floats, chest_turn: Floats
) -> dict[str, Floats]:
    """Place pelvis, spine, neck and collars between hips and shoulders."""
    pelvis = _middle(seen, "hip") + rotation.rotate(pelvis_turn, rest["pelvis"] - _middle(rest, "hip"))
    neck = _middle(seen, "shoulder") + rotation.rotate(chest_turn, rest["neck"] - _middle(rest, "shoulder"))
    chain = ("pelvis", *_SPINE)
    bones = [rest[end] - rest[start] for start, end in pairwise(chain)]
    shares = np.cumsum([np.linalg.norm(bone) for bone in bones])
    shares = shares / shares[-1]
    curve = [np.zeros(3)]
    for bone, share in zip(bones, shares, strict=True):
        turn = rotation.slerp(pelvis_turn, chest_turn, np.array(share))
        curve.append(curve[-1] + rotation.rotate(turn, bone))
    missing = neck - pelvis - curve[-1]
    places = {
        name: pelvis + place + share * missing
        for name, place, share in zip(chain, curve, (0.0, *shares), strict=True)
    }
    for side in ("left", "right"):
        offset = rest[f"{side}_collar"] - rest["spine3"]
        places[f"{side}_collar"] = places["spine3"] + rotation.rotate(chest_turn, offset)
    return places


def _head_turn(seen: dict[str, Floats], chest_turn: Floats) -> Floats:
    """Give how the head is turned: ears lie left and right of each other, the face in front of them."""
    left = seen["left_ear"] - seen["right_ear"]
    face = (seen["nose"] + seen["left_eye"] + seen["right_eye"]) / 3.0
    front = face - _middle(seen, "ear")
    return _turned(left, np.cross(front, left), chest_turn)
