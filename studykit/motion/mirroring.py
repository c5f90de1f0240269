"""The same dance as seen in a mirror: left and right change places."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from studykit.motion.motion import Motion

# Mirroring at the plane x = 0 keeps what turns about x and reverses what turns about y or z.
_ROTATION_SIGNS = np.array([1.0, 1.0, -1.0, -1.0])
_POSITION_SIGNS = np.array([-1.0, 1.0, 1.0])


def mirrored(motion: Motion) -> Motion:
    """Give the movement that a dancer's mirror image makes: what the left side did, the right side does.

    Parameters
    ----------
    motion : Motion
        On any skeleton that faces +Z at rest, with its left side on +X.

    Returns
    -------
    Motion
        On the same skeleton, at the same rate. Mirroring twice gives the motion back.

    Notes
    -----
    With M the reflection x -> -x, a rotation R becomes M R M: of its axis times angle, y and z change their
    sign. The root keeps y and z, and x changes its sign. The body itself is not reflected: on the neutral
    mean shape, whose sides differ by up to 11 mm a bone, joints meet their mirror images within a few
    centimetres; on a symmetric body they meet exactly.

    Examples
    --------
    A left elbow bent by 0.5 rad about y becomes a right elbow bent by -0.5 rad about y.

    >>> from studykit.motion import rotation
    >>> from studykit.motion.skeleton import NEUTRAL_BODY
    >>> bends = np.zeros((1, 24, 3))
    >>> bends[0, NEUTRAL_BODY.index("left_elbow")] = [0.0, 0.5, 0.0]
    >>> motion = Motion(
    ...     skeleton=NEUTRAL_BODY,
    ...     rotations=rotation.exp(bends),
    ...     root_positions=[[0.25, 1.0, 0.0]],
    ...     frame_rate_hz=30.0,
    ... )
    >>> image = mirrored(motion)
    >>> float(rotation.log(image.rotations)[0, NEUTRAL_BODY.index("right_elbow"), 1].round(6))
    -0.5
    >>> image.root_positions.tolist()
    [[-0.25, 1.0, 0.0]]
    """
    return replace(
        motion,
        rotations=motion.rotations[:, list(motion.skeleton.mirror)] * _ROTATION_SIGNS,
        root_positions=motion.root_positions * _POSITION_SIGNS,
    )
