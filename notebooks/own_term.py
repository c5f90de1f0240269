"""A term of one's own: how much of the work the legs do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from studykit.motion.skeleton import JOINT_NAMES

LEGS = [joint for joint, name in enumerate(JOINT_NAMES) if name.endswith(("hip", "knee", "ankle", "foot"))]


@dataclass(frozen=True, kw_only=True)
class LegShare:
    """The share of a dance's energy that is in hips, knees, ankles and feet.

    A term has a name, a weight (1 counts as much as each other goal), the mean over the dance's segments that is
    wanted, and a deviation from it that still counts as small.
    """

    target: float
    tolerance: float = 0.02
    weight: float = 1.0
    name: str = "legs"

    def values(self, library):
        """Give the share of every segment, shape (segment,)."""
        energies = library.linear_energies + library.rotational_energies
        return np.asarray(energies[:, LEGS].sum(axis=1) / energies.sum(axis=1))
