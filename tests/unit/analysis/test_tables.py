from __future__ import annotations

import io

import pandas as pd
import pytest

from studykit.analysis.tables import PACES, TRIALS, check
from studykit.core.errors import InputError
from studykit.protocol.analysis_plan import OUTCOMES

HEADER = (
    "participant,session,sequence,period,condition,intensity,variety,transition,previous_condition,is_valid,"
    "exclusion_reason,heart_rate_mean_bpm,heart_rate_peak_bpm,vigorous_fraction,dtw_m,dtw_lag_s,"
    "linear_energy_asked,rotational_energy_asked,linear_energy_danced,rotational_energy_danced,"
    "variety_achieved,smoothness_rating,simulated,protocol_sha256,data_sha256,"
    "repetition,heart_rate_resting_bpm,heart_rate_recovery_bpm,heart_rate_coverage,rr_corrected_share,"
    "vigorous_fraction_reserve,dtw_arms_m,dtw_legs_m,dtw_trunk_m,dtw_lag_sd_s,smoothness_ldlj,"
    "range_of_motion_rad,skeleton_coverage,energy_noise_share,blinded"
)
ROWS = """
07,01,3,1,light-easy-on,light,easy,on,,True,,101.5,110,0.2,0.08,0.1,50,30,51,29,90.1,6,True,ab,cd,1,61.5,22,1,0,0.1,0.1,0.05,0.04,0.03,-11.2,1.1,0.99,0.1,participant
07,01,3,2,intense-hard-on,intense,hard,on,light-easy-on,False,interrupted,,,,,,150,90,,,140.0,,True,ab,cd,1,,,,,,,,,,,,,,
"""


def table() -> pd.DataFrame:
    return pd.read_csv(io.StringIO(HEADER + ROWS), dtype=TRIALS.dtypes)


def test_the_columns_of_trials_are_those_agreed_on() -> None:
    assert ",".join(TRIALS.column_names) == HEADER
    assert PACES.column_names == ("participant_id", *(f"item_{number:02d}" for number in range(1, 19)))


def test_everything_that_can_be_tested_is_a_measured_column() -> None:
    assert {TRIALS.column(name).kind for name in OUTCOMES} == {"number"}
    assert all(TRIALS.column(name).unit for name in OUTCOMES)


def test_a_table_read_with_its_types_passes() -> None:
    trials = table()
    assert check(trials, TRIALS) is trials
    assert trials["participant"].tolist() == ["07", "07"]
    assert check(pd.DataFrame(columns=list(TRIALS.column_names)).astype(TRIALS.dtypes), TRIALS).empty


@pytest.mark.parametrize(
    ("column", "value", "problem"),
    [
        ("condition", "light-easy", r'row 2: "condition" is none of light-easy-on, .* \(light-easy\)'),
        ("vigorous_fraction", 1.5, r'"vigorous_fraction" is above 1 \(1.5\)'),
        ("dtw_m", -0.1, r'"dtw_m" is below 0'),
        ("period", 0, r'"period" is below 1'),
        ("participant", None, r'"participant" is empty'),
    ],
)
def test_a_wrong_value_is_named_with_its_row(column: str, value: object, problem: str) -> None:
    trials = table()
    trials.loc[1, column] = value
    with pytest.raises(InputError, match=rf"^trials\.csv, .*{problem}"):
        check(trials, TRIALS)


@pytest.mark.parametrize(
    ("column", "kind", "problem"),
    [
        ("participant", "int64", "is not text"),
        ("sequence", "float64", "is not a whole number"),
        ("dtw_m", "str", "is not a number"),
        ("is_valid", "str", "is not True or False"),
    ],
)
def test_a_column_of_the_wrong_kind_is_named(column: str, kind: str, problem: str) -> None:
    trials = table()
    with pytest.raises(InputError, match=problem):
        check(trials.assign(**{column: trials[column].astype(kind)}), TRIALS)


def test_missing_unknown_and_misplaced_columns_are_named() -> None:
    trials = table()
    with pytest.raises(InputError, match='column "dtw_m" is missing'):
        check(trials.drop(columns="dtw_m"), TRIALS)
    with pytest.raises(InputError, match='no column "dtw"; write "dtw_m" if that was meant'):
        check(trials.rename(columns={"dtw_m": "dtw"}), TRIALS)
    with pytest.raises(InputError, match='"session" is not in its place'):
        check(trials[["session", "participant", *trials.columns[2:]]], TRIALS)


def test_part_of_a_table_can_be_checked() -> None:
    trials = table()[["dtw_m", "participant"]]
    assert check(trials, TRIALS, columns=["participant", "dtw_m"]) is trials
    with pytest.raises(InputError, match='column "session" is missing'):
        check(trials, TRIALS, columns=["session"])
