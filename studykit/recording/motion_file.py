"""A table of positions that stands for what a camera recorded."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.motion.motion import JointTracks
from studykit.motion.skeleton import JOINT_NAMES
from studykit.recording.joint_channels import JointChannels

_MARGIN_S = 0.5


@dataclass(frozen=True, kw_only=True, slots=True)
class MotionFile:
    """The positions recorded in one step, in a ``*_motion.tsv``.

    Parameters
    ----------
    path : Path
        The table.
    sha256 : str or None
        Its digest, if the scans tell it.
    channels : JointChannels
        What its columns are.
    rate_hz : float
        Rows a second, for a table without a column of times.
    zero_s : float
        When its first row was taken, s on the session's clock.
    within_s : tuple of float or None
        Of a table with several steps, what belongs to this one, s; half a second more is read on each side.
    """

    path: Path
    sha256: str | None
    channels: JointChannels
    rate_hz: float
    zero_s: float
    within_s: tuple[float, float] | None

    def tracks(self, joint_names: tuple[str, ...]) -> JointTracks:
        """Read where these joints were, on the session's clock.

        Raises
        ------
        InputError
            If it is no table of numbers, its columns are not those that are told, or time does not go on.
        """
        values = self._values()
        times = self._times_s(values)
        if not np.all(np.diff(times) > 0.0):
            line = int(np.argmin(np.diff(times) > 0.0)) + 2
            raise InputError(
                "time does not go on", where=f"{self.path}, line {line}", remedy="sort the rows by their time"
            )
        if self.within_s is not None:
            ends = np.searchsorted(times, np.add(self.within_s, (-_MARGIN_S, _MARGIN_S)))
            times, values = times[slice(*ends)], values[slice(*ends)]
        positions = self.channels.positions(values)[:, [JOINT_NAMES.index(name) for name in joint_names]]
        return JointTracks(
            positions=positions,
            confidence=np.isfinite(positions).all(axis=-1) * np.ones(positions.shape[:2]),
            times_s=times,
            joint_names=joint_names,
        )

    def _values(self) -> Floats:
        lines = self.path.read_text(encoding="utf-8").replace("n/a", "nan").splitlines()
        wanted = self.channels.columns
        try:
            values = np.loadtxt(lines, delimiter="\t", ndmin=2) if lines else np.empty((0, wanted))
        except ValueError as error:
            raise InputError(
                f"it is no table of numbers ({error})", where=self.path, remedy="export it again"
            ) from error
        if values.shape[1] != wanted:
            raise InputError(
                f"it has {values.shape[1]} columns, but {self.channels.path.name} tells of {wanted}",
                where=self.path,
                remedy="tell of every column, in order",
            )
        return np.asarray(values)

    def _times_s(self, values: Floats) -> Floats:
        if self.channels.time is None:
            return np.asarray(self.zero_s + np.arange(len(values)) / self.rate_hz)
        column, second_s = self.channels.time
        return np.asarray(self.zero_s + (values[:, column] - values[:1, column]) * second_s)
