"""Results stand on disk with their origin, and say what changed since others were written."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from studykit.cli import main
from studykit.core.errors import InputError
from studykit.reports.analyse import analyse, read_results


@pytest.fixture
def study(recorded_study: Callable[[], Path]) -> Path:
    return recorded_study()


def written(study: Path) -> Path:
    return study / "derivatives" / "studykit" / "results.json"


def files(study: Path) -> dict[str, bytes]:
    """Give everything that was written."""
    return {path.name: path.read_bytes() for path in written(study).parent.iterdir() if path.is_file()}


def test_results_hold_what_was_declared_and_are_the_same_on_any_number_of_processes(
    recorded_study: Callable[[], Path],
) -> None:
    alone, together = recorded_study(), recorded_study()
    analyse(alone, workers=1)
    results = read_results(written(alone))
    assert {"tests", "correlations", "models", "equivalences", "curves", "order_effects"} <= results.keys()
    assert {row["choice"] for row in results["sensitivity"]} > {"as declared"}
    assert all({"kind", "where", "words"} == set(warning) for warning in results["warnings"])
    assert sorted(results["provenance"]["visits"]) == ["sub-01_ses-01", "sub-02_ses-01", "sub-03_ses-01"]
    analyse(together, workers=2)
    assert files(together) == files(alone)


def test_a_command_says_what_changed_and_why(
    study: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def command(*words: str) -> str:
        with pytest.raises(SystemExit, match="0"):
            main(["analyse", str(study), "--workers", "1", *words])
        return capsys.readouterr().out

    command()
    old = tmp_path / "old.json"
    old.write_bytes(written(study).read_bytes())
    assert f"Against {old}: every result is as before" in command("--against", str(old))
    (study / "sourcedata" / "journal" / "sub-03_ses-01.jsonl").unlink()
    shutil.rmtree(study / "sub-03")
    said = command("--against", str(old))
    assert "visits" in said
    assert "sub-03_ses-01" in said
    assert "participants: 3 -> 2" in said
    found = json.loads(command("--against", str(old), "--json"))["against"]
    assert {"where": "participants", "old": 3, "new": 2} in found["changes"]


@pytest.mark.parametrize(
    ("content", "problem"),
    [("{", "cannot be read as results"), ("[]", "holds no results"), ('{"a": 1}', "holds no results")],
)
def test_what_is_no_result_is_refused(tmp_path: Path, content: str, problem: str) -> None:
    path = tmp_path / "results.json"
    path.write_text(content)
    with pytest.raises(InputError, match=problem):
        read_results(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_results(tmp_path / "none.json")
