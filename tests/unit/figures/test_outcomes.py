from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.stats import t

from studykit import figures
from studykit.core.errors import InputError
from studykit.figures.style import SIMULATED

Draw = Callable[[pd.DataFrame], Any]
OUTCOMES = [
    (figures.movement_by_condition, "dtw_m"),
    (figures.heart_rate_by_condition, "heart_rate_mean_bpm"),
    (figures.smoothness_by_condition, "smoothness_rating"),
    (figures.movement_against_variety, "dtw_m"),
    (figures.heart_rate_against_energy, "heart_rate_mean_bpm"),
    (
        lambda trials: figures.declared_outcomes(
            trials, [("dtw_m", "Distance (m)", trials["condition"][::2])]
        ),
        "dtw_m",
    ),
]


def points(figure: Any, condition: str) -> list[float]:
    (drawn,) = [c for c in figure.axes[0].collections if c.get_gid() == f"participants {condition}"]
    return sorted(drawn.get_offsets()[:, 1].tolist())


def intervals(figure: Any) -> list[tuple[float, float]]:
    """Give the ends of all error bars, from the lowest up."""
    bars = [bar for container in figure.axes[0].containers for bar in container[2]]
    return sorted(
        (float(path.vertices[0, 1]), float(path.vertices[1, 1])) for bar in bars for path in bar.get_paths()
    )


@pytest.mark.parametrize(("draw", "outcome"), OUTCOMES)
def test_every_participant_is_a_point(
    draw: Draw, outcome: str, made_trials: Callable[..., pd.DataFrame]
) -> None:
    trials = made_trials()
    figure = draw(trials)
    for condition in ("light-easy-on", "light-hard-on", "intense-easy-on", "intense-hard-on"):
        expected = trials.loc[trials["condition"] == condition, outcome]
        assert points(figure, condition) == pytest.approx(sorted(expected))


@pytest.mark.parametrize(("draw", "outcome"), OUTCOMES)
def test_bars_are_95_percent_intervals_of_the_mean(
    draw: Draw, outcome: str, made_trials: Callable[..., pd.DataFrame]
) -> None:
    trials = made_trials()
    shown = trials if outcome == "smoothness_rating" else trials[trials["transition"] == "on"]
    groups = [group.to_numpy(float) for _, group in shown.groupby("condition")[outcome]]
    expected = sorted(t.interval(0.95, len(g) - 1, g.mean(), g.std(ddof=1) / np.sqrt(len(g))) for g in groups)
    assert np.allclose(intervals(draw(trials)), expected)


@pytest.mark.parametrize(("draw", "outcome"), OUTCOMES)
def test_simulated_data_say_so_and_others_do_not(
    draw: Draw, outcome: str, made_trials: Callable[..., pd.DataFrame]
) -> None:
    del outcome
    assert draw(made_trials(simulated=True)).get_suptitle() == SIMULATED
    assert draw(made_trials(simulated=False)).get_suptitle() == ""
    one = made_trials(simulated=False)
    one.loc[0, "simulated"] = True
    assert draw(one).get_suptitle() == SIMULATED


@pytest.mark.parametrize(("draw", "outcome"), OUTCOMES)
def test_one_participant_and_a_missing_condition_can_be_drawn(
    draw: Draw, outcome: str, made_trials: Callable[..., pd.DataFrame]
) -> None:
    trials = made_trials(participants=1)
    trials.loc[trials["condition"] == "light-hard-on", outcome] = np.nan
    assert draw(trials).file_bytes("svg")


def test_the_question_and_its_scale_are_named(made_trials: Callable[..., pd.DataFrame]) -> None:
    figure = figures.smoothness_by_condition(made_trials(), scale=(1, 7), question="It flowed.")
    axes = figure.axes[0]
    assert axes.get_ylabel().startswith("“It flowed”")
    assert axes.get_yticks().tolist() == [1, 2, 3, 4, 5, 6, 7]


def test_a_question_with_dollars_is_no_formula(made_trials: Callable[..., pd.DataFrame]) -> None:
    figure = figures.smoothness_by_condition(made_trials(), question="It was worth $5_ or {$6.")
    assert figure.file_bytes("svg")


def test_every_declared_outcome_has_a_panel_with_its_conditions(
    made_trials: Callable[..., pd.DataFrame],
) -> None:
    trials = made_trials()
    every = list(trials["condition"].unique())
    declared = [
        ("dtw_m", "Distance (m)", every[:2]),
        ("heart_rate_mean_bpm", "Heart rate (beats/min)", every[::2]),
        ("smoothness_rating", "Smoothness", every),
    ]
    figure = figures.declared_outcomes(trials.assign(heart_rate_mean_bpm=np.nan), declared)
    assert [axes.get_ylabel() for axes in figure.axes] == ["Distance (m)", "Smoothness"]
    assert [len(axes.get_xticks()) for axes in figure.axes] == [2, 8]
    assert figure.axes[1].get_xticklabels()[1].get_text() == "Light\nEasy\noff"


def test_nothing_declared_and_nothing_measured_are_told_apart(
    made_trials: Callable[..., pd.DataFrame],
) -> None:
    with pytest.raises(InputError, match="no test is declared"):
        figures.declared_outcomes(made_trials(), [])
    with pytest.raises(InputError, match="no valid trial has a value of dtw_m"):
        figures.declared_outcomes(made_trials().assign(is_valid=False), [("dtw_m", "", ["light-easy-on"])])
