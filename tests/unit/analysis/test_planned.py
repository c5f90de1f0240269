from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from studykit import analysis
from studykit.analysis.friedman import friedman
from studykit.analysis.multiplicity import holm
from studykit.analysis.wilcoxon import wilcoxon
from studykit.core.errors import InputError
from studykit.core.provenance import canonical_json
from studykit.core.seeding import stream
from studykit.protocol.analysis_plan import AnalysisPlan

ON = ("light-easy-on", "light-hard-on", "intense-easy-on", "intense-hard-on")
PLAN = AnalysisPlan.model_validate(
    {
        "alpha": 0.05,
        "tests": [
            {
                "name": "heart_rate",
                "outcome": "heart_rate_mean_bpm",
                "test": "friedman",
                "conditions": ON,
                "post_hoc": "wilcoxon",
                "pairs": "all",
                "correction": "holm",
            }
        ],
        "correlations": [
            {
                "name": "heart_rate_energy",
                "x": ["linear_energy_asked", "rotational_energy_asked"],
                "y": "heart_rate_mean_bpm",
                "conditions": ON,
                "method": "repeated_measures",
            }
        ],
    }
)


def trials(people: int = 12) -> pd.DataFrame:
    rng = np.random.default_rng(4)
    rows = [
        {
            "participant": f"{person:02d}",
            "session": "01",
            "condition": condition,
            "is_valid": True,
            "exclusion_reason": None,
            "simulated": False,
            "heart_rate_mean_bpm": 100.0 + 3.0 * place + rng.normal(0.0, 4.0),
            "linear_energy_asked": 50.0 + 30.0 * place,
            "rotational_energy_asked": 20.0 + 10.0 * place,
        }
        for person in range(1, people + 1)
        for place, condition in enumerate((*ON, "light-easy-off"))
    ]
    return pd.DataFrame(rows).astype({"exclusion_reason": "str"})


def drop(table: pd.DataFrame, row: int, reason: str | None) -> None:
    table.loc[row, "is_valid"] = False
    table.loc[row, "exclusion_reason"] = reason


def test_every_declared_number_is_there() -> None:
    table = trials()
    results = analysis.run(PLAN, table)
    wide = table.pivot(index="participant", columns="condition", values="heart_rate_mean_bpm")[list(ON)]
    test = results.test("heart_rate")
    assert test.friedman == friedman(wide.to_numpy(), rng=stream(0, "friedman", "heart_rate"))
    assert test.p == test.friedman.p
    assert [pair.test for pair in test.pairs[:1]] == [wilcoxon(wide[ON[0]], wide[ON[1]])]
    assert [pair.p_corrected for pair in test.pairs] == holm([pair.test.p for pair in test.pairs]).tolist()
    assert [(pair.a, pair.b) for pair in test.pairs] == list(PLAN.tests[0].pairs_list())
    assert test.kendalls_w_interval is not None
    assert test.summaries[0].median == wide[ON[0]].median()
    assert test.exclusions.trials == test.exclusions.used == 48
    correlation = results.correlation("heart_rate_energy")
    assert correlation.declared is correlation.repeated_measures is not None
    assert correlation.declared.degrees_of_freedom == 48 - 12 - 1
    assert correlation.distinct_x == 4
    assert correlation.pooled is not None
    assert correlation.pooled.warning is not None


def test_results_are_plain_canonical_and_blind_to_the_order_of_rows() -> None:
    table = trials()
    plain = analysis.run(PLAN, table).to_dict()
    shuffled = analysis.run(PLAN, table.sample(frac=1.0, random_state=1)).to_dict()
    assert canonical_json(plain) == canonical_json(shuffled)
    test = plain["tests"][0]
    assert (test["name"], test["correction"], test["friedman"]["n"]) == ("heart_rate", "holm", 12)
    assert "corrected for ties" in test["friedman"]["variant"]
    pair = test["pairs"][0]
    assert {"a", "b", "n", "p", "p_corrected", "rank_biserial", "is_significant", "z"} <= set(pair)
    assert "exact" in pair["variant"]
    assert len(pair["p_by_variant"]) == 4
    assert plain["correlations"][0]["repeated_measures"]["n"] == 48


