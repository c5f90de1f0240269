"""Studies that were recorded elsewhere: valid Motion-BIDS, and no journal of ours."""

from __future__ import annotations

import gzip
import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from shutil import rmtree

import numpy as np
import pandas as pd
import pytest

from studykit.analysis.heart_rate import mean_bpm
from studykit.analysis.tables import TRIALS
from studykit.cli import main
from studykit.core.errors import InputError
from studykit.recording.bids_metadata import HEART_RATE_HZ
from studykit.recording.joint_channels import joint_named
from studykit.recording.session_record import read_session
from studykit.recording.study_folder import StudyFolder
from studykit.reports.analyse import analyse
from studykit.reports.checks import problems
from studykit.reports.trials import paces, trials

VALIDATOR = Path(sys.executable).with_name("bids-validator-deno")
MEASURED = ("dtw_m", "dtw_lag_s", "linear_energy_danced", "rotational_energy_danced")
KNOWN = ("linear_energy_asked", "rotational_energy_asked", "variety_achieved", "smoothness_rating")
# BIDS stores positions to a tenth of a millimetre and times to a tenth of a millisecond.
USUAL, LARGEST = 1e-3, 1e-2


@pytest.fixture(scope="module")
def measured(_recorded: Path) -> pd.DataFrame:
    """The trials as the journals tell them."""
    return trials(_recorded)


@pytest.fixture
def without_journal(recorded_study: Callable[[], Path]) -> StudyFolder:
    folder = StudyFolder(recorded_study())
    rmtree(folder.journals)
    return folder


def assert_the_same(table: pd.DataFrame, told: pd.DataFrame) -> None:
    """Equal but for what BIDS does not store: digests, and the heart between full seconds."""
    words = [c.name for c in TRIALS.columns if c.kind != "number" and c.name != "data_sha256"]
    pd.testing.assert_frame_equal(table[[*words, *KNOWN]], told[[*words, *KNOWN]])
    for name in MEASURED:
        apart = (table[name] - told[name]).abs()
        assert apart.max() <= LARGEST * told[name].abs().max(), name
        assert apart.median() <= USUAL * told[name].abs().median(), name


def test_without_its_journal_a_study_gives_the_same_trials(
    without_journal: StudyFolder, recorded_study: Callable[[], Path], measured: pd.DataFrame
) -> None:
    original = recorded_study()
    table = trials(without_journal)
    assert_the_same(table, measured)
    assert table["data_sha256"].is_unique
    pd.testing.assert_frame_equal(paces(without_journal), paces(original))
    assert problems(without_journal, table=table) == []
    for path, twin in zip(StudyFolder(original).sessions(), without_journal.sessions(), strict=True):
        record, other = read_session(path), read_session(twin)
        assert other.conditions == record.conditions
        assert [step.step for step in other.steps] == [step.step for step in record.steps]
        assert set(other.frame_files) == set(record.frame_files)
        for step in record.steps:
            if step.phase != "perform":
                continue
            own, got = (
                mean_bpm(one.heart_rate_times_s, one.heart_rate_bpm, step.start_s, step.stop_s, 10.0)
                for one in (record, other)
            )
            # These dances last few seconds, so that one step of the grid moves the mean by this much at most.
            assert abs(got - own) <= 0.5


def test_a_file_that_does_not_match_its_digest_is_named(without_journal: StudyFolder) -> None:
    path = min(without_journal.path.glob("sub-02/ses-01/motion/*dance*_motion.tsv"))
    path.write_text(path.read_text().replace("0.1", "0.2", 1))
    table = trials(without_journal)
    named = problems(without_journal, table=table)
    assert {problem.kind for problem in named} == {"changed file"}
    name = path.relative_to(without_journal.path).as_posix()
    assert any(problem.where == name for problem in named)
    assert table["dtw_m"].isna().sum() == 1


KINECT = {"pelvis": "SpineBase", "spine2": "SpineMid", "spine3": "SpineShoulder", "collar": "Clavicle"}


def kinect_name(joint: str) -> str:
    side, _, place = joint.rpartition("_")
    return KINECT.get(place, place.capitalize()) + side.capitalize()


