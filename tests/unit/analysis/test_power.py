from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.stats import nct, t

from studykit.analysis import run
from studykit.analysis.outcome_model import OutcomeModel, model_of
from studykit.analysis.power import ANY_CONDITION, ANY_PAIR, decisions, orders, power
from studykit.analysis.simulated_trials import simulated_trials
from studykit.cli import main
from studykit.core.errors import InputError
from studykit.io.protocol_file import default_protocol, read_protocol
from studykit.participant.effects import NONE, PAPER
from studykit.participant.person import cohort
from studykit.protocol.analysis_plan import AnalysisPlan, TestPlan
from studykit.protocol.study_protocol import StudyProtocol

CONDITIONS = ("light-easy-on", "light-hard-on", "intense-easy-on")


@pytest.fixture(scope="module")
def protocol() -> StudyProtocol:
    return read_protocol(default_protocol())


def model(protocol: StudyProtocol, *steps: float, **changes: object) -> OutcomeModel:
    """A heart rate that is 100 but for some conditions."""
    means = dict.fromkeys(protocol.order.labels, 100.0)
    means |= {
        name: 100.0 + step for name, step in zip(protocol.analysis.tests[0].conditions, steps, strict=False)
    }
    values: dict[str, object] = {"between_sd": 8.0, "within_sd": 4.0} | changes
    return OutcomeModel(outcome="heart_rate_mean_bpm", means=means, **values)  # type: ignore[arg-type]


def rows(values: np.ndarray, outcome: str) -> pd.DataFrame:
    """The table of trials of one study, shape (person, condition)."""
    people, conditions = np.meshgrid(range(len(values)), CONDITIONS, indexing="ij")
    table = pd.DataFrame({"condition": conditions.ravel(), outcome: values.ravel()})
    table["participant"] = [f"{person:02d}" for person in people.ravel()]
    table["session"], table["is_valid"], table["simulated"] = "01", True, True
    table["sequence"], table["period"], table["previous_condition"] = 1, 1, None
    table["exclusion_reason"] = None
    return table.astype({"exclusion_reason": "str", "previous_condition": "str"})


@pytest.mark.parametrize("correction", ["holm", "bonferroni", "none", "closed"])
@pytest.mark.parametrize("p", [None, "f", "permutation"])
@pytest.mark.parametrize("zeros", [None, "pratt"])
def test_the_p_are_those_of_the_analysis_itself(correction: str, p: str | None, zeros: str | None) -> None:
    rng = np.random.default_rng(3)
    values = rng.normal(loc=[0.0, 0.5, 1.0], size=(5, 7, 3))
    values[3:] = np.clip(np.round(2.0 * values[3:] + 4.0), 1.0, 7.0)  # ratings: ties and zeros
    values[1, 2, 0] = np.nan
    values[2, 0, 1] = values[2, 0, 0]  # one zero and no tie
    plan = TestPlan(
        name="t", outcome="smoothness_rating", test="friedman", conditions=CONDITIONS, post_hoc="wilcoxon",
        pairs="all", correction=correction, p_from=p, zeros=zeros,  # type: ignore[arg-type]
    )  # fmt: skip
    found = decisions(plan, values, rng=np.random.default_rng(0))
    for study, ours in zip(values, found, strict=True):
        test = run(AnalysisPlan(alpha=0.05, tests=(plan,)), rows(study, plan.outcome)).tests[0]
        assert test.p == pytest.approx(ours[0], abs=1e-12)
        assert [pair.p_corrected for pair in test.pairs] == pytest.approx(ours[1:].tolist(), abs=1e-12)


def test_where_nothing_differs_tests_find_something_as_often_as_they_may(protocol: StudyProtocol) -> None:
    found = power(protocol, model(protocol), participants=[20], studies=2000, rng=np.random.default_rng(1))
    table = found.table().set_index("question")
    assert 0.03 < table.loc[ANY_CONDITION, "power"] < 0.06
    assert 0.02 < table.loc[ANY_PAIR, "power"] < 0.06  # the family, not each pair
    assert (table["low"] < table["power"]).all()
    assert (table["power"] < table["high"]).all()
    uncorrected = protocol.model_dump(mode="json")
    uncorrected["analysis"]["tests"][0]["correction"] = "none"
    wrong = power(
        StudyProtocol.model_validate(uncorrected),
        model(protocol),
        participants=[20],
        studies=2000,
        rng=np.random.default_rng(1),
    )
    assert wrong.table().set_index("question").loc[ANY_PAIR, "low"] > 0.1


