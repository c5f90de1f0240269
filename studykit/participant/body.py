"""Where the joints of a simulated person are at any moment: standing, or in the middle of a movement."""

from __future__ import annotations

import numpy as np

from studykit.core.arrays import Floats


class Body:
    """A body that stands still until it is given a movement.

    Parameters
    ----------
    standing : ndarray, shape (joint, 3), m
        Where the joints are while the person stands.
    """

    def __init__(self, standing: Floats) -> None:
        self._standing = standing
        self._movement = standing[None]
        self._frame_rate_hz, self._start_s = 1.0, np.inf

    def move(self, movement: Floats, *, frame_rate_hz: float, start_s: float) -> None:
        """Begin a movement; after its end the person stands again.

        Parameters
        ----------
        movement : ndarray, shape (frame, joint, 3), m
            Where the joints will be.
        frame_rate_hz : float
            Frames a second.
        start_s : float
            When its first frame is shown, s.
        """
        self._movement, self._frame_rate_hz, self._start_s = movement, frame_rate_hz, start_s

    def positions_at(self, time_s: float) -> Floats:
        """Give where the joints are, between two frames on the straight line.

        Parameters
        ----------
        time_s : float
            When.

        Returns
        -------
        ndarray, shape (joint, 3), m
        """
        frame = (time_s - self._start_s) * self._frame_rate_hz
        if not 0.0 <= frame < len(self._movement):
            return self._standing
        before = int(frame)
        after = min(before + 1, len(self._movement) - 1)
        share = frame - before
        return np.asarray((1.0 - share) * self._movement[before] + share * self._movement[after])
