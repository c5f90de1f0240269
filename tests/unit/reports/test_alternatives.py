"""Trials measured or counted otherwise differ in what was chosen, and in nothing else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from shutil import rmtree

import numpy as np
import pandas as pd
import pytest

from studykit.io.protocol_file import read_protocol
from studykit.recording.study_folder import StudyFolder
from studykit.reports.alternatives import alternatives, heart_choices, movement_choices
from studykit.reports.choices import Choices
from studykit.reports.trials import trials

HEART = (
    "heart_rate_mean_bpm",
    "heart_rate_peak_bpm",
    "vigorous_fraction",
    "heart_rate_resting_bpm",
    "heart_rate_recovery_bpm",
    "heart_rate_coverage",
    "rr_corrected_share",
    "vigorous_fraction_reserve",
)
DISTANCE = ("dtw_m", "dtw_lag_s", "dtw_lag_sd_s", "dtw_arms_m", "dtw_legs_m", "dtw_trunk_m")


@pytest.fixture
def study(recorded_study: Callable[[], Path]) -> Path:
    return recorded_study()


def test_each_choice_gives_what_measuring_everything_with_it_gives(study: Path) -> None:
    for path in StudyFolder(study).sessions()[1:]:  # one visit shows it
        path.unlink()
        rmtree(study / path.stem.partition("_")[0])
    table = trials(study)
    assert len(table) == 8
    declared = Choices.of(read_protocol(study / "code" / "protocol.toml"))
    found = alternatives(study, table)
    for choices, columns in ((heart_choices(declared), HEART), (movement_choices(declared), DISTANCE)):
        for words, one in choices.items():
            whole = trials(study, choices=one)
            pd.testing.assert_frame_equal(found[words][list(columns)], whole[list(columns)], rtol=1e-9)
            others = [name for name in table.columns if name not in columns]
            pd.testing.assert_frame_equal(found[words][others], table[others])


def test_no_choice_is_the_declared_one() -> None:
    declared = Choices(
        window="perform", maximum="tanaka", vigorous_fraction=0.7, longest_gap_s=10.0, band_s=1.0
    )
    for choices in (heart_choices, movement_choices):
        others = list(choices(declared).values())
        assert declared not in others
        assert len(set(others)) == len(others)
    other = replace(declared, window="perform+30", maximum="fox")
    assert [one.window for one in heart_choices(other).values()].count("perform") == 1
    assert declared.maximum in {one.maximum for one in heart_choices(other).values()}


def test_dances_made_anew_are_read_anew(study: Path) -> None:
    table = trials(study)
    words, *_ = movement_choices(Choices.of(read_protocol(study / "code" / "protocol.toml")))
    assert alternatives(study, table)[words]["dtw_m"].notna().all()
    dances = StudyFolder(study).dances
    (dances / "light-easy-on.npz").write_bytes((dances / "intense-easy-on.npz").read_bytes())
    again = trials(study)
    found = alternatives(study, again)[words]
    assert found["dtw_m"].isna().equals(again["dtw_m"].isna())
    assert found["dtw_m"].isna().sum() == 3


def test_other_trials_are_counted(study: Path) -> None:
    table = trials(study)
    table.loc[0, "skeleton_coverage"] = 0.5
    table.loc[1, ["is_valid", "exclusion_reason"]] = [False, "interrupted"]
    found = alternatives(study, table)
    seen = found["only trials seen for 90% of their time"]
    assert not seen["is_valid"][0]
    assert seen["exclusion_reason"][0] == "left out on trial"
    whole = found["only people who danced every condition"]
    first = table["participant"][1]
    assert not whole.loc[whole["participant"] == first, "is_valid"].any()
    assert whole.loc[whole["participant"] != first, "is_valid"].all()
    assert whole["exclusion_reason"][1] == "interrupted"


def test_the_first_repetition_can_count_instead_of_the_last(study: Path) -> None:
    table = trials(study)
    again = table.iloc[[0]].assign(repetition=2, dtw_m=0.5)
    table.loc[0, ["is_valid", "exclusion_reason"]] = [False, "danced again"]
    both = pd.concat([table, again], ignore_index=True)
    first = alternatives(study, both)["the first of several repetitions"]
    assert first["is_valid"][0]
    assert not first["is_valid"][len(table)]
    assert first["is_valid"].sum() == both["is_valid"].sum()
    assert np.array_equal(first["dtw_m"], both["dtw_m"], equal_nan=True)
