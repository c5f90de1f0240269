"""Frames of a camera on disk: many, small, each with its own checksum."""

from __future__ import annotations

import hashlib
import os
import zlib
from pathlib import Path

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.motion.motion import JointTracks
from studykit.recording.journal import unwritable, write_all

_CONFIDENCE_STEPS = 255


def _layout(joints: int) -> np.dtype[np.void]:
    """Give the fixed record of one frame: little endian, without padding."""
    return np.dtype(
        [
            ("time_s", "<f8"),
            ("positions", "<f4", (joints, 3)),
            ("confidence", "u1", (joints,)),
            ("crc32", "<u4"),
        ]
    )


class FrameWriter:
    """A file of frames that is being written; it begins anew and never replaces another.

    Parameters
    ----------
    path : Path
        The file, which must not exist yet.
    joint_names : tuple of str
        One name a joint.
    """

    def __init__(self, path: Path, joint_names: tuple[str, ...]) -> None:
        self.path = path
        self.count = 0
        self._sha256 = hashlib.sha256()
        self._record = np.zeros((), dtype=_layout(len(joint_names)))
        self._is_synced = True
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("xb", buffering=0)
        except OSError as error:
            raise unwritable(path.parent, error) from error

    def append(self, time_s: float, positions: Floats, confidence: Floats) -> None:
        """Write one frame; the operating system has it on return, the disk after `sync`.

        Parameters
        ----------
        time_s : float
            When it was taken, s.
        positions : ndarray, shape (joint, 3), m
            NaN where unseen.
        confidence : ndarray, shape (joint,)
            0 to 1, kept in steps of 1/255.
        """
        record = self._record
        record["time_s"], record["positions"] = time_s, positions
        record["confidence"] = np.rint(confidence * _CONFIDENCE_STEPS)
        body = record.tobytes()[:-4]
        data = body + zlib.crc32(body).to_bytes(4, "little")
        write_all(self._file, data)
        self._sha256.update(data)
        self.count, self._is_synced = self.count + 1, False

    @property
    def sha256(self) -> str:
        """Digest of what the file holds so far."""
        return self._sha256.hexdigest()

    def sync(self) -> None:
        """Wait until the disk has everything."""
        if not self._is_synced:
            os.fsync(self._file.fileno())
            self._is_synced = True

    def close(self) -> None:
        """Sync and close; closing twice does no harm."""
        if not self._file.closed:
            self.sync()
            self._file.close()


def read_frames(path: Path, joint_names: tuple[str, ...]) -> JointTracks:
    """Read the frames of a file; a frame cut off at the end is left out.

    Frames that a camera sent late, after a younger one, are left out too.

    Raises
    ------
    InputError
        If a frame before the end is damaged.
    """
    layout = _layout(len(joint_names))
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(
            "the frames cannot be read", where=path, remedy="restore the file from a copy of the study"
        ) from error
    size = layout.itemsize
    content = content[: len(content) // size * size]
    records = np.frombuffer(content, dtype=layout)
    sums = [zlib.crc32(content[start : start + size - 4]) for start in range(0, len(content), size)]
    whole = np.flatnonzero(records["crc32"] == np.array(sums, dtype=np.uint32))
    count = len(whole)
    if count and whole[-1] != count - 1:
        damaged = int(np.setdiff1d(np.arange(whole[-1]), whole)[0]) + 1
        raise InputError(
            "the frame does not agree with its checksum",
            where=f"{path}, frame {damaged}",
            remedy="restore the file from a copy of the study",
        )
    return _tracks(records[:count], joint_names)


def _tracks(records: np.ndarray, joint_names: tuple[str, ...]) -> JointTracks:
    times = records["time_s"]
    earlier = np.concatenate([[-np.inf], np.maximum.accumulate(times)[:-1]]) if len(times) else times
    kept = records[times > earlier]
    return JointTracks(
        positions=kept["positions"],
        confidence=kept["confidence"] / _CONFIDENCE_STEPS,
        times_s=kept["time_s"],
        joint_names=joint_names,
    )
