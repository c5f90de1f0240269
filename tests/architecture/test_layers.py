"""Imports go down the layers (import-linter, contracts in pyproject.toml)."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def lint_imports(root: Path) -> subprocess.CompletedProcess[str]:
    """Check the contracts of the studykit that lies in a folder."""
    return subprocess.run(
        [
            sys.executable,
            "-c",
            "from importlinter.cli import lint_imports_command as run; run()",
            "--no-cache",
        ],
        cwd=root,
        capture_output=True,
        text=True,
        check=False,
        env=dict(os.environ) | {"PYTHONPATH": str(root)},
    )


def test_every_contract_is_kept() -> None:
    done = lint_imports(ROOT)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "0 broken" in done.stdout


@pytest.fixture
def empty_house(tmp_path: Path) -> Path:
    """The same rooms and contracts with nothing in them."""
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    layers = next(contract["layers"] for contract in contracts if contract["type"] == "layers")
    for room in re.findall(r"\w+", " ".join(layers)):
        (tmp_path / "studykit" / room).mkdir(parents=True)
        (tmp_path / "studykit" / room / "__init__.py").touch()
    (tmp_path / "studykit" / "__init__.py").touch()
    return tmp_path


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("core/wrong.py", "import studykit.motion"),
        ("analysis/wrong.py", "import studykit.choreography"),
        ("protocol/wrong.py", "import matplotlib.pyplot"),
        ("motion/wrong.py", "import asyncio"),
        ("devices/wrong.py", "import bleak"),
        ("helpers/__init__.py", ""),
    ],
)
def test_a_wrong_import_would_be_noticed(empty_house: Path, module: str, line: str) -> None:
    wrong = empty_house / "studykit" / module
    wrong.parent.mkdir(exist_ok=True)
    wrong.write_text(line)
    done = lint_imports(empty_house)
    assert done.returncode == 1
    assert "1 broken" in done.stdout


def test_the_empty_house_is_in_order(empty_house: Path) -> None:
    assert lint_imports(empty_house).returncode == 0
