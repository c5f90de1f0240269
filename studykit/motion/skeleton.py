"""Skeletons: which joints a body has, how they hang together and how far apart they are."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from studykit.core.arrays import Floats, Integers, frozen


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Skeleton:
    """A body reduced to joints and the distances between them.

    Parameters
    ----------
    joint_names : tuple of str
        One name a joint, parents before their children.
    parents : tuple of int
        The parent of each joint; -1 for the root, which comes first.
    offsets : array_like, shape (joint, 3), m
        Where each joint lies from its parent while the body stands in its rest pose: right-handed axes, Y up,
        facing +Z, the left side on +X. The root's own offset is zero.
    mirror : tuple of int
        The joint of the other side, for each joint; a joint of the middle is its own.

    Raises
    ------
    ValueError
        If the lists differ in length, a parent comes after its child or `mirror` is not its own inverse.
    """

    joint_names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Floats
    mirror: tuple[int, ...]
    generations: tuple[tuple[Integers, Integers], ...] = field(init=False, repr=False)
    """Joints and their parents, by the number of joints between them and the root."""

    def __post_init__(self) -> None:
        joints = len(self.joint_names)
        if len(self.parents) != joints or len(self.mirror) != joints:
            raise ValueError("joint_names, parents and mirror must have one entry a joint")
        if self.parents[0] != -1 or any(not 0 <= p < j for j, p in enumerate(self.parents) if j):
            raise ValueError("the root comes first and every parent before its children")
        if any(self.mirror[self.mirror[j]] != j for j in range(joints)):
            raise ValueError("mirroring twice must give every joint back")
        object.__setattr__(self, "offsets", frozen(self.offsets, shape=(joints, 3), name="offsets"))
        object.__setattr__(self, "generations", _generations(self.parents))

    def index(self, joint_name: str) -> int:
        """Give the number of a joint from its name."""
        return self.joint_names.index(joint_name)

    def children(self, joint: int) -> tuple[int, ...]:
        """Give the joints that hang on a joint."""
        return tuple(child for child, parent in enumerate(self.parents) if parent == joint)

    @property
    def bone_lengths(self) -> Floats:
        """Distance of each joint from its parent, shape (joint,), m; zero for the root."""
        return np.asarray(np.linalg.norm(self.offsets, axis=1), dtype=np.float64)


def _generations(parents: tuple[int, ...]) -> tuple[tuple[Integers, Integers], ...]:
    depths = [0] * len(parents)
    for joint, parent in enumerate(parents):
        depths[joint] = depths[parent] + 1 if parent >= 0 else 0
    rows = [np.array([j for j, depth in enumerate(depths) if depth == d]) for d in range(1, max(depths) + 1)]
    return tuple((joints, np.array(parents)[joints]) for joints in rows)


# joint, parent, offset from the parent (m) in the neutral mean shape, and in the body of the AIST++ data
# (male mean shape). Numbers as quoted by aioz-ai/GCD and by Stanford-TML/EDGE.
_SMPL_24: tuple[tuple[str, int, tuple[float, float, float], tuple[float, float, float]], ...] = (
    ("pelvis", -1, (-0.001795, -0.223333, 0.028219), (0.000000, 0.000000, 0.000000)),
    ("left_hip", 0, (0.069520, -0.091406, -0.006815), (0.058581, -0.082280, -0.017664)),
    ("right_hip", 0, (-0.067670, -0.090522, -0.004320), (-0.060310, -0.090513, -0.013543)),
    ("spine1", 0, (-0.002533, 0.108963, -0.026696), (0.004439, 0.124404, -0.038385)),
    ("left_knee", 1, (0.034277, -0.375199, -0.004496), (0.043451, -0.386469, 0.008037)),
    ("right_knee", 2, (-0.038290, -0.382569, -0.008850), (-0.043257, -0.383688, -0.004843)),
    ("spine2", 3, (0.005487, 0.135180, 0.001092), (0.004488, 0.137956, 0.026820)),
    ("left_ankle", 4, (-0.013596, -0.397960, -0.043693), (-0.014790, -0.426875, -0.037428)),
    ("right_ankle", 5, (0.015774, -0.398415, -0.042312), (0.019056, -0.420046, -0.034562)),
    ("spine3", 6, (0.001457, 0.052922, 0.025425), (-0.002265, 0.056032, 0.002855)),
    ("left_foot", 7, (0.026358, -0.055791, 0.119288), (0.041054, -0.060286, 0.122042)),
    ("right_foot", 8, (-0.025372, -0.048144, 0.123348), (-0.034840, -0.062106, 0.130323)),
    ("neck", 9, (-0.002778, 0.213870, -0.042857), (-0.013390, 0.211636, -0.033468)),
    ("left_collar", 9, (0.078845, 0.121749, -0.034090), (0.071702, 0.114000, -0.018898)),
    ("right_collar", 9, (-0.081759, 0.118833, -0.038615), (-0.082954, 0.112472, -0.023707)),
    ("head", 12, (0.005152, 0.064970, 0.051349), (0.010113, 0.088937, 0.050410)),
    ("left_shoulder", 13, (0.090977, 0.030469, -0.008868), (0.122921, 0.045205, -0.019046)),
    ("right_shoulder", 14, (-0.096012, 0.032551, -0.009143), (-0.113228, 0.046853, -0.008472)),
    ("left_elbow", 16, (0.259612, -0.012772, -0.027456), (0.255332, -0.015649, -0.022946)),
    ("right_elbow", 17, (-0.253742, -0.013329, -0.021401), (-0.260127, -0.014369, -0.031269)),
    ("left_wrist", 18, (0.249234, 0.008986, -0.001171), (0.265709, 0.012698, -0.007375)),
    ("right_wrist", 19, (-0.255298, 0.007772, -0.005559), (-0.269108, 0.006794, -0.006027)),
    ("left_hand", 20, (0.084042, -0.008162, -0.014945), (0.086691, -0.010636, -0.015594)),
    ("right_hand", 21, (-0.084622, -0.006117, -0.010315), (-0.088754, -0.008652, -0.010107)),
)
_MIRROR = (0, 2, 1, 3, 5, 4, 6, 8, 7, 9, 11, 10, 12, 14, 13, 15, 17, 16, 19, 18, 21, 20, 23, 22)


def _smpl_24(column: int) -> Skeleton:
    offsets = np.array([row[column] for row in _SMPL_24])
    offsets[0] = 0.0
    return Skeleton(
        joint_names=tuple(row[0] for row in _SMPL_24),
        parents=tuple(row[1] for row in _SMPL_24),
        offsets=offsets,
        mirror=_MIRROR,
    )


NEUTRAL_BODY = _smpl_24(2)
"""The 24 joints of SMPL in the neutral mean shape: studykit's one body."""

NEUTRAL_PELVIS = (-0.001795, -0.223333, 0.028219)
"""Where the SMPL model itself puts the pelvis of the neutral mean shape, m; its translation adds to this."""

AIST_BODY = _smpl_24(3)
"""The 24 joints of SMPL with the bone lengths of the AIST++ data set (male mean shape)."""

JOINT_NAMES = NEUTRAL_BODY.joint_names
"""The names of the 24 joints, in SMPL's order."""
