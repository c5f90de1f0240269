"""How long a study takes from disk to answers; every command in a process of its own, as a user starts it."""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from studykit.choreography import choreograph
from studykit.io.protocol_file import default_protocol, read_protocol
from studykit.library import make_sample
from studykit.recording.study_folder import StudyFolder
from studykit.reports.measured import measured
from studykit.session import open_study

pytestmark = pytest.mark.benchmark


MANY, FEW = 80, 5


@pytest.fixture(scope="module")
def studies(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    """Give simulated studies of 5, 20 and 80 people who dance the same eight dances."""
    folder = tmp_path_factory.mktemp("studies")
    protocol = read_protocol(default_protocol()).with_participants(MANY)
    library = make_sample(folder / "library", segments=120)
    whole = open_study(folder / str(MANY), protocol=protocol)
    whole.simulate(choreograph(protocol, library, seed=1), seed=1, workers=2)
    return {MANY: whole.path} | {count: _first(whole.path, folder, count) for count in (FEW, 20)}


def _first(study: Path, folder: Path, count: int) -> Path:
    """Copy a study with the visits of its first people only."""
    others = [f"sub-{number:02d}*" for number in range(count + 1, MANY + 1)]
    return Path(shutil.copytree(study, folder / str(count), ignore=shutil.ignore_patterns(*others)))


@pytest.mark.parametrize("command", ["analyse", "report"])
def test_a_study_of_20_people_from_disk_to_its_answers(studies: dict[int, Path], command: str) -> None:
    study = studies[20]
    started = time.perf_counter()
    subprocess.run([sys.executable, "-m", "studykit", command, str(study)], check=True, capture_output=True)
    print(f"\nstudykit {command}, 20 people: {time.perf_counter() - started:.1f} s")
    assert (study / "derivatives" / "studykit" / "results.json").exists()


def test_a_person_costs_the_same_however_many_there_are(studies: dict[int, Path]) -> None:
    spent = {}
    for count in (FEW, MANY):
        measured(StudyFolder(studies[FEW]), workers=1)  # whatever is compiled or imported once
        folder = StudyFolder(Path(shutil.copytree(studies[count], studies[count].with_suffix(".again"))))
        started = time.process_time()
        assert len(measured(folder, workers=1)) == 8 * count
        spent[count] = time.process_time() - started
    ratio = spent[MANY] / spent[FEW]
    print(f"\n{FEW} people {spent[FEW]:.1f} s, {MANY} people {spent[MANY]:.1f} s: {ratio:.1f} times")
    assert ratio <= 1.2 * MANY / FEW
