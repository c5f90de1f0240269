from __future__ import annotations

import gzip
import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from studykit.analysis.heart_rate import mean_bpm
from studykit.core.errors import InputError
from studykit.protocol.study_protocol import StudyProtocol
from studykit.recording import bids_file, motion_bids
from studykit.recording.bids_metadata import HEART_RATE_HZ
from studykit.recording.motion_bids import heart_rate_grid
from studykit.session.study import Study, open_study


@pytest.fixture(scope="module")
def study(
    tmp_path_factory: pytest.TempPathFactory, small_protocol: StudyProtocol, small_dances: dict[str, Any]
) -> Study:
    study = open_study(tmp_path_factory.mktemp("bids") / "pilot", protocol=small_protocol)
    study.simulate(small_dances)
    return study


def read(path: Path) -> pd.DataFrame:
    return pd.read_csv(path, sep="\t", na_values="n/a", keep_default_na=False)


def derived(study: Study) -> dict[str, bytes]:
    hidden = ("sourcedata", "code", "derivatives")
    return {
        path.relative_to(study.path).as_posix(): path.read_bytes()
        for path in sorted(study.path.rglob("*"))
        if path.is_file() and path.relative_to(study.path).parts[0] not in hidden
    }


def test_everything_can_be_written_again_from_the_journals(study: Study) -> None:
    before = derived(study)
    for name in before:
        (study.path / name).unlink()
    study.write_bids()
    assert derived(study) == before
    study.write_bids()
    assert derived(study) == before


def test_motion_holds_the_recorded_positions_to_a_tenth_of_a_millimetre(study: Study) -> None:
    record = study.sessions()[0]
    step = next(step for step in record.steps if step.phase == "perform")
    tracks = record.frames(step.step)
    stem = f"sub-01_ses-01_task-dance_tracksys-camera_acq-{(step.condition or '').replace('-', '')}_run-1"
    folder = study.folder.motion("01", "01")
    values = np.genfromtxt(folder / f"{stem}_motion.tsv", delimiter="\t", missing_values="n/a")
    channels = read(folder / f"{stem}_channels.tsv")
    about = json.loads((folder / f"{stem}_motion.json").read_text())
    assert list(channels.columns[:5]) == ["name", "component", "type", "tracked_point", "units"]
    assert values.shape == (len(tracks), len(channels)) == (len(tracks), 73)
    np.testing.assert_allclose(values[:, 0], tracks.times_s - tracks.times_s[0], atol=5.1e-5)
    np.testing.assert_allclose(values[:, 1:].reshape(-1, 24, 3), tracks.positions, atol=5.1e-5)
    assert channels["name"][1:4].tolist() == ["pelvis_x", "pelvis_y", "pelvis_z"]
    assert about["SamplingFrequency"] == 30
    assert about["SamplingFrequencyEffective"] == pytest.approx(30, rel=0.05)
    assert about["TaskName"] == "dance"
    assert about["TrackingSystemName"] == "camera"
    assert about["POSChannelCount"] == 72
    assert about["Simulated"] is True
    events = read(folder / f"{stem}_events.tsv")
    assert events["onset"][0] == pytest.approx(0.0, abs=0.05)
    assert events["duration"][0] == 4.0


def test_the_course_of_the_session_lists_every_phase(study: Study) -> None:
    events = read(study.folder.motion("01", "01") / "sub-01_ses-01_task-session_events.tsv")
    assert len(events) == 13
    assert events["trial_type"].tolist()[:5] == ["calibrate", "baseline", "train", "watch", "perform"]
    assert np.all(np.diff(events["onset"]) > 0)
    stops = (events["onset"] + events["duration"]).tolist()
    assert stops[:-1] == pytest.approx(events["onset"].tolist()[1:])
    assert set(events["is_complete"]) == {True}


def test_heart_rate_is_on_a_regular_grid_and_its_file_has_no_time_stamp(study: Study) -> None:
    record = study.sessions()[0]
    stem = study.folder.motion("01", "01") / "sub-01_ses-01_task-session_recording-heartrate_physio"
    packed = stem.with_suffix(".tsv.gz").read_bytes()
    about = json.loads(stem.with_suffix(".json").read_text())
    lines = gzip.decompress(packed).decode().splitlines()
    assert packed[4:8] == b"\0\0\0\0"
    assert about["SamplingFrequency"] == HEART_RATE_HZ
    assert about["StartTime"] == 0.0
    assert about["Columns"] == ["heart_rate"]
    assert len(lines) == int(record.steps[-1].stop_s * HEART_RATE_HZ) + 1
    assert lines[0] == "n/a"