def make_foreign(folder: StudyFolder) -> Path:
    """Lay a study out as another laboratory might; give the trial that has no heart rate.

    One visit a person and no session in the names; x front, y left, z up in mm; Kinect's joint names, their
    columns in another order, with a column that is no position; no course of the session, but the times of
    recording; events and channels shared by inheritance; heart rate at 2 Hz beside each trial.
    """
    silent = Path()
    for subject in sorted(folder.path.glob("sub-*")):
        old, new = subject / "ses-01" / "motion", subject / "motion"
        pulse = np.loadtxt(
            gzip.decompress(next(old.glob("*physio.tsv.gz")).read_bytes())
            .decode()
            .replace("n/a", "nan")
            .split()
        )[:: int(HEART_RATE_HZ)]
        course = pd.read_csv(next(old.glob("*task-session_events.tsv")), sep="\t")
        new.mkdir()
        scans = []
        for path in sorted(old.glob("*task-dance*_motion.tsv")):
            stem = path.name.replace("_ses-01", "").replace("_tracksys-camera", "_tracksys-kinect")
            motion = np.genfromtxt(path.read_text().replace("n/a", "nan").splitlines(), delimiter="\t")
            xyz = 1000.0 * motion[:, 1:].reshape(len(motion), -1, 3)[..., [2, 0, 1]]
            columns = np.hstack([xyz[:, ::-1].reshape(len(motion), -1), motion[:, :1] * 0 + 7, motion[:, :1]])
            text = "\n".join(
                "\t".join(f"{value:.2f}" for value in row[:-1]) + f"\t{row[-1]:.4f}" for row in columns
            )
            (new / stem).write_text(text.replace("nan", "n/a") + "\n")
            (new / stem).with_suffix(".json").write_text(path.with_suffix(".json").read_text())
            events = pd.read_csv(str(path).replace("_motion.tsv", "_events.tsv"), sep="\t")
            start_s = course.set_index("step").loc[events["step"][0], "onset"] - events["onset"][0]
            events["condition"] = events["condition"].str.replace("-", "_").str.upper()
            own = stem.replace("_tracksys-kinect", "").replace("_motion.tsv", "")
            events[["onset", "duration", "trial_type", "condition"]].to_csv(
                new / f"{own}_events.tsv", sep="\t", index=False
            )
            moment = pd.Timestamp("2024-05-01T09:00:00") + pd.Timedelta(seconds=start_s)
            scans.append((f"motion/{stem}", moment.strftime("%Y-%m-%dT%H:%M:%S.%f")))
            if not silent.name:
                silent = path
                continue
            start_s = float(start_s)
            first = int(start_s)
            physio = new / f"{own}_recording-belt_physio.tsv.gz"
            rows = [f"{k}\t{value:g}" for k, value in enumerate(np.repeat(pulse[first : first + 6], 2))]
            physio.write_bytes(gzip.compress("\n".join(rows).replace("nan", "n/a").encode()))
            about = {"SamplingFrequency": 2.0, "StartTime": first - start_s, "Columns": ["count", "HR"]}
            physio.with_suffix("").with_suffix(".json").write_text(json.dumps(about))
        names = next(old.glob("*dance*channels.tsv"))
        joints = pd.read_csv(names, sep="\t")["tracked_point"].dropna().drop_duplicates()[::-1]
        lines = ["name\tcomponent\ttype\ttracked_point\tunits\treference_frame"]
        lines += [f"{kinect_name(j)}{a}\t{a}\tPOS\t{kinect_name(j)}\tmm\troom" for j in joints for a in "xyz"]
        lines += ["state\tn/a\tMISC\tn/a\tn/a\tn/a", "time\tn/a\tLATENCY\tn/a\ts\tn/a"]
        (new / f"{subject.name}_task-dance_tracksys-kinect_channels.tsv").write_text("\n".join(lines) + "\n")
        table = pd.DataFrame(scans, columns=["filename", "acq_time"])
        table.to_csv(subject / f"{subject.name}_scans.tsv", sep="\t", index=False)
        rmtree(subject / "ses-01")
    frames = {"room": {"SpatialAxes": "ALS", "RotationRule": "right-hand", "Description": "the room"}}
    (folder.path / "task-dance_tracksys-kinect_channels.json").write_text(
        json.dumps({"reference_frame": {"Levels": frames}})
    )
    for name in ("paces", "smoothness", "demographics"):
        path = folder.phenotype / f"{name}.tsv"
        pd.read_csv(path, sep="\t").drop(columns="session_id").to_csv(
            path, sep="\t", index=False, na_rep="n/a"
        )
    people = folder.path / "participants.tsv"
    pd.read_csv(people, sep="\t", dtype=str).drop(columns="sequence").to_csv(
        people, sep="\t", index=False, na_rep="n/a"
    )
    return silent


