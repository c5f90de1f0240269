from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from studykit import analysis
from studykit.analysis.aligned_ranks import aligned_ranks
from studykit.analysis.bayes import bayes_factor
from studykit.analysis.friedman import friedman
from studykit.analysis.mixed_model import mixed_model
from studykit.analysis.multiplicity import closed_friedman, holm
from studykit.analysis.planned import Course
from studykit.analysis.wilcoxon import hodges_lehmann, wilcoxon
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


# --- further kinds of comparison -------------------------------------------------------------------------


def planned(**changes: object) -> AnalysisPlan:
    """Give the plan with its one test changed, or with further parts."""
    values = PLAN.model_dump(mode="json")
    values |= {name: value for name, value in changes.items() if name in values}
    values["tests"][0] |= {name: value for name, value in changes.items() if name not in values}
    return AnalysisPlan.model_validate(values)


def ordered(people: int = 16) -> pd.DataFrame:
    """Give trials of a crossover in four orders, with sequence, period and the condition before."""
    rng = np.random.default_rng(7)
    orders = [(0, 1, 3, 2), (1, 2, 0, 3), (2, 3, 1, 0), (3, 0, 2, 1)]
    rows = []
    for person in range(people):
        level = rng.normal(0.0, 5.0)
        before = None
        for period, place in enumerate(orders[person % 4], start=1):
            intensity, variety, transition = ON[place].split("-")
            rows.append(
                {
                    "participant": f"{person:02d}",
                    "session": "01",
                    "sequence": person % 4 + 1,
                    "period": period,
                    "condition": ON[place],
                    "intensity": intensity,
                    "variety": variety,
                    "transition": transition,
                    "previous_condition": before,
                    "is_valid": True,
                    "exclusion_reason": None,
                    "simulated": True,
                    "heart_rate_mean_bpm": 100.0 + 15.0 * (place > 1) + level + rng.normal(0.0, 3.0),
                    "linear_energy_asked": 50.0 + 30.0 * place,
                    "rotational_energy_asked": 20.0 + 10.0 * place,
                }
            )
            before = ON[place]
    return pd.DataFrame(rows).astype({"exclusion_reason": "str", "previous_condition": "str"})


@pytest.mark.parametrize("kind", ["chi_squared", "f", "permutation"])
def test_p_is_of_the_kind_declared(kind: str) -> None:
    test = analysis.run(planned(p_from=kind), trials()).test("heart_rate")
    assert test.friedman is not None
    names = {"chi_squared": "p", "f": "f_p", "permutation": "permutation_p"}
    assert test.p == getattr(test.friedman, names[kind])
    assert len({test.friedman.p, test.friedman.f_p, test.friedman.permutation_p}) == 3


def test_zeros_are_treated_as_declared_and_the_other_ways_stand_beside() -> None:
    table = trials()
    table["heart_rate_mean_bpm"] = (table["heart_rate_mean_bpm"] / 4.0).round() * 4.0
    dropped, pratt = (
        analysis.run(planned(zeros=zeros), table).test("heart_rate") for zeros in (None, "pratt")
    )
    for own, other in zip(dropped.pairs, pratt.pairs, strict=True):
        assert "Pratt" in other.test.variant
        assert own.p_by_variant[other.test.variant] == other.test.p
        assert other.p_by_variant[own.test.variant] == own.test.p
    assert any(a.test.p != b.test.p for a, b in zip(dropped.pairs, pratt.pairs, strict=True))


def test_closed_testing_corrects_all_pairs_where_declared() -> None:
    table = trials()
    wide = table.pivot(index="participant", columns="condition", values="heart_rate_mean_bpm")[list(ON)]
    test = analysis.run(planned(correction="closed"), table).test("heart_rate")
    pairs = [(ON.index(pair.a), ON.index(pair.b)) for pair in test.pairs]
    assert [pair.p_corrected for pair in test.pairs] == closed_friedman(wide.to_numpy(), pairs).tolist()


def test_people_who_lack_a_condition_are_kept_where_that_is_declared() -> None:
    table = trials()
    for person in range(12):  # nobody danced all four
        drop(table, table.index[(table["participant"] == f"{person + 1:02d}")][person % 4], "interrupted")
    test = analysis.run(planned(missing="skillings_mack"), table).test("heart_rate")
    assert test.friedman is None
    assert test.skillings_mack is not None
    assert (test.skillings_mack.n, test.skillings_mack.cells_missing) == (12, 12)
    assert analysis.run(PLAN, table).test("heart_rate").skillings_mack is None
    alone = analysis.run(planned(missing="skillings_mack"), table[table["participant"] == "01"])
    assert alone.test("heart_rate").skillings_mack is None
    assert "2 or more people" in str(alone.test("heart_rate").skillings_mack_not_computed_because)


