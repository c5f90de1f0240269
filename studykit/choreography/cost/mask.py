"""Spared joints do little (section 7.1): what they do is a measure of its own, wanted to be nothing.

Eq. 11 as printed only leaves them out of the energy, so that an arm that flails costs nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from studykit.core.arrays import Floats
from studykit.motion.joint_mask import JointMask

if TYPE_CHECKING:
    from studykit.choreography.dance_library import DanceLibrary


def spared_energies(library: DanceLibrary, mask: JointMask) -> Floats:
    """Give how much spared joints turn in each segment: the sum of (1 - a_j) E_j, J per kg.

    Returns
    -------
    ndarray, shape (segment,)
    """
    return np.asarray(library.rotational_energies @ (1.0 - mask.weights), dtype=np.float64)


def mask_tolerance(library: DanceLibrary, mask: JointMask) -> float:
    """Give sigma_M for one segment: what spared joints do in a middling segment of the library, J per kg."""
    spared = spared_energies(library, mask)
    return float(np.median(spared[spared > 0.0])) if np.any(spared > 0.0) else 1.0