def test_the_layout_of_another_laboratory_gives_the_same_trials(
    without_journal: StudyFolder, measured: pd.DataFrame
) -> None:
    silent = make_foreign(without_journal)
    table = trials(without_journal)
    assert_the_same(table, measured)
    condition = re.search(r"acq-(\w+?)_", silent.name)
    assert condition
    without = table[table["heart_rate_mean_bpm"].isna()]
    assert without["participant"].tolist() == ["01"]
    assert without["condition"].str.replace("-", "").tolist() == [condition[1]]
    named = problems(without_journal, table=table)
    assert [problem.kind for problem in named] == ["no heart rate"]
    results = analyse(without_journal)
    assert results.test("movement").participants == 3
    assert results.test("heart_rate").exclusions.without_value <= 1


def test_the_official_validator_finds_the_foreign_layout_valid_too(without_journal: StudyFolder) -> None:
    if not VALIDATOR.exists():
        pytest.skip("bids-validator-deno is not installed")
    make_foreign(without_journal)
    done = subprocess.run(
        [str(VALIDATOR), str(without_journal.path), "--json"], capture_output=True, text=True, check=False
    )
    issues = json.loads(done.stdout)["issues"]["issues"]
    assert [issue for issue in issues if issue["severity"] == "error"] == []


@pytest.mark.parametrize(
    ("name", "old", "new", "said"),
    [
        ("_channels.tsv", "\tm\t", "\tinch\t", 'channels.tsv, line 3: "units" is "inch"; use one of'),
        ("_channels.tsv", "_hip\tm", "_bottom\tm", "no tracked_point is known as left_hip, right_hip; name"),
        ("_channels.json", "LSA", "n/a", "SpatialAxes"),
        ("_events.tsv", "perform", "dancing", 'no trial_type is "perform"'),
        (
            "-session_events.tsv",
            "light-easy-on",
            "light-easy-om",
            'is "light-easy-om"; write "light-easy-on"',
        ),
        ("-session_events.tsv", "\tcondition", "\twhat", 'the column "condition" is missing'),
        (
            "_physio.json",
            f'"SamplingFrequency": {HEART_RATE_HZ}',
            '"SamplingFrequency": null',
            "SamplingFrequency",
        ),
        ("participants.tsv", "\t", " ", "cells stand below"),
    ],
)
def test_what_is_missing_is_named(
    without_journal: StudyFolder, name: str, old: str, new: str, said: str
) -> None:
    for path in without_journal.path.rglob(f"*{name}"):
        path.write_text(path.read_text().replace(old, new, 20 if name == "participants.tsv" else -1))
    if name == "participants.tsv":
        path = without_journal.path / name
        path.write_text("participant_id\tage\nsub-01\n")
    with pytest.raises(InputError, match=re.escape(said)):
        trials(without_journal)


def test_a_study_can_bring_its_own_names_of_joints(
    without_journal: StudyFolder, measured: pd.DataFrame
) -> None:
    for path in without_journal.path.rglob("*_channels.tsv"):
        path.write_text(path.read_text().replace("_hip\tm", "_bottom\tm"))
    (without_journal.path / "code" / "joints.toml").write_text(
        'left_bottom = "left_hip"\nright_bottom = "right_hip"\n'
    )
    assert_the_same(trials(without_journal), measured)