def test_a_pair_has_a_little_less_power_than_the_t_test_would(protocol: StudyProtocol) -> None:
    alone = protocol.model_dump(mode="json")
    alone["analysis"]["tests"][0] |= {"pairs": [["light-easy-on", "light-hard-on"]], "correction": "none"}
    people = 16
    found = power(
        StudyProtocol.model_validate(alone),
        model(protocol, 0.0, 4.0),
        participants=[people],
        studies=1500,
        rng=np.random.default_rng(2),
    )
    got = found.table().set_index("question").loc["light-easy-on - light-hard-on", "power"]
    limit = t.isf(0.025, people - 1)
    shift = 4.0 / (4.0 * np.sqrt(2.0)) * np.sqrt(people)
    of_t = nct.sf(limit, people - 1, shift) + nct.cdf(-limit, people - 1, shift)
    assert of_t - 0.06 < got < of_t + 0.02


def test_more_people_and_fewer_losses_find_more(protocol: StudyProtocol) -> None:
    sizes = (8, 14, 24)
    found = {
        lost: power(
            protocol,
            model(protocol, 0.0, 1.5, 3.0, 6.0, lost=lost),
            participants=sizes,
            studies=200,
            rng=np.random.default_rng(4),
        )
        for lost in (0.0, 0.1)
    }
    whole, torn = (
        part.table().query("question == @ANY_CONDITION")["power"].to_numpy() for part in found.values()
    )
    assert np.all(np.diff(whole) >= 0.0)
    assert np.all(torn <= whole)
    assert torn[0] < whole[0]
    few, many = found[0.0].people_needed(0.3), found[0.0].people_needed(0.9)
    assert few is not None
    assert many is not None
    assert few < many
    assert found[0.0].people_needed(0.999999) is None


def test_people_dance_in_the_orders_of_the_protocol(protocol: StudyProtocol) -> None:
    given = orders(protocol, 20)
    assert given.shape == (20, 8)
    assert all(sorted(order) == list(range(8)) for order in given.tolist())
    exact = model(protocol, between_sd=0.0, within_sd=0.0, period_slope=1.0)
    values = exact.draw(given, protocol.order.labels, studies=2, rng=np.random.default_rng(0))
    np.testing.assert_allclose(
        np.take_along_axis(values[0], given, axis=1), 100.0 + np.arange(8) + 0.0 * given
    )
    exact = model(protocol, 8.0, between_sd=0.0, within_sd=0.0, carry_over=0.5)
    values = exact.draw(given, protocol.order.labels, studies=1, rng=np.random.default_rng(0))
    special = protocol.order.labels.index(protocol.analysis.tests[0].conditions[0])
    after = given[0, list(given[0]).index(special) + 1]
    assert values[0, 0, after] == pytest.approx(100.0 + 0.5 * (8.0 - 1.0))


def test_a_model_is_found_again_in_a_large_pilot(protocol: StudyProtocol) -> None:
    true = model(protocol, 3.0, -2.0, 5.0, period_slope=0.5, carry_over=0.3, lost=0.05)
    given = np.tile(orders(protocol, 24), (40, 1))
    values = true.draw(given, protocol.order.labels, studies=1, rng=np.random.default_rng(5))[0]
    conditions = np.array(protocol.order.labels)[given]
    people, periods = np.indices(given.shape)
    table = pd.DataFrame(
        {
            "participant": [f"{n:04d}" for n in people.ravel()],
            "period": periods.ravel() + 1,
            "condition": conditions.ravel(),
            "previous_condition": np.hstack([np.full((len(given), 1), None), conditions[:, :-1]]).ravel(),
            "heart_rate_mean_bpm": np.take_along_axis(values, given, axis=1).ravel(),
            "is_valid": True,
        }
    )
    found = model_of(table, "heart_rate_mean_bpm", with_order=True)
    assert found.between_sd == pytest.approx(8.0, rel=0.08)
    assert found.within_sd == pytest.approx(4.0, rel=0.03)
    assert found.period_slope == pytest.approx(0.5, abs=0.06)
    assert found.carry_over == pytest.approx(0.3, abs=0.1)
    assert found.lost == pytest.approx(0.05, abs=0.01)
    apart = {name: found.means[name] - found.means["light-hard-off"] for name in true.means}
    told = {name: true.means[name] - true.means["light-hard-off"] for name in true.means}
    assert apart == pytest.approx(told, abs=0.9)
    assert model_of(table, "heart_rate_mean_bpm").period_slope == 0.0
    noise = np.random.default_rng(6).normal(scale=4.0, size=len(table))  # people do not differ at all
    alike = model_of(table.assign(heart_rate_mean_bpm=noise), "heart_rate_mean_bpm")
    assert alike.between_sd < 0.6
    assert alike.within_sd == pytest.approx(4.0, rel=0.03)


