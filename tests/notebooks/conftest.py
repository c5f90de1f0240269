"""A place where notebooks run one after another, as a reader runs them: what one made, the next finds."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Notebooks and protocols, and nothing made yet."""
    made = tmp_path_factory.mktemp("place")
    for folder in ("notebooks", "protocols"):
        shutil.copytree(ROOT / folder, made / folder)
    return made


@pytest.fixture
def pictures_of(place: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], int]:
    """Run a notebook in that place, in a kernel of its own, and count the pictures that it shows."""
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    monkeypatch.setenv("JUPYTER_RUNTIME_DIR", str(tmp_path / "runtime"))

    def run(name: str) -> int:
        notebook = nbformat.read(place / "notebooks" / f"{name}.ipynb", as_version=4)
        resources = {"metadata": {"path": str(place / "notebooks")}}
        nbclient.NotebookClient(notebook, timeout=300, resources=resources).execute()
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        return sum("image/png" in output.get("data", {}) for output in outputs)

    return run
