"""What a simulated person dances when a guide is shown: late, not quite as shown, in a body of their own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from studykit.core.arrays import Floats
from studykit.motion import rotation
from studykit.motion.kinematics import centred_positions
from studykit.motion.motion import Motion
from studykit.participant.movement import LARGEST_TURN_RAD, delays_s, wrong_turns
from studykit.participant.person import Person

_GUIDE_HEIGHT_M = 1.70
_SIZES = np.linspace(0.0, LARGEST_TURN_RAD, 5)  # of turns, between which distances are interpolated
_FRAMES_TRIED = 120


def perform(guide: Motion, person: Person, error_m: float, rng: np.random.Generator) -> Motion:
    """Dance along with a guide.

    Parameters
    ----------
    guide : Motion
        What is shown; the floor lies at a height of 0.
    person : Person
        Who dances.
    error_m : float
        Mean distance of the joints from where they should be, m; it does not depend on the dance.
    rng : numpy.random.Generator
        Errors and delays.

    Returns
    -------
    Motion
        What is danced, at the times of the guide's frames.

    Raises
    ------
    ValueError
        If the error is larger than plausible turns of the joints make it; see `copy`.
    """
    copied = copy(own_size(guide, person), error_m, rng)
    return delayed(copied, delays_s(len(guide), rng, frame_rate_hz=guide.frame_rate_hz))


def own_size(guide: Motion, person: Person) -> Motion:
    """Scale a movement from the guide's body to that of a person.

    Parameters
    ----------
    guide : Motion
        The movement of a body of 1.70 m.
    person : Person
        Whose height counts.

    Returns
    -------
    Motion
        The same turns in a body with longer or shorter bones.
    """
    scale = person.height_m / _GUIDE_HEIGHT_M
    skeleton = replace(guide.skeleton, offsets=scale * guide.skeleton.offsets)
    return replace(guide, skeleton=skeleton, root_positions=scale * guide.root_positions)


def copy(intended: Motion, error_m: float, rng: np.random.Generator) -> Motion:
    """Miss a movement by a given distance: each joint is smoothly turned wrong, on its own.

    Parameters
    ----------
    intended : Motion
        How the joints should be turned.
    error_m : float
        Mean distance over frames and joints between where the joints get and where they should be, m; the
        result has it within 1 %.
    rng : numpy.random.Generator
        The errors; see `wrong_turns`.

    Returns
    -------
    Motion
        The same body, whose root is where it should be.

    Raises
    ------
    ValueError
        If the error is negative, or takes larger turns than `LARGEST_TURN_RAD` at the shoulders.
    """
    turns = wrong_turns(
        intended.skeleton.joint_names, len(intended), rng, frame_rate_hz=intended.frame_rate_hz
    )
    size = _size_of_turns(intended, turns, error_m)
    return replace(intended, rotations=rotation.multiply(intended.rotations, rotation.exp(size * turns)))


def delayed(motion: Motion, delay_s: Floats) -> Motion:
    """Show a movement late; before it begins, its first pose is held.

    Parameters
    ----------
    motion : Motion
        The movement.
    delay_s : ndarray, shape (frame,), s
        Delay of each frame, 0 or more.

    Returns
    -------
    Motion
    """
    last = len(motion) - 1
    at = np.clip(np.arange(last + 1) - delay_s * motion.frame_rate_hz, 0.0, last)
    before = np.floor(at).astype(np.int64)
    after = np.minimum(before + 1, last)
    share = (at - before)[:, None]
    root = motion.root_positions
    return replace(
        motion,
        rotations=rotation.slerp(motion.rotations[before], motion.rotations[after], share),
        root_positions=(1.0 - share) * root[before] + share * root[after],
    )


def _size_of_turns(intended: Motion, turns: Floats, error_m: float) -> float:
    """Find by how much to multiply the turns so that the joints miss by `error_m` on average."""
    # Turns are smooth in time and the distance grows smoothly with them: a few of both are enough.
    some = slice(None, None, -(-len(intended) // _FRAMES_TRIED))
    tried = rotation.exp(_SIZES[:, None, None, None] * turns[some])
    positions = centred_positions(intended.skeleton, rotation.multiply(intended.rotations[some], tried))
    distances_m = np.linalg.norm(positions - positions[0], axis=-1).mean(axis=(1, 2))
    if not 0.0 <= error_m <= distances_m[-1]:
        raise ValueError(
            f"error_m is {error_m:.3f}, expected 0 to {distances_m[-1]:.3f}: "
            f"the shoulders turn wrong by at most {LARGEST_TURN_RAD:g} rad (root mean square)"
        )
    through_all = np.polynomial.Polynomial.fit(distances_m, _SIZES, deg=len(_SIZES) - 1)
    return float(through_all(error_m))
