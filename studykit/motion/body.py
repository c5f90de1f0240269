"""How heavy each part of a body is and how hard to turn (Winter 2009)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from studykit.core.arrays import Floats, frozen
from studykit.motion.skeleton import NEUTRAL_BODY, Skeleton

DEFAULT_BODY_MASS_KG = 73.5
"""Mean body mass of the participants of the paper; turns energies per mass into its unit."""

DEFAULT_STATURE_M = 1.759
"""Stature of the average adult male (50th percentile, Huston 2009)."""

# Joint: share of body mass, radius of gyration about the centre of mass as a share of the segment's length,
# and the child towards which the segment points. A joint carries the segment that its rotation moves; what
# SMPL cuts in two is split equally; the collars take Dempster's shoulder mass out of the thorax
# (Winter 2009, table 4.1; Robertson et al. 2004 for the shoulder).
_SEGMENTS: dict[str, tuple[float, float, str]] = {
    "pelvis": (0.142, 0.503, "spine1"),
    "hip": (0.100, 0.323, "knee"),
    "spine1": (0.0695, 0.503, "spine2"),
    "knee": (0.0465, 0.302, "ankle"),
    "spine2": (0.0695, 0.503, "spine3"),
    "ankle": (0.00725, 0.475, "foot"),
    "spine3": (0.1844, 0.503, "neck"),
    "foot": (0.00725, 0.475, ""),
    "neck": (0.0405, 0.495, "head"),
    "collar": (0.0158, 0.503, "shoulder"),
    "head": (0.0405, 0.495, ""),
    "shoulder": (0.028, 0.322, "elbow"),
    "elbow": (0.016, 0.303, "wrist"),
    "wrist": (0.003, 0.297, "hand"),
    "hand": (0.003, 0.297, ""),
}
# Lengths as shares of stature (Drillis and Contini, in Winter 2009, figure 4.1): of long bones, to which the
# skeleton is scaled, and of end segments, whose last joint has no child to measure.
_BONE_SHARES = {"knee": 0.245, "ankle": 0.246, "elbow": 0.186, "wrist": 0.146}
_END_SHARES = {"foot": 0.152, "head": 0.182, "hand": 0.108}


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class BodySegments:
    """What each joint carries.

    Parameters
    ----------
    masses : array_like, shape (24,)
        Share of body mass; they add up to 1.
    gyration_radii : array_like, shape (24,)
        Radius of gyration k as a share of the segment's length.
    lengths : array_like, shape (24,), m
        Segment length L.
    """

    masses: Floats
    gyration_radii: Floats
    lengths: Floats

    def __post_init__(self) -> None:
        for name in ("masses", "gyration_radii", "lengths"):
            object.__setattr__(self, name, frozen(getattr(self, name), shape=(24,), name=name))

    @property
    def inertias(self) -> Floats:
        """Moment of inertia of each segment per body mass, m (k L)^2, shape (24,), m2."""
        return np.asarray(self.masses * (self.gyration_radii * self.lengths) ** 2)


@lru_cache(maxsize=8)
def segments(skeleton: Skeleton = NEUTRAL_BODY, *, stature_m: float = DEFAULT_STATURE_M) -> BodySegments:
    """Give the mass, radius of gyration and length of what each joint of a body carries.

    Parameters
    ----------
    skeleton : Skeleton
        A skeleton of SMPL's 24 joints. Its joints lie inside a mesh, so its long bones are shorter than a
        living person's; all lengths are scaled so that they fit best.
    stature_m : float
        Height of the person.
    """
    bones = skeleton.bone_lengths
    kinds = [name.split("_")[-1] for name in skeleton.joint_names]
    long_bones = np.array([kind in _BONE_SHARES for kind in kinds])
    wanted = stature_m * np.array([_BONE_SHARES.get(kind, 0.0) for kind in kinds])
    scale = float(bones[long_bones] @ wanted[long_bones] / (bones[long_bones] @ bones[long_bones]))

    lengths = np.zeros(len(kinds))
    for joint, kind in enumerate(kinds):
        towards = _SEGMENTS[kind][2]
        if towards:
            child = next(c for c in skeleton.children(joint) if kinds[c] == towards)
            lengths[joint] = scale * bones[child]
        else:
            lengths[joint] = stature_m * _END_SHARES[kind] - scale * bones[joint]
    return BodySegments(
        masses=np.array([_SEGMENTS[kind][0] for kind in kinds]),
        gyration_radii=np.array([_SEGMENTS[kind][1] for kind in kinds]),
        lengths=lengths,
    )
