"""How fast a joint turns where two segments meet, quickly enough to ask while searching.

The joints of a body keep their turns relative to their parents when a segment is moved and turned to where
the last one ended; only the pelvis does not, whose heading is brought in line first. So what a blend does to
any joint but the pelvis depends on the turns of that joint alone, and this repeats, for one joint, what
`studykit.motion.blending.joined` does to all.
"""

from __future__ import annotations

from math import atan2, cos, sin, sqrt

from numba import njit

from studykit.core.arrays import Floats
from studykit.motion.blending import HALF_WINDOW
from studykit.motion.segmentation import FRAME_RATE_HZ

_Four = tuple[float, float, float, float]
_Three = tuple[float, float, float]


@njit(cache=True, nogil=True)
def _product(a: _Four, b: _Four) -> _Four:
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


@njit(cache=True, nogil=True)
def _back(a: _Four) -> _Four:
    return a[0], -a[1], -a[2], -a[3]


@njit(cache=True, nogil=True)
def _between(a: _Four, b: _Four) -> _Three:
    """Give the rotation vector from a to b, at most pi long."""
    w, x, y, z = _product(_back(a), b)
    sine = sqrt(x * x + y * y + z * z)
    scale = 2.0 if sine < 1e-12 else 2.0 * atan2(sine, abs(w)) / sine
    if w < 0.0:
        scale = -scale
    return scale * x, scale * y, scale * z


@njit(cache=True, nogil=True)
def _turn(v: _Three, scale: float) -> _Four:
    """Give the rotation of a scaled rotation vector."""
    angle = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * abs(scale)
    share = 0.5 * scale if angle < 1e-8 else scale * sin(0.5 * angle) / angle
    return cos(0.5 * angle), share * v[0], share * v[1], share * v[2]


@njit(cache=True, nogil=True)
def _seen(turn: _Four, v: _Three) -> _Three:
    """Turn a vector."""
    _, x, y, z = _product(_product(turn, (0.0, v[0], v[1], v[2])), _back(turn))
    return x, y, z


@njit(cache=True, nogil=True)
def _row(rows: Floats, n: int) -> _Four:
    return rows[n, 0], rows[n, 1], rows[n, 2], rows[n, 3]


@njit(cache=True, nogil=True)
def join_peak(tail: Floats, head: Floats) -> float:
    """Give how fast, at most, a joint turns while one segment blends into the next ("offset").

    Parameters
    ----------
    tail : ndarray, shape (frame, 4)
        The joint's turns relative to its parent in the last frames of a segment, at least six: unit
        quaternions. Any joint but the pelvis.
    head : ndarray, shape (frame, 4)
        The same in the first frames of the segment that follows.

    Returns
    -------
    float, rad/s
        The largest of the eleven steps that the blend changes, at the frame rate of segments.
    """
    last = len(tail) - 1
    speed_before = _between(_row(tail, last - 1), _row(tail, last))
    speed_after = _between(_row(head, 0), _row(head, 1))
    gap = _between(
        _product(_row(tail, last), _turn(speed_before, 0.5)),
        _product(_row(head, 0), _turn(speed_after, -0.5)),
    )
    half = _turn(gap, 0.5)
    sped, slowed = _seen(half, speed_after), _seen(_back(half), speed_before)
    faster = (sped[0] - slowed[0], sped[1] - slowed[1], sped[2] - slowed[2])

    before = _row(tail, last - HALF_WINDOW)
    # The fastest step as sine and cosine of half its angle, squared: one arc tangent is enough.
    sine, cosine = 0.0, 1.0
    for frame in range(-HALF_WINDOW, HALF_WINDOW + 1):
        now = _row(tail, last + 1 + frame) if frame < 0 else _row(head, frame)
        near = max(0.0, 1.0 - abs(frame + 0.5) / HALF_WINDOW)  # 1 at the join, 0 where the window ends
        if near > 0.0:
            value = near * near * (3.0 - 2.0 * near) * (0.5 if frame < 0 else -0.5)
            slope = HALF_WINDOW * near * near * (near - 1.0) * 0.5
            spread = (
                value * gap[0] + slope * faster[0],
                value * gap[1] + slope * faster[1],
                value * gap[2] + slope * faster[2],
            )
            now = _product(now, _turn(spread, 1.0))
        w, x, y, z = _product(_back(before), now)
        if (x * x + y * y + z * z) * cosine > sine * w * w:
            sine, cosine = x * x + y * y + z * z, w * w
        before = now
    return 2.0 * FRAME_RATE_HZ * atan2(sqrt(sine), sqrt(cosine))
