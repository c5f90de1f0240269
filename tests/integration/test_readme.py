"""What the README tells people to type in Jupyter runs as it stands."""

from __future__ import annotations

import ast
import asyncio
import inspect
import re
import shutil
from pathlib import Path
from typing import Any

import pytest

from studykit.library import make_sample

ROOT = Path(__file__).resolve().parents[2]


def test_the_python_of_the_readme_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    designing, code = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    shutil.copytree(ROOT / "protocols", tmp_path / "protocols")
    make_sample(tmp_path / "libraries" / "synthetic")
    monkeypatch.chdir(tmp_path)

    monkeypatch.syspath_prepend(ROOT)
    designed: dict[str, Any] = {}
    exec(designing, designed)
    assert designed["dance"].condition == "intense-hard-on"
    assert designed["dance"].cost_terms["legs"] < 0.2

    names: dict[str, Any] = {}
    compiled = compile(code, "README.md", "exec", flags=ast.PyCF_ALLOW_TOP_LEVEL_AWAIT)
    running = eval(compiled, names)
    assert inspect.iscoroutine(running)
    asyncio.run(running)
    assert len(names["trials"]) == 8
    assert names["results"].participants == 1
    assert (tmp_path / "sessions/pilot/sourcedata/dances/light-easy-on.npz").exists()


def test_every_room_of_the_readme_is_there() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    house = text[text.index("## The house") :]
    rooms = set(re.findall(r"^  (\w+)/ ", house, flags=re.MULTILINE))
    there = {path.name for path in (ROOT / "studykit").iterdir() if (path / "__init__.py").exists()}
    assert rooms == there