def test_a_pair_has_its_shift_in_the_unit_of_the_outcome_and_its_evidence() -> None:
    table = trials()
    wide = table.pivot(index="participant", columns="condition", values="heart_rate_mean_bpm")[list(ON)]
    results = analysis.run(PLAN, table)
    pair = results.test("heart_rate").pairs[0]
    differences = (wide[pair.a] - wide[pair.b]).to_numpy()
    assert pair.shift == hodges_lehmann(differences)
    assert pair.bayes_factor_10 == bayes_factor(wide[pair.a], wide[pair.b])
    assert f"{pair.shift.estimate:+.3g} [" in str(results)


def test_models_and_the_order_of_conditions_are_part_of_the_results() -> None:
    model = {"outcome": "heart_rate_mean_bpm", "factors": ["intensity", "variety"]}
    plan = planned(
        models=[
            model | {"name": "mixed", "method": "mixed_model"},
            model | {"name": "ranked", "method": "aligned_ranks"},
            model | {"name": "alone", "method": "aligned_ranks", "factors": ["transition"]},
        ]
    )
    table = ordered()
    results = analysis.run(plan, table)
    mixed, ranked, alone = results.models
    assert mixed.mixed_model == mixed_model(table, "heart_rate_mean_bpm", factors=("intensity", "variety"))
    assert {term.name for term in mixed.mixed_model.terms if term.p < 0.05} == {"intensity"}
    assert ranked.effects == aligned_ranks(table, "heart_rate_mean_bpm", ("intensity", "variety"))
    assert alone.not_computed_because is not None
    assert "level" in alone.not_computed_because
    assert [order.outcome for order in results.order_effects] == ["heart_rate_mean_bpm"]
    assert results.order_effects[0].effects is not None
    assert {"mixed (heart_rate_mean_bpm)", "order of conditions"} <= {
        part for line in str(results).splitlines() for part in (line.split(":")[0], line[:19])
    }
    canonical_json(results.to_dict())


def test_a_table_without_the_order_says_so_instead_of_an_effect_of_order() -> None:
    order = analysis.run(PLAN, trials()).order_effects[0]
    assert order.effects is None
    assert order.not_computed_because == 'there is no column "sequence"'


def equality(**changes: object) -> AnalysisPlan:
    pair = {
        "name": "same",
        "outcome": "heart_rate_mean_bpm",
        "a": ON[0],
        "b": ON[1],
        "low": -8.0,
        "high": 8.0,
    }
    return planned(equivalences=[pair | changes])


def test_a_pair_that_should_not_differ_is_tested_for_that() -> None:
    results = analysis.run(equality(), ordered())
    found = results.equivalences[0].found
    assert found is not None
    assert found.by_t.is_equivalent
    assert "same (heart_rate_mean_bpm, light-easy-on - light-hard-on within -8 to 8)" in str(results)
    far = analysis.run(equality(b=ON[3]), ordered()).equivalences[0].found
    assert far is not None
    assert not far.by_t.is_equivalent  # 15 bpm apart
    alone = analysis.run(equality(), ordered(1)).equivalences[0]
    assert alone.found is None
    assert "only one participant" in str(alone.not_computed_because)


def course(people: int, bump: float, *, first: int = 0) -> Course:
    rng = np.random.default_rng(3)
    times = np.arange(0.25, 16.0, 0.5)
    values = rng.normal(size=(20, len(times)))[first : first + people]
    values[:, 10:20] += bump
    return Course(participants=tuple(f"{first + n:02d}" for n in range(people)), times_s=times, values=values)


def test_curves_are_compared_for_the_people_who_have_all_of_them() -> None:
    plan = planned(curves=[{"name": "pulse", "curve": "heart_rate", "conditions": ON[:2]}])
    courses = {ON[0]: course(14, 0.0), ON[1]: course(14, 4.0, first=2)}
    result = analysis.run(plan, trials(), courses={"heart_rate": courses}).curves[0]
    assert result.found is not None
    assert result.found.n == 12
    [cluster] = [one for one in result.found.clusters if one.p < 0.05]
    assert (cluster.start_s, cluster.stop_s) == (5.25, 9.75)
    apart = {ON[0]: course(4, 0.0), ON[1]: course(4, 0.0, first=10)}
    lost = analysis.run(plan, trials(), courses={"heart_rate": apart}).curves[0]
    assert lost.found is None
    assert lost.not_computed_because is not None


@pytest.mark.parametrize(
    ("courses", "words"),
    [
        (None, "nobody has a curve in light-easy-on, light-hard-on"),
        ({ON[0]: course(12, 0.0)}, "nobody has a curve in light-hard-on"),
    ],
)
def test_curves_that_are_not_there_are_named(courses: dict[str, Course] | None, words: str) -> None:
    plan = planned(curves=[{"name": "pulse", "curve": "heart_rate", "conditions": ON[:2]}])
    given = None if courses is None else {"heart_rate": courses}
    result = analysis.run(plan, trials(), courses=given).curves[0]
    assert result.not_computed_because == words
    assert f"not computed because {words}" in str(analysis.run(plan, trials(), courses=given))
