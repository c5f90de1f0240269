"""The notebooks that need no whole study; in a file of their own, so that both run at the same time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MADE = {
    "02_design_dances": "sessions/designed/careful.glb",
    "03_build_library": "libraries/notebook/library.html",
    "06_pilot_and_power": "sessions/power.csv",
}
"""What each notebook leaves at its end."""
OF_STUDIES = {"00_tour", "04_analyse_a_study", "05_paper_figures"}
"""Run in test_notebooks.py."""
OTHERS = sorted({path.stem for path in (ROOT / "notebooks").glob("*.ipynb")} - OF_STUDIES)


@pytest.mark.parametrize("name", OTHERS)
def test_a_notebook_runs_on_simulated_data(name: str, place: Path, pictures_of: Callable[[str], int]) -> None:
    assert pictures_of(name) >= 4
    assert (place / MADE[name]).exists()
