"""Who types is told why they wait; commands and scripts are told nothing."""

from __future__ import annotations

import sys

import pytest

from studykit.core.progress import notice


def test_only_who_types_is_told(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    notice("of a script")
    monkeypatch.setattr(sys, "ps1", "In : ", raising=False)
    notice("of a notebook")
    assert capsys.readouterr().out == "of a notebook\n"