def test_verdicts_and_repeated_trials_are_carried_along(
    without_journal: StudyFolder,
) -> None:
    motion = min(without_journal.path.glob("sub-03/ses-01/motion/*acq-lighteasyon*_motion.tsv"))
    for path in list(motion.parent.glob("*acq-lighteasyon*run-1*")):  # danced once more, an hour later
        again = path.with_name(path.name.replace("run-1", "run-2"))
        again.write_bytes(path.read_bytes())
    (course,) = motion.parent.glob("*task-session_events.tsv")
    events = pd.read_csv(course, sep="\t", dtype=str, keep_default_na=False)
    first = events[(events["trial_type"] == "perform") & (events["condition"] == "light-easy-on")]
    events = pd.concat([events, first.assign(onset=str(float(first["onset"].iloc[0]) + 3600.0), step="99")])
    events.to_csv(course, sep="\t", index=False)
    for path in motion.parent.glob("*acq-lighteasyon*run-2_events.tsv"):
        path.write_text(re.sub(r"\t\d+\t(true)$", r"\t99\t\1", path.read_text(), flags=re.MULTILINE))
    (scans,) = motion.parent.parent.glob("*_scans.tsv")
    text = scans.read_text()
    line = next(line for line in text.splitlines() if "acq-lighthardon" in line)
    scans.write_text(text.replace(line, line.replace("true\tn/a", "false\tthe belt fell off")))
    own = trials(without_journal).query("participant == '03'")
    assert len(own) == 9
    why = own.set_index("condition")["exclusion_reason"].dropna()
    assert why.to_dict() == {"light-easy-on": "danced again", "light-hard-on": "the belt fell off"}
    pair = own[own["condition"] == "light-easy-on"]
    assert np.ptp(pair["dtw_m"]) < 1e-5
    assert pair["dtw_m"].notna().all()
    assert pair["period"].nunique() == 1


def test_an_order_that_is_not_the_one_told_is_named(
    without_journal: StudyFolder, measured: pd.DataFrame
) -> None:
    people = without_journal.path / "participants.tsv"
    table = pd.read_csv(people, sep="\t", dtype=str, keep_default_na=False)
    danced = int(table.loc[1, "sequence"])
    table.loc[1, "sequence"] = str(danced % 8 + 1)
    table.to_csv(people, sep="\t", index=False)
    found = trials(without_journal)
    assert found["previous_condition"].equals(measured["previous_condition"])
    named = problems(without_journal, table=found)
    assert [problem.kind for problem in named] == ["other order"]
    assert "Participant 02" in named[0].words


def test_a_protocol_beside_the_folder_is_kept_in_it(without_journal: StudyFolder, tmp_path: Path) -> None:
    followed = tmp_path / "followed.toml"
    without_journal.protocol.rename(followed)
    make_foreign(without_journal)
    with pytest.raises(SystemExit) as end:
        main(["analyse", str(without_journal.path), "--protocol", str(followed)])
    assert end.value.code == 0
    assert without_journal.protocol.read_bytes() == followed.read_bytes()
    assert (without_journal.derivatives / "trials.csv").exists()


def test_without_protocol_or_dances_it_is_told_what_is_missing(without_journal: StudyFolder) -> None:
    rmtree(without_journal.dances)
    with pytest.raises(InputError, match="put back the dances that were shown"):
        trials(without_journal)
    without_journal.protocol.unlink()
    with pytest.raises(InputError, match="the protocol that was followed is not there"):
        trials(without_journal)


@pytest.mark.parametrize(
    ("name", "joint"),
    [
        ("left_elbow", "left_elbow"),
        ("ELBOW_LEFT", "left_elbow"),
        ("ElbowLeft", "left_elbow"),
        ("LElbow", "left_elbow"),
        ("Right Clavicle", "right_collar"),
        ("Spine1", "spine1"),
        ("SpineShoulder", "spine3"),
        ("Hips", "pelvis"),
        ("left_leg", None),  # a leg begins at the hip or at the knee
        ("left_right_hip", None),
        ("nose", None),
    ],
)
def test_joints_are_known_by_their_usual_names(name: str, joint: str | None) -> None:
    assert joint_named(name) == joint
