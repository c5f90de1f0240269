"""Every notebook runs from a fresh kernel, and is committed without its outputs."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MADE = {
    "00_tour": "sessions/tour/derivatives/studykit/report.html",
    "04_analyse_a_study": "sessions/tour/derivatives/studykit/results.json",
    "05_paper_figures": "sessions/tour/derivatives/studykit/tables/participants.tex",
}
"""What each notebook about a whole study leaves at its end; test_other_notebooks.py has the others."""
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("name", MADE)
def test_a_notebook_runs_on_simulated_data(name: str, place: Path, pictures_of: Callable[[str], int]) -> None:
    made = place / MADE[name]
    made.unlink(missing_ok=True)  # what was recorded for one notebook serves the next
    assert pictures_of(name) >= 4
    assert made.exists()


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
