from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.recording.frames import FrameWriter, read_frames

NAMES = ("pelvis", "head", "left_hand")
SIZE = 8 + 3 * 3 * 4 + 3 + 4


def written(path: Path, count: int = 20) -> bytes:
    rng = np.random.default_rng(1)
    writer = FrameWriter(path, NAMES)
    for frame in range(count):
        positions = rng.normal(size=(3, 3))
        positions[1] = np.nan if frame == 4 else positions[1]
        writer.append(frame / 30, positions, np.array([1.0, 0.0 if frame == 4 else 0.5, 0.9]))
    writer.close()
    assert writer.count == count
    return path.read_bytes()


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    content = written(tmp_path / "new" / "03_perform.frames")
    assert len(content) == 20 * SIZE
    tracks = read_frames(tmp_path / "new" / "03_perform.frames", NAMES)
    rng = np.random.default_rng(1)
    expected = np.array([rng.normal(size=(3, 3)) for _ in range(20)])
    expected[4, 1] = np.nan
    np.testing.assert_allclose(tracks.positions, expected, atol=1e-6)
    np.testing.assert_array_equal(tracks.times_s, np.arange(20) / 30)
    np.testing.assert_allclose(tracks.confidence[4], [1.0, 0.0, 0.9], atol=1 / 510)


def test_a_frame_cut_off_at_the_end_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "a.frames"
    content = written(path)
    for cut in [*range(17 * SIZE, len(content)), 0, 1, SIZE - 1]:
        path.write_bytes(content[:cut])
        assert len(read_frames(path, NAMES)) == cut // SIZE


def test_blank_space_at_the_end_after_a_power_cut_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "a.frames"
    path.write_bytes(written(path) + b"\0" * (3 * SIZE))
    assert len(read_frames(path, NAMES)) == 20


def test_a_damaged_frame_before_the_end_is_refused_and_named(tmp_path: Path) -> None:
    path = tmp_path / "a.frames"
    content = bytearray(written(path))
    content[6 * SIZE + 11] ^= 1
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.frames, frame 7: .*checksum"):
        read_frames(path, NAMES)


def test_frames_that_arrive_late_are_left_out(tmp_path: Path) -> None:
    writer = FrameWriter(tmp_path / "a.frames", NAMES)
    for time_s in (0.0, 0.2, 0.1, 0.2, 0.3):
        writer.append(time_s, np.zeros((3, 3)), np.ones(3))
    writer.close()
    assert read_frames(tmp_path / "a.frames", NAMES).times_s.tolist() == [0.0, 0.2, 0.3]


def test_a_file_of_frames_is_never_replaced(tmp_path: Path) -> None:
    content = written(tmp_path / "a.frames")
    with pytest.raises(InputError, match="cannot be written"):
        FrameWriter(tmp_path / "a.frames", NAMES)
    assert (tmp_path / "a.frames").read_bytes() == content
