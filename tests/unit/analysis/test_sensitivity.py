"""A declared test is made again with every choice that concerns it, and only with those."""

from __future__ import annotations

import numpy as np
import pandas as pd

from studykit.analysis.planned.comparison import compare
from studykit.analysis.sensitivity import DECLARED, RESERVE, sensitivity, vigorous_times, without_effect
from studykit.protocol.analysis_plan import AnalysisPlan

ON = ("light-easy-on", "light-hard-on", "intense-easy-on", "intense-hard-on")


def test_plan(name: str, outcome: str) -> dict[str, object]:
    return {
        "name": name,
        "outcome": outcome,
        "test": "friedman",
        "conditions": ON,
        "post_hoc": "wilcoxon",
        "pairs": [ON[:2], ON[2:]],
        "correction": "holm",
    }


test_plan.__test__ = False
PLAN = AnalysisPlan.model_validate(
    {"alpha": 0.05, "tests": [test_plan("pulse", "heart_rate_mean_bpm"), test_plan("movement", "dtw_m")]}
)


def trials() -> pd.DataFrame:
    rng = np.random.default_rng(1)
    rows = [
        {
            "participant": f"{person:02d}",
            "condition": condition,
            "is_valid": True,
            "exclusion_reason": None,
            "heart_rate_mean_bpm": 100.0 + 20.0 * place + rng.normal(0.0, 3.0),
            "dtw_m": 0.1 + 0.01 * rng.normal(),
        }
        for person in range(12)
        for place, condition in enumerate(ON)
    ]
    return pd.DataFrame(rows).astype({"exclusion_reason": "str"})


def test_choices_are_made_for_the_tests_that_they_concern() -> None:
    declared = trials()
    longer = declared.assign(heart_rate_mean_bpm=declared["heart_rate_mean_bpm"] + 0.5)
    fewer = declared.assign(is_valid=declared["participant"] != "00")
    rows = sensitivity(PLAN, declared, {"longer window": longer, "as it is": declared, "one fewer": fewer})
    assert [(row.name, row.choice) for row in rows] == [
        ("pulse", DECLARED),
        ("pulse", "longer window"),
        ("pulse", "one fewer"),
        ("movement", DECLARED),
        ("movement", "one fewer"),
    ]
    again = compare(PLAN.tests[0], fewer, 0.05)
    assert again.friedman is not None
    assert (rows[2].chi_squared, rows[2].p, rows[2].participants) == (again.friedman.chi_squared, again.p, 11)
    assert rows[2].kendalls_w_interval == again.kendalls_w_interval
    assert all(row.same_verdict for row in rows[:3])


def test_a_verdict_that_turns_is_seen_even_where_only_its_direction_does() -> None:
    declared = trials()
    swapped = declared.copy()
    names = dict(zip(ON, (ON[1], ON[0], ON[3], ON[2]), strict=True))
    swapped["condition"] = swapped["condition"].map(names)
    lost = declared.assign(heart_rate_mean_bpm=np.tile(np.arange(48.0).reshape(4, 12).T.ravel() % 5, 1))
    rows = sensitivity(PLAN, declared, {"swapped": swapped, "lost": lost})
    turned = {row.choice: row.other_verdicts for row in rows if row.name == "pulse"}
    assert turned[DECLARED] == ()
    assert turned["swapped"] == (f"{ON[0]} - {ON[1]}", f"{ON[2]} - {ON[3]}")
    verdicts = {row.choice: row.same_verdict for row in rows if row.name == "pulse"}
    assert verdicts == {DECLARED: True, "swapped": False, "lost": False}
    assert {row.significant_pairs for row in rows if row.choice == "swapped" and row.name == "pulse"} == {2}


def test_what_cannot_be_made_says_why() -> None:
    declared = trials()
    nobody = declared.assign(heart_rate_mean_bpm=np.nan)
    row = sensitivity(PLAN, declared, {"belt lost": nobody})[1]
    assert (row.chi_squared, row.p, row.same_verdict) == (None, None, None)
    assert "nobody has a value" in str(row.not_computed_because)


def test_a_choice_that_changes_nothing_is_named_all_the_same() -> None:
    declared = trials()
    longer = declared.assign(heart_rate_mean_bpm=declared["heart_rate_mean_bpm"] + 0.5)
    others = {"longer window": longer, "as it is": declared}
    assert without_effect(sensitivity(PLAN, declared, others), others) == ("as it is",)


def test_vigorous_time_is_told_under_each_choice_that_changes_it() -> None:
    declared = trials().assign(
        session="01", repetition=1, vigorous_fraction=0.25, vigorous_fraction_reserve=0.5
    )
    declared.loc[declared["condition"] == ON[0], "vigorous_fraction"] = np.nan
    longer = declared.assign(vigorous_fraction=0.75)
    rows = vigorous_times(ON, declared, {"longer window": longer, "as it is": declared})
    assert {(row.choice, row.mean) for row in rows} == {
        (DECLARED, 0.25),
        (RESERVE, 0.5),
        ("longer window", 0.75),
    }
    assert [row.condition for row in rows if row.choice == DECLARED] == list(ON[1:])
    assert {row.n for row in rows} == {12}
