"""Every notebook runs from a fresh kernel, and is committed without its outputs."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MADE = {
    "00_tour": "sessions/tour/derivatives/studykit/report.html",
    "02_design_dances": "sessions/designed/careful.glb",
    "03_build_library": "libraries/notebook/library.html",
    "04_analyse_a_study": "sessions/analysed/derivatives/studykit/results.json",
    "05_paper_figures": "sessions/paper/derivatives/studykit/tables/participants.tex",
    "06_pilot_and_power": "sessions/power.csv",
}
"""What each notebook leaves at its end."""
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_on_simulated_data(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    monkeypatch.setenv("JUPYTER_RUNTIME_DIR", str(tmp_path / "runtime"))
    for folder in ("notebooks", "protocols"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    notebook = nbformat.read(tmp_path / "notebooks" / path.name, as_version=4)
    nbclient.NotebookClient(
        notebook, timeout=300, resources={"metadata": {"path": str(tmp_path / "notebooks")}}
    ).execute()
    pictures = [
        output
        for cell in notebook.cells
        for output in cell.get("outputs", [])
        if "image/png" in output.get("data", {})
    ]
    assert len(pictures) >= 4
    assert (tmp_path / MADE[path.stem]).exists()


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_committed_without_outputs(path: Path) -> None:
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert len(code) >= 10
    assert not any(cell["outputs"] or cell["execution_count"] for cell in code)


@pytest.mark.slow
def test_papermill_runs_the_statisticians_notebook_over_a_study(
    recorded_study: Callable[[], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    papermill = pytest.importorskip("papermill")
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    monkeypatch.setenv("JUPYTER_RUNTIME_DIR", str(tmp_path / "runtime"))
    for _ in range(2):
        study = recorded_study()
        path = ROOT / "notebooks" / "04_analyse_a_study.ipynb"
        papermill.execute_notebook(
            path, study / "answers.ipynb", {"folder": str(study)}, progress_bar=False, cwd=tmp_path
        )
        assert (study / "derivatives" / "studykit" / "results.json").exists()
