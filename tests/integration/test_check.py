"""The command that checks printed numbers: what it says, and how it ends."""

from __future__ import annotations

import io
import json
from pathlib import Path

import pytest

from studykit.cli import main


def ended(*arguments: str) -> int:
    with pytest.raises(SystemExit) as end:
        main(["check", *arguments])
    return int(str(end.value.code))


def test_the_exit_code_tells_whether_all_can_be_true(capsys: pytest.CaptureFixture[str]) -> None:
    assert ended("chi2(3)=30.00, W=0.50, n=20") == 0
    assert "0 of 2 checks fail." in capsys.readouterr().out
    assert ended("chi2(3)=30.00, W=0.60, n=20") == 1
    said = capsys.readouterr().out
    assert "WRONG  W against chi2: W = chi2 / (n (k - 1)) = 0.500, not 0.60" in said
    assert ended("chi2 is large") == 2
    assert "cannot be read; write numbers as in" in capsys.readouterr().err


def test_a_file_and_a_pipe_are_read_and_a_machine_is_served(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "claims.txt"
    file.write_text("# of a paper\nage: 12+9=20\nt(28)=2.20, p=.036\n", encoding="utf-8")
    assert ended(str(file), "--json") == 1
    findings = json.loads(capsys.readouterr().out)
    assert [(finding["kind"], finding["is_consistent"]) for finding in findings] == [
        ("sum", False),
        ("p against t", True),
    ]
    assert findings[1]["recomputed"][0] == pytest.approx(0.0359, abs=0.001)
    monkeypatch.setattr("sys.stdin", io.StringIO("z=1.96, p=.05"))
    assert ended("-") == 0
    file.write_bytes(b"\xff\xfe")
    assert ended(str(file)) == 2


def test_the_paper_is_the_worked_example(capsys: pytest.CaptureFixture[str]) -> None:
    assert ended("--example") == 1
    assert "4 of 18 checks fail." in capsys.readouterr().out
    assert ended() == 2
    assert "give numbers" in capsys.readouterr().err