def test_the_grid_takes_the_latest_reading_and_gives_up_after_a_gap() -> None:
    times, bpm = np.array([0.9, 1.8, 8.0, 9.0]), np.array([60.0, 61.0, 70.0, 0.0])
    grid = heart_rate_grid(times, bpm, stop_s=10.4, longest_gap_s=3.0)
    n = np.nan
    np.testing.assert_array_equal(grid[:: int(HEART_RATE_HZ)], [n, 60, 61, 61, 61, n, n, n, 70, n, n])
    nobody = heart_rate_grid(np.array([]), np.array([]), stop_s=2.0, longest_gap_s=3.0)
    assert np.isnan(nobody).all()


@pytest.mark.parametrize("late_s", [0.001, 0.3, 0.5, 0.999])
def test_the_grid_hardly_delays_a_heart_that_rises(late_s: float) -> None:
    times = np.arange(60) + late_s
    bpm = np.round(80.0 + 2.0 * times)
    grid = heart_rate_grid(times, bpm, stop_s=60.0, longest_gap_s=3.0)
    seconds = np.arange(len(grid)) / HEART_RATE_HZ
    known = np.isfinite(grid)
    own = mean_bpm(times, bpm, 10.0, 42.0, 3.0)
    assert abs(mean_bpm(seconds[known], grid[known], 10.0, 42.0, 3.0) - own) <= 2.0 / HEART_RATE_HZ


def test_everything_says_that_it_is_simulated(study: Study) -> None:
    description = json.loads((study.path / "dataset_description.json").read_text())
    assert description["Simulated"] is True
    assert "SIMULATED" in description["Name"]
    assert "SIMULATED DATA" in description["GeneratedBy"][0]["Description"]
    assert "SIMULATED DATA" in (study.path / "README").read_text()
    about = json.loads((study.path / "participants.json").read_text())
    assert "SIMULATED DATA" in about["participant_id"]["Description"]
    people = read(study.path / "participants.tsv")
    assert people["participant_id"].tolist() == ["sub-01", "sub-02"]
    assert people["simulated"].tolist() == [True, True]
    assert people["age"].between(18, 60).all()


def test_questionnaires_have_a_row_a_participant(study: Study) -> None:
    paces = read(study.path / "phenotype" / "paces.tsv")
    assert list(paces.columns) == ["participant_id", "session_id", *(f"item_{n:02d}" for n in range(1, 19))]
    assert len(paces) == 2
    smoothness = read(study.path / "phenotype" / "smoothness.tsv")
    assert list(smoothness.columns[2:]) == ["light_easy_on", "intense_easy_on"]
    record = study.sessions()[0]
    given = record.answers_to("smoothness", condition="intense-easy-on")
    assert given == {"rating": smoothness["intense_easy_on"][0]}
    for name in ("paces", "smoothness", "demographics"):
        table = read(study.path / "phenotype" / f"{name}.tsv")
        about = json.loads((study.path / "phenotype" / f"{name}.json").read_text())
        assert set(table.columns) == set(about) - {"MeasurementToolMetadata"}


def test_a_folder_that_cannot_be_written_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "README"
    bids_file.write(path, b"old")
    (tmp_path / f".README.{os.getpid()}.partial").mkdir()  # in the way of the new one
    with pytest.raises(InputError, match="cannot be written"):
        bids_file.write(path, b"new")
    assert path.read_bytes() == b"old"


def test_a_study_in_which_nobody_came_yet_can_be_described(
    tmp_path: Path, small_protocol: StudyProtocol
) -> None:
    study = open_study(tmp_path / "pilot", protocol=small_protocol)
    motion_bids.write(study.folder, study.protocol)
    description = json.loads((study.path / "dataset_description.json").read_text())
    assert description["Simulated"] is False
    assert len(read(study.path / "participants.tsv")) == 0
