from __future__ import annotations

import errno
import random
from io import FileIO
from pathlib import Path

import pytest

from studykit.core.errors import InputError
from studykit.recording.journal import Journal, read_journal


def written(path: Path, count: int = 12) -> bytes:
    with Journal.create(path) as journal:
        for number in range(count):
            journal.append(
                "heart_rate",
                {"heart_rate_bpm": 60 + number, "note": "é\n"},
                time_s=number / 3,
                durable=number % 2 == 0,
            )
    return path.read_bytes()


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "new" / "sub-01_ses-01.jsonl"
    written(path)
    records = read_journal(path)
    assert [record.number for record in records] == list(range(1, 13))
    assert records[3].data == {"heart_rate_bpm": 63, "note": "é\n"}
    assert records[3].time_s == 1.0
    assert len({record.sha256 for record in records}) == 12


def test_a_torn_tail_is_left_out_wherever_it_is_torn(tmp_path: Path) -> None:
    path = tmp_path / "sub-01_ses-01.jsonl"
    content = written(path)
    whole = read_journal(path)
    ends = [at + 1 for at, byte in enumerate(content) if byte == ord("\n")]
    cuts = set(range(ends[-4], len(content))) | set(random.Random(1).sample(range(len(content)), 100))
    for cut in cuts:
        path.write_bytes(content[:cut])
        count = sum(end <= cut for end in ends)
        assert read_journal(path) == whole[:count], cut


def test_a_changed_line_is_refused_and_named(tmp_path: Path) -> None:
    path = tmp_path / "sub-01_ses-01.jsonl"
    content = written(path)
    for line, altered in (
        (5, content.replace(b'"heart_rate_bpm":64', b'"heart_rate_bpm":65')),
        (3, b"".join(content.splitlines(keepends=True)[:2] + content.splitlines(keepends=True)[3:])),
        (7, content.replace(b'{"number":7', b"garbage", 1)),
        (12, content[:-4] + b'x"}\n'),
        (1, b"\n" + content),
    ):
        path.write_bytes(altered)
        with pytest.raises(InputError, match=rf"sub-01_ses-01.jsonl, line {line}: .*checksum") as caught:
            read_journal(path)
        assert str(caught.value).endswith(".")
        with pytest.raises(InputError):
            Journal.reopen(path)
        assert path.read_bytes() == altered


def test_every_changed_byte_is_noticed(tmp_path: Path) -> None:
    path = tmp_path / "sub-01_ses-01.jsonl"
    content = written(path, 3)
    whole = read_journal(path)
    for at in range(len(content)):
        path.write_bytes(content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :])
        try:
            assert read_journal(path) == whole[:2]  # only the last line's end can be mistaken for half a line
            assert at == len(content) - 1
        except InputError:
            pass


def test_going_on_after_half_a_line_keeps_the_half_line_aside(tmp_path: Path) -> None:
    path = tmp_path / "sub-01_ses-01.jsonl"
    content = written(path)
    path.write_bytes(content[:-5])
    with Journal.reopen(path) as journal:
        journal.append("session_resumed", {}, time_s=99.0)
    records = read_journal(path)
    assert [record.kind for record in records[-2:]] == ["heart_rate", "session_resumed"]
    assert records[-1].number == 12
    (aside,) = (tmp_path / "sub-01_ses-01").iterdir()
    last = content.rindex(b"\n", 0, -1) + 1
    assert aside.read_bytes() == content[last:-5]
    assert path.read_bytes().startswith(content[:last])


def test_going_on_without_damage_adds_to_the_end(tmp_path: Path) -> None:
    path = tmp_path / "sub-01_ses-01.jsonl"
    content = written(path)
    with Journal.reopen(path) as journal:
        journal.append("session_resumed", {}, time_s=99.0)
        journal.close()
    assert path.read_bytes().startswith(content)
    assert len(read_journal(path)) == 13
    assert not (tmp_path / "sub-01_ses-01").exists()


def test_a_second_journal_of_the_same_name_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "sub-01_ses-01.jsonl"
    content = written(path)
    with pytest.raises(InputError, match="already been recorded"):
        Journal.create(path)
    assert path.read_bytes() == content


def test_a_folder_that_is_a_file_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "pilot").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        Journal.create(tmp_path / "pilot" / "sub-01_ses-01.jsonl")


def test_a_second_writer_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.jsonl"
    with Journal.create(path), pytest.raises(InputError, match="at this moment"):
        Journal.reopen(path)
    with Journal.reopen(path) as journal:
        journal.append("session_resumed", {}, time_s=0.0)


def test_after_a_failed_write_nothing_more_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def half_a_line(file: FileIO, data: bytes) -> None:
        file.write(data[:20])
        raise OSError(errno.ENOSPC, "No space left on device")

    path = tmp_path / "a.jsonl"
    with Journal.create(path) as journal:
        journal.append("session_started", {}, time_s=0.0)
        with monkeypatch.context() as patch:
            patch.setattr("studykit.recording.journal.write_all", half_a_line)
            with pytest.raises(InputError, match="no space left on device"):
                journal.append("answers", {}, time_s=1.0)
        with pytest.raises(InputError, match="no space left on device"):
            journal.append("step_interrupted", {}, time_s=1.0)
    assert [record.kind for record in read_journal(path)] == ["session_started"]


def test_a_missing_journal_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_journal(tmp_path / "sub-01_ses-01.jsonl")


def test_numbers_that_json_cannot_hold_are_refused(tmp_path: Path) -> None:
    with Journal.create(tmp_path / "a.jsonl") as journal, pytest.raises(ValueError, match="JSON"):
        journal.append("heart_rate", {"heart_rate_bpm": float("nan")}, time_s=0.0)
    assert read_journal(tmp_path / "a.jsonl") == ()
