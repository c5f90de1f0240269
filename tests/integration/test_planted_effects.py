"""Two thousand made-up studies of twenty people, analysed blind: intervals hold what was planted, and nothing
is found where nothing was."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
import pandas as pd
import pytest

from studykit.analysis import mixed_model as own
from studykit.analysis import run
from studykit.analysis.friedman import centred_ranks, chi_squared_of_ranks, kendalls_w_interval
from studykit.analysis.mixed_model import mixed_model
from studykit.analysis.outcome_model import OutcomeModel, model_of
from studykit.analysis.power import decisions, orders
from studykit.analysis.simulated_trials import simulated_trials
from studykit.analysis.wilcoxon import hodges_lehmann
from studykit.core.arrays import Floats
from studykit.io.protocol_file import default_protocol, read_protocol
from studykit.participant.effects import NONE, PAPER, PLANTED, Effects
from studykit.protocol.analysis_plan import TestPlan
from studykit.protocol.study_protocol import StudyProtocol

STUDIES, PEOPLE = 2000, 20
FACTORS = ("intensity", "variety", "transition")
LEVELS = {"intensity": ("intense", "light"), "variety": ("hard", "easy"), "transition": ("on", "off")}


@pytest.fixture(scope="module")
def protocol() -> StudyProtocol:
    return read_protocol(default_protocol())


def rested(protocol: StudyProtocol) -> StudyProtocol:
    """The study without training just before the first dance, which raises everybody's first heart rate.

    In a balanced order that makes all comparisons of the heart rate cautious: their intervals hold more than
    they claim, and families err in less than one of a hundred studies.
    """
    return protocol.model_copy(update={"session": protocol.session.model_copy(update={"train_s": 0.0})})


@pytest.fixture(scope="module")
def crowd(protocol: StudyProtocol) -> Callable[[Effects], pd.DataFrame]:
    """Give everybody who takes part in any of the studies, with hearts, skills and tastes of their own."""

    @lru_cache
    def draw(name: str) -> pd.DataFrame:
        return simulated_trials(rested(protocol), PLANTED[name], people=STUDIES * PEOPLE, seed=11)

    return lambda effects: draw(effects.name)


def studies_of(table: pd.DataFrame, outcome: str, conditions: tuple[str, ...]) -> Floats:
    """Give the values by study, person and condition."""
    wide = table.pivot(index="participant", columns="condition", values=outcome)[list(conditions)]
    return wide.to_numpy().reshape(STUDIES, PEOPLE, len(conditions))


def share_of(hits: np.ndarray) -> float:
    return float(np.mean(hits))


def pair_coverage(differences: Floats, true: float, *, confidence: float = 0.95) -> tuple[float, float]:
    """Give how often the interval of a pair holds the true shift, and how often its estimate has the sign."""
    shifts = [hodges_lehmann(study, confidence=confidence) for study in differences]
    holds = [shift.interval[0] <= true <= shift.interval[1] for shift in shifts]
    return float(np.mean(holds)), float(
        np.mean([np.sign(shift.estimate) == np.sign(true) for shift in shifts])
    )


def pseudomedian(differences: Floats) -> float:
    """Give the shift of a whole population: the median of the means of two people's differences."""
    rng = np.random.default_rng(0)
    flat = differences.ravel()
    return float(np.median([(flat + rng.permutation(flat)) / 2.0 for _ in range(20)]))


def made_up(model: OutcomeModel, protocol: StudyProtocol) -> Floats:
    given = orders(protocol, PEOPLE)
    return model.draw(given, protocol.order.labels, studies=STUDIES, rng=np.random.default_rng(12))


def plans(protocol: StudyProtocol) -> dict[str, TestPlan]:
    return {plan.outcome: plan for plan in protocol.analysis.tests}


