"""What a movement looks like, as numbers: 97 values a pose, 11,640 a segment (section 5.4 of the paper)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from studykit.core.arrays import Floats, frozen
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY

KINETIC = 3 * len(JOINT_NAMES)
GEOMETRIC_NAMES = (
    "elbow_left", "elbow_right", "knee_left", "knee_right",
    "shoulder_elevation_left", "shoulder_elevation_right", "hip_elevation_left", "hip_elevation_right",
    "ankle_left", "ankle_right", "trunk_inclination", "trunk_twist",
    "hand_over_neck_left", "hand_over_neck_right", "hand_forward_left", "hand_forward_right",
    "hands_apart", "hand_to_root_left", "hand_to_root_right", "feet_apart",
    "foot_raised_left", "foot_raised_right", "foot_fore_aft_left", "foot_fore_aft_right", "vertical_extent",
)  # fmt: skip
FEATURE_NAMES = (
    *(f"{joint}_{kind}" for joint in JOINT_NAMES for kind in ("horizontal", "vertical", "effort")),
    *GEOMETRIC_NAMES,
)
"""72 kinetic values (three a joint), then 25 geometric ones."""

_HALF_WINDOW = 2
_CLIP = 5.0


def pose_features(positions: Floats, frame_rate_hz: float) -> Floats:
    """Give the 97 values of every pose.

    Parameters
    ----------
    positions : ndarray, shape (frame, 24, 3), m
        Pelvis-centred joint positions of one uninterrupted stretch.
    frame_rate_hz : float
        Frames a second.

    Returns
    -------
    ndarray, shape (frame, 97)
        In the order of `FEATURE_NAMES`: m2/s2, m2/s2 and m/s2 for the kinetic values, rad and shares of body
        height for the geometric ones.
    """
    return np.concatenate((kinetic(positions, frame_rate_hz), geometric(positions)), axis=1)


def kinetic(positions: Floats, frame_rate_hz: float) -> Floats:
    """Give how lively each joint is: horizontal, vertical and effort (Onuma et al. 2008), shape (frame, 72).

    Velocities and accelerations are averaged over five frames, fewer at the ends.
    """
    frames = len(positions)
    now = np.arange(frames)
    first = np.maximum(now - _HALF_WINDOW - 1, 0)
    last = np.minimum(now + _HALF_WINDOW, frames - 1)
    steps = (last - first)[:, None, None]
    # A mean of neighbouring differences is the difference of the ends.
    velocity = (positions[last] - positions[first]) * (frame_rate_hz / steps)

    first = np.clip(now - _HALF_WINDOW, 1, frames - 2)
    last = np.clip(now + _HALF_WINDOW, 1, frames - 2)
    steps = (last - first + 1)[:, None, None]
    change = (positions[last + 1] - positions[last]) - (positions[first] - positions[first - 1])
    acceleration = change * (frame_rate_hz**2 / steps)

    horizontal = velocity[..., 0] ** 2 + velocity[..., 2] ** 2
    values = np.stack((horizontal, velocity[..., 1] ** 2, np.linalg.norm(acceleration, axis=-1)), axis=-1)
    return values.reshape(frames, KINETIC)


def geometric(positions: Floats) -> Floats:
    """Give the shape of each pose: 25 angles and distances (after Mueller et al. 2005), shape (frame, 25).

    Angles in rad; distances as shares of trunk and leg length of the mean body. Unchanged by where the
    dancer stands and which way the dancer faces.
    """
    at = {name: positions[..., joint, :] for joint, name in enumerate(JOINT_NAMES)}
    down = at["pelvis"] - at["neck"]
    up = -_unit(down)
    across = _unit(at["left_hip"] - at["right_hip"])
    front = _unit(np.cross(across, up))
    height = _body_height()
    lowest = positions[..., 1].min(axis=-1)
    vertical = np.broadcast_to(np.array([0.0, 1.0, 0.0]), down.shape)

    def both(kind: str, reference: str, towards: str) -> list[Floats]:
        return [
            _angle(
                at[f"{side}_{reference}"] - at[f"{side}_{kind}"],
                at[f"{side}_{towards}"] - at[f"{side}_{kind}"],
            )
            for side in ("left", "right")
        ]

    hips = _unit(_without(at["left_hip"] - at["right_hip"], up))
    shoulders = _unit(_without(at["left_shoulder"] - at["right_shoulder"], up))
    chest_up = _unit(at["neck"] - at["spine3"])
    hands = (at["left_wrist"], at["right_wrist"])
    ankles = (at["left_ankle"], at["right_ankle"])
    columns = [
        *both("elbow", "shoulder", "wrist"),
        *both("knee", "hip", "ankle"),
        *(_angle(at[f"{side}_elbow"] - at[f"{side}_shoulder"], down) for side in ("left", "right")),
        *(_angle(at[f"{side}_knee"] - at[f"{side}_hip"], down) for side in ("left", "right")),
        *both("ankle", "knee", "foot"),
        _angle(-down, vertical),
        np.arctan2(_dot(np.cross(hips, shoulders), up), _dot(hips, shoulders)),
        *(_dot(hand - at["neck"], chest_up) / height for hand in hands),
        *(_dot(hand - at["neck"], front) / height for hand in hands),
        np.linalg.norm(hands[0] - hands[1], axis=-1) / height,
        *(np.linalg.norm(hand - at["pelvis"], axis=-1) / height for hand in hands),
        np.linalg.norm(ankles[0] - ankles[1], axis=-1) / height,
        *((ankle[..., 1] - lowest) / height for ankle in ankles),
        *(_dot(ankle - at["pelvis"], front) / height for ankle in ankles),
        (positions[..., 1].max(axis=-1) - lowest) / height,
    ]
    return np.stack(columns, axis=-1)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FeatureScaler:
    """How the 97 values are made comparable: one for a whole library.

    Parameters
    ----------
    kinetic_medians : array_like, shape (72,)
        Median of each kinetic channel's positive values: the knee of the logarithm.
    means, deviations : array_like, shape (97,)
        Mean and standard deviation of each channel, after the logarithm, over all poses.
    """

    kinetic_medians: Floats
    means: Floats
    deviations: Floats

    def __post_init__(self) -> None:
        for name, length in (("kinetic_medians", KINETIC), ("means", 97), ("deviations", 97)):
            object.__setattr__(self, name, frozen(getattr(self, name), shape=(length,), name=name))

    def logarithmic(self, raw: Floats) -> Floats:
        """Take the logarithm of the kinetic channels, log(1 + k / k0); shape (..., 97) in and out."""
        values = np.array(raw, dtype=np.float64)
        kinetic = values[..., :KINETIC]
        kinetic /= self.kinetic_medians
        np.log1p(kinetic, out=kinetic)
        return values

    def standardised(self, raw: Floats) -> Floats:
        """Give values of mean 0 and deviation 1 in every channel, clipped to +-5, shape (..., 97).

        A channel that never changes, such as the pelvis from itself, becomes zero.
        """
        alive = self.deviations > 1e-8
        scale = np.where(alive, 1.0 / np.where(alive, self.deviations, 1.0), 0.0)
        values = self.logarithmic(raw)
        values -= self.means
        values *= scale
        return np.clip(values, -_CLIP, _CLIP, out=values)


def _body_height() -> float:
    """Pelvis to neck, thigh and shank of the mean body, m."""
    offsets, bones, index = NEUTRAL_BODY.offsets, NEUTRAL_BODY.bone_lengths, NEUTRAL_BODY.index
    trunk = sum(offsets[index(name)] for name in ("spine1", "spine2", "spine3", "neck"))
    return float(np.linalg.norm(trunk) + bones[index("left_knee")] + bones[index("left_ankle")])


def _dot(first: Floats, second: Floats) -> Floats:
    return np.asarray(np.sum(first * second, axis=-1))


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9))


def _without(vectors: Floats, direction: Floats) -> Floats:
    return np.asarray(vectors - _dot(vectors, direction)[..., None] * direction)


def _angle(first: Floats, second: Floats) -> Floats:
    """Angle between vectors, rad, exact near 0 and pi."""
    return np.asarray(np.arctan2(np.linalg.norm(np.cross(first, second), axis=-1), _dot(first, second)))