def test_what_is_left_out_is_counted_with_its_reason() -> None:
    table = trials()
    drop(table, 0, "interrupted")  # participant 01, light-easy-on
    drop(table, 6, None)  # participant 02, light-hard-on
    table.loc[12, "heart_rate_mean_bpm"] = np.nan  # participant 03, intense-easy-on
    drop(table, 4, "interrupted")  # a condition that the test does not compare
    results = analysis.run(PLAN, table)
    assert (results.trials, results.valid_trials, results.participants) == (60, 57, 12)
    exclusions = results.test("heart_rate").exclusions
    assert exclusions.not_valid == {"interrupted": 1, "no reason given": 1}
    assert exclusions.without_value == 1
    assert exclusions.participants_left_out == {"01": [ON[0]], "02": [ON[1]], "03": [ON[2]]}
    assert exclusions.used == 36
    test = results.test("heart_rate")
    assert test.friedman is not None
    assert test.friedman.n == test.participants == 9
    # A correlation can use people with two conditions or more.
    assert results.correlation("heart_rate_energy").exclusions.used == 45


def test_a_trial_that_was_repeated_counts_once() -> None:
    table = trials()
    again = table.loc[[0]].copy()
    drop(table, 0, "interrupted")
    exclusions = (
        analysis.run(PLAN, pd.concat([table, again], ignore_index=True)).test("heart_rate").exclusions
    )
    assert (exclusions.trials, exclusions.used, exclusions.participants_left_out) == (49, 48, {})


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        (trials(1), "only one participant has a value in all conditions"),
        (trials().query("condition != 'light-hard-on'"), "nobody has a value in light-hard-on"),
        (trials().assign(heart_rate_mean_bpm=100.0), "the same value in all conditions"),
        (trials().assign(is_valid=False), "nobody has a value in light-easy-on, light-hard-on"),
        (
            trials(2).drop(index=[0, 6]),
            "nobody has a value in all conditions; at least two are needed",
        ),
    ],
)
def test_a_test_that_cannot_be_made_says_why(table: pd.DataFrame, reason: str) -> None:
    results = analysis.run(PLAN, table)
    test = results.test("heart_rate")
    assert test.not_computed_because is not None
    assert reason in test.not_computed_because
    assert test.friedman is None
    assert test.pairs == ()
    canonical_json(results.to_dict())


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        (trials().assign(heart_rate_mean_bpm=100.0), "y does not vary"),
        (trials().assign(linear_energy_asked=1.0, rotational_energy_asked=2.0), "x does not vary"),
        (trials().query("condition == 'light-easy-on'"), "nobody has values in two conditions or more"),
    ],
)
def test_a_correlation_that_cannot_be_made_says_why(table: pd.DataFrame, reason: str) -> None:
    result = analysis.run(PLAN, table).correlation("heart_rate_energy")
    assert result.not_computed_because is not None
    assert reason in result.not_computed_because.replace(" within people", "")
    assert result.declared is None


def test_a_pair_without_any_difference_has_no_effect() -> None:
    table = trials()
    light = table["condition"].isin(ON[:2])
    table.loc[light, "heart_rate_mean_bpm"] = 90.0
    pair = analysis.run(PLAN, table).test("heart_rate").pairs[0]
    assert (pair.test.p, pair.p_corrected, pair.rank_biserial_interval) == (1.0, 1.0, None)


def test_tables_that_cannot_be_analysed_are_refused() -> None:
    table = trials()
    with pytest.raises(InputError, match="there are no trials"):
        analysis.run(PLAN, table.iloc[:0])
    with pytest.raises(InputError, match='"linear_energy_asked" is missing'):
        analysis.run(PLAN, table.drop(columns="linear_energy_asked"))
    with pytest.raises(InputError, match="participant 01 has two valid trials of light-easy-on"):
        analysis.run(PLAN, pd.concat([table, table.iloc[:1]], ignore_index=True))


def test_uncorrected_and_chosen_pairs_are_kept_as_declared() -> None:
    declared = PLAN.tests[0].model_copy(update={"pairs": ((ON[0], ON[3]),), "correction": "none"})
    test = analysis.run(PLAN.model_copy(update={"tests": (declared,)}), trials()).tests[0]
    assert [(pair.a, pair.b) for pair in test.pairs] == [(ON[0], ON[3])]
    assert test.pairs[0].p_corrected == test.pairs[0].test.p
    assert test.pairs[0].is_significant