@pytest.mark.slow
@pytest.mark.parametrize("outcome", ["heart_rate_mean_bpm", "dtw_m", "smoothness_rating"])
def test_the_interval_of_every_declared_pair_holds_the_planted_shift(
    protocol: StudyProtocol, crowd: Callable[[Effects], pd.DataFrame], outcome: str
) -> None:
    plan = plans(protocol)[outcome]
    values = studies_of(crowd(PAPER), outcome, plan.conditions)
    p = decisions(plan, values, rng=np.random.default_rng(0))[:, 1:]
    for place, (a, b) in enumerate(plan.pairs_list()):
        differences = values[..., plan.conditions.index(a)] - values[..., plan.conditions.index(b)]
        true = pseudomedian(differences)
        covered, right = pair_coverage(differences, true)
        power = share_of(p[:, place] < protocol.analysis.alpha)
        narrow, _ = pair_coverage(differences[:500], true, confidence=0.85)
        print(
            f"{outcome} {a} - {b}: shift {true:.4g}, covered {covered:.4f}, power {power:.3f}, "
            f"sign {right:.4f}"
        )
        if outcome == "smoothness_rating":  # whole ticks: the limits belong to the interval, which holds more
            assert covered >= 0.93
        else:
            assert 0.93 <= covered <= 0.97
            assert narrow < 0.93  # an interval of another level would be noticed
        if power >= 0.99:
            assert right >= 0.99


@pytest.mark.slow
@pytest.mark.parametrize(
    ("outcome", "slope", "carry"), [("heart_rate_mean_bpm", 0.4, 0.2), ("dtw_m", -3e-4, 0.1)]
)
def test_the_interval_of_every_contrast_of_the_model_holds_what_is_planted(
    protocol: StudyProtocol,
    crowd: Callable[[Effects], pd.DataFrame],
    outcome: str,
    slope: float,
    carry: float,
) -> None:
    pilot = model_of(crowd(PAPER).head(8 * 400), outcome)
    model = OutcomeModel(
        outcome=outcome,
        means=pilot.means,
        between_sd=pilot.between_sd,
        within_sd=pilot.within_sd,
        period_slope=slope,
        carry_over=carry,
        lost=0.02,
    )
    frame = crowd(PAPER).head(8 * PEOPLE).copy()
    labels = protocol.order.labels
    place = np.array([labels.index(name) for name in frame["condition"]])
    person = np.repeat(np.arange(PEOPLE), len(labels))
    given = place.reshape(PEOPLE, -1)
    values = model.draw(given, labels, studies=STUDIES, rng=np.random.default_rng(13))
    held: dict[str, list[bool]] = {}
    narrow: list[bool] = []
    for study in values:
        fit = mixed_model(frame.assign(**{outcome: study[person, place]}), outcome, factors=FACTORS)
        for contrast in fit.differences:
            factor, _, levels = contrast.name.partition(": ")
            if factor not in LEVELS:
                continue
            high, low = levels.split(" - ")
            true = np.mean([model.means[n] for n in labels if high in n.split("-")]) - np.mean(
                [model.means[n] for n in labels if low in n.split("-")]
            )
            held.setdefault(contrast.name, []).append(contrast.interval[0] <= true <= contrast.interval[1])
            narrow.append(abs(contrast.estimate - true) <= 1.44 * contrast.standard_error)  # 85 %
    assert {name.partition(":")[0] for name in held} == set(FACTORS)
    for name, hits in held.items():
        print(f"{outcome} {name}: covered {share_of(np.array(hits)):.4f}")
        assert 0.93 <= np.mean(hits) <= 0.97
    assert np.mean(narrow) < 0.93


@pytest.mark.slow
@pytest.mark.parametrize("outcome", ["heart_rate_mean_bpm", "dtw_m", "smoothness_rating"])
def test_where_nothing_is_planted_a_family_errs_in_six_of_a_hundred_studies_at_most(
    protocol: StudyProtocol, crowd: Callable[[Effects], pd.DataFrame], outcome: str
) -> None:
    plan = plans(protocol)[outcome]
    values = studies_of(crowd(NONE), outcome, plan.conditions)
    alpha = protocol.analysis.alpha
    errors = {}
    for correction in ("holm", "none"):
        declared = TestPlan.model_validate(plan.model_dump() | {"correction": correction})
        p = decisions(declared, values, rng=np.random.default_rng(0))
        errors[correction] = share_of((p[:, 1:] < alpha).any(axis=1))
    omnibus = share_of(p[:, 0] < alpha)
    print(f"{outcome}: Friedman {omnibus:.4f}, family {errors['holm']:.4f}, uncorrected {errors['none']:.4f}")
    assert omnibus <= 0.06
    assert errors["holm"] <= 0.06
    assert errors["none"] > 0.06  # pairs without a correction would be noticed


