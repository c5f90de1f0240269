from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studykit.analysis.learning import learning
from studykit.analysis.tables import DANCED_AGAIN
from studykit.io.protocol_file import read_protocol
from studykit.library.dance_file import read_dances, write_dances
from studykit.protocol.study_protocol import StudyProtocol
from studykit.recording.study_folder import StudyFolder
from studykit.reports import measured as measuring
from studykit.reports.choices import Choices
from studykit.reports.curves import asked_energy, curves
from studykit.reports.trials import joint_energies, trials
from studykit.session import open_study


def test_there_is_a_curve_for_everybody_in_every_condition(recorded_study: Callable[[], Path]) -> None:
    study = recorded_study()
    protocol = read_protocol(StudyFolder(study).protocol)
    table = trials(study)
    for kind in ("heart_rate", "distance", "energy"):
        found = curves(study, kind)  # type: ignore[arg-type]
        assert tuple(found) == protocol.conditions_list()
        for one in found.values():
            assert one.participants == ("01", "02", "03")
            assert one.times_s.tolist() == (0.25 + 0.5 * np.arange(8)).tolist()
            assert one.values.shape == (3, 8)
            assert np.isfinite(one.values).all()
    energies = curves(study, "energy")
    for _, trial in table.iterrows():
        person = energies[trial["condition"]].participants.index(trial["participant"])
        over_time = energies[trial["condition"]].values[person].mean() * 119 / 30.0
        danced = trial["linear_energy_danced"] + trial["rotational_energy_danced"]
        assert over_time == pytest.approx(danced, rel=0.05)


def test_what_a_dance_asks_for_over_time_sums_to_what_it_asks_for(recorded_study: Callable[[], Path]) -> None:
    study = recorded_study()
    dances = read_dances(StudyFolder(study).dances)
    for name, (times_s, power) in asked_energy(study).items():
        shown = dances[name].achieved_blended
        assert len(times_s) == len(power) == 8
        assert power.mean() * 119 / 30.0 == pytest.approx(
            shown.linear_energy + shown.rotational_energy, rel=0.02
        )


def test_trials_that_do_not_count_have_no_curve(recorded_study: Callable[[], Path]) -> None:
    study = recorded_study()
    strict = replace(Choices.of(read_protocol(StudyFolder(study).protocol)), least_coverage=1.0)
    table = trials(study, choices=strict)
    assert not table["is_valid"].any()
    assert set(table["exclusion_reason"]) == {"heart rate or skeleton seen for too short a time"}
    found = curves(study, "distance", choices=strict)
    assert all(one.participants == () and one.values.shape == (0, 8) for one in found.values())
    assert len(found) == 8


def test_the_energy_of_the_joints_sums_to_that_of_the_trial(recorded_study: Callable[[], Path]) -> None:
    study = recorded_study()
    by_trial = joint_energies(study).groupby(["participant", "condition"]).sum(numeric_only=True)
    table = trials(study).set_index(["participant", "condition"])
    for column in ("linear_energy_danced", "rotational_energy_danced"):
        pd.testing.assert_series_equal(by_trial[column], table[column], check_like=True)
    for column in ("linear_energy_asked", "rotational_energy_asked"):
        pd.testing.assert_series_equal(by_trial[column], table[column], check_like=True, rtol=1e-6)


def test_a_study_is_measured_again_only_when_a_file_changed(
    recorded_study: Callable[[], Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    study = recorded_study()
    asked: list[str] = []
    measure = measuring.movement_measures
    monkeypatch.setattr(
        measuring, "movement_measures", lambda *a, **k: asked.append("once") or measure(*a, **k)
    )
    first = trials(study)
    assert len(asked) == len(first) == 24
    pd.testing.assert_frame_equal(trials(study), first)
    assert len(asked) == 24
    (StudyFolder(study).sessions()[0]).touch()
    pd.testing.assert_frame_equal(trials(study), first)
    assert len(asked) == 48


def test_who_dances_again_counts_once_and_the_repetitions_are_numbered(
    recorded_study: Callable[[], Path], tmp_path: Path
) -> None:
    recorded = StudyFolder(recorded_study())
    values = read_protocol(recorded.protocol).with_participants(1).model_dump(mode="json")
    values["session"]["perform_repetitions"] = 2
    dances = read_dances(recorded.dances)
    study = open_study(tmp_path / "again", protocol=StudyProtocol.model_validate(values))
    write_dances(dances, study.folder.dances)
    study.simulate(dances, seed=1)
    last = trials(study)
    assert learning(last) is None  # of one person nothing follows for people
    assert last["repetition"].tolist() == [1, 2] * 8
    assert last["is_valid"].tolist() == [False, True] * 8
    assert set(last["exclusion_reason"].dropna()) == {DANCED_AGAIN}
    assert last["dtw_m"].notna().all()
    first = trials(study, choices=replace(Choices.of(study.protocol), repetition="first"))
    assert first["is_valid"].tolist() == [True, False] * 8
    # Only after the very last dance is there a minute without another effort, in a study with rests of 2 s.
    assert last["heart_rate_recovery_bpm"].isna().tolist() == [True] * 15 + [False]