def test_simulated_people_bring_what_was_planted(protocol: StudyProtocol) -> None:
    table = simulated_trials(protocol, PAPER, people=800, seed=2)
    means = table.groupby(["intensity", "variety", "transition"])[["dtw_m", "heart_rate_mean_bpm"]].mean()
    expected = PAPER.movement_error.expected("intense-hard-on") - PAPER.movement_error.expected(
        "light-hard-on"
    )
    hard = means.xs(("hard", "on"), level=("variety", "transition"))["dtw_m"]
    assert hard["intense"] - hard["light"] == pytest.approx(expected, abs=0.001)
    assert means["heart_rate_mean_bpm"].between(60.0, 150.0).all()
    ratings = model_of(table, "smoothness_rating", scale=(1, 7))
    assert ratings.between_sd == pytest.approx(PAPER.smoothness.person_sd, rel=0.15)
    assert ratings.within_sd == pytest.approx(PAPER.smoothness.trial_sd, rel=0.1)
    skills = [person.skill for person in cohort(800, 2)]
    errors = table.groupby("participant")["dtw_m"].mean()
    assert np.corrcoef(skills, errors)[0, 1] < -0.8
    assert table.equals(simulated_trials(protocol, PAPER, people=800, seed=2))
    same = model_of(simulated_trials(protocol, NONE, people=400, seed=2), "heart_rate_mean_bpm").means
    assert max(same.values()) - min(same.values()) < 1.5
    assert run(protocol.analysis.model_copy(update={"correlations": ()}), table.head(160)).participants == 20


def test_what_cannot_be_answered_is_refused(protocol: StudyProtocol) -> None:
    other = OutcomeModel(outcome="dtw_lag_s", means={}, between_sd=1.0, within_sd=1.0)
    with pytest.raises(InputError, match="no declared test compares dtw_lag_s; use one of: heart_rate"):
        power(protocol, other, rng=np.random.default_rng(0))
    lacking = OutcomeModel(outcome="dtw_m", means={"light-easy-on": 1.0}, between_sd=1.0, within_sd=1.0)
    with pytest.raises(InputError, match="has no mean for light-easy-off"):
        power(protocol, lacking, rng=np.random.default_rng(0))
    table = simulated_trials(protocol, PAPER, people=2)
    with pytest.raises(InputError, match="tell no spread"):
        model_of(table[table["participant"] == "01"], "dtw_m")
    with pytest.raises(InputError, match="nobody has a value of dtw_m in light-easy-on"):
        model_of(table.assign(dtw_m=table["dtw_m"].where(table["condition"] != "light-easy-on")), "dtw_m")
    for wrong in ({"within_sd": -1.0}, {"lost": 1.0}, {"period_slope": np.nan}):
        with pytest.raises(ValueError, match=r"finite|negative|lost"):
            model(protocol, **wrong)


def test_the_command_says_how_many_people_are_enough(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    words = [
        "power",
        str(default_protocol()),
        "--studies",
        "100",
        "--participants",
        "8",
        "--participants",
        "24",
    ]
    with pytest.raises(SystemExit) as end:
        main(words)
    assert end.value.code == 0
    said = capsys.readouterr().out
    assert "SIMULATED people with the effects paper" in said
    assert "heart_rate, conditions differ: 8: 100%, 24: 100%; 8 are enough for 80%" in said
    assert "more are needed for 80%" in said
    with pytest.raises(SystemExit):
        main([*words, "--json"])
    rows = json.loads(capsys.readouterr().out)
    assert {row["participants"] for row in rows} == {8, 24}
    with pytest.raises(SystemExit) as end:
        main(["power", str(tmp_path)])
    assert end.value.code == 2
    assert "protocol.toml" in capsys.readouterr().err