@pytest.mark.slow
def test_the_blind_analysis_is_that_of_a_study(
    protocol: StudyProtocol, crowd: Callable[[Effects], pd.DataFrame]
) -> None:
    plan = protocol.analysis.model_copy(update={"correlations": (), "curves": None})
    everything = crowd(PAPER)
    for number in range(3):
        table = everything.iloc[number * 8 * PEOPLE : (number + 1) * 8 * PEOPLE]
        results = run(plan, table)
        for test in results.tests:
            values = studies_of(everything, test.plan.outcome, test.plan.conditions)[number : number + 1]
            p = decisions(test.plan, values, rng=np.random.default_rng(0))[0]
            assert [test.p, *(pair.p_corrected for pair in test.pairs)] == pytest.approx(p.tolist())
            for pair in test.pairs:
                a, b = (test.plan.conditions.index(name) for name in (pair.a, pair.b))
                assert pair.shift == hodges_lehmann(values[0, :, a] - values[0, :, b])


@pytest.mark.slow
def test_how_often_the_interval_of_w_holds_is_told(
    protocol: StudyProtocol, crowd: Callable[[Effects], pd.DataFrame]
) -> None:
    for outcome, plan in plans(protocol).items():
        values = studies_of(crowd(PAPER), outcome, plan.conditions)
        rng = np.random.default_rng(14)
        most = PEOPLE * (len(plan.conditions) - 1)
        true = np.mean([chi_squared_of_ranks(centred_ranks(study))[0] / most for study in values[:500]])
        intervals = [kendalls_w_interval(study, rng=rng) for study in values[:500]]
        covered = np.mean([low <= true <= high for low, high in intervals])
        print(f"{outcome}: W {true:.3f} on average, held by {covered:.3f} of the bootstrap intervals")
        assert all(0.0 <= low <= high <= 1.0 for low, high in intervals)


@pytest.mark.slow
def test_training_just_before_the_first_dance_makes_the_heart_rate_cautious_and_never_bold(
    protocol: StudyProtocol,
) -> None:
    plan = plans(protocol)["heart_rate_mean_bpm"]
    table = simulated_trials(protocol, NONE, people=STUDIES * PEOPLE, seed=11)
    values = studies_of(table, plan.outcome, plan.conditions)
    p = decisions(plan, values, rng=np.random.default_rng(0))
    alpha = protocol.analysis.alpha
    omnibus, family = share_of(p[:, 0] < alpha), share_of((p[:, 1:] < alpha).any(axis=1))
    print(f"with training: Friedman {omnibus:.4f}, family {family:.4f}")
    assert max(omnibus, family) <= 0.06


def model_coverage(everything: pd.DataFrame, outcome: str, *, studies: int) -> dict[str, float]:
    """Give how often the model's interval of every factor holds what the factor does to all people."""
    held: dict[str, list[bool]] = {}
    true = {
        factor: everything.pivot_table(columns=factor, values=outcome).loc[outcome, list(levels)]
        for factor, levels in LEVELS.items()
    }
    for number in range(studies):
        table = everything.iloc[number * 8 * PEOPLE : (number + 1) * 8 * PEOPLE]
        for found in mixed_model(table, outcome, factors=FACTORS).differences:
            factor, _, levels = found.name.partition(": ")
            high, low = levels.split(" - ")
            gain = true[factor][high] - true[factor][low]
            held.setdefault(found.name, []).append(found.interval[0] <= gain <= found.interval[1])
    return {name: float(np.mean(hits)) for name, hits in held.items()}


@pytest.mark.slow
@pytest.mark.parametrize("outcome", ["heart_rate_mean_bpm", "dtw_m", "smoothness_rating"])
def test_where_people_respond_differently_the_intervals_of_the_model_keep_their_word(
    protocol: StudyProtocol, crowd: Callable[[Effects], pd.DataFrame], outcome: str
) -> None:
    """Intense dances raise the heart of one person more than of another."""
    covered = model_coverage(crowd(PAPER), outcome, studies=STUDIES)
    assert len(covered) == len(FACTORS)
    for name, share in covered.items():
        print(f"{outcome} {name}: covered {share:.4f}")
        assert 0.93 <= share <= 0.97


@pytest.mark.slow
def test_a_model_in_which_people_differ_in_their_level_alone_would_be_noticed(
    crowd: Callable[[Effects], pd.DataFrame], monkeypatch: pytest.MonkeyPatch
) -> None:
    # Wrong on purpose: the model's own standard errors, as if all people responded alike.
    monkeypatch.setattr(own, "ClusterRobust", lambda fit: fit)
    covered = model_coverage(crowd(PAPER), "heart_rate_mean_bpm", studies=500)["intensity: intense - light"]
    print(f"as if all responded alike: covered {covered:.4f}")
    assert covered < 0.9
