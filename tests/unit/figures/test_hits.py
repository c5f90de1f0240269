"""Hit rates: dots are dances, shares are counts."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from studykit.core.errors import InputError
from studykit.figures import hit_rates, style
from studykit.figures.canvas import PaperFigure
from studykit.figures.hits import hits
from studykit.protocol.condition import ALL_CONDITIONS


@pytest.fixture(scope="module")
def searches() -> pd.DataFrame:
    """Make up 20 dances for each condition and preset; the paper's miss by ten times as much."""
    rng = np.random.default_rng(1)
    rows = [
        {
            "condition": condition,
            "preset": preset,
            "seed": seed,
            "linear_off": rng.normal(0.0, spread),
            "rotational_off": rng.normal(0.0, spread),
            "variety_off": rng.normal(0.0, 2.0 * spread),
            "displacement_m": rng.uniform(0.05, 0.2),
            "distinct_segments": int(rng.integers(2, 9)),
        }
        for condition in ALL_CONDITIONS
        for preset, spread in (("paper", 0.3), ("studykit", 0.03))
        for seed in range(20)
    ]
    return pd.DataFrame(rows)


@pytest.fixture(scope="module")
def figure(searches: pd.DataFrame) -> PaperFigure:
    return hit_rates(searches)


def test_every_dance_is_a_dot_at_its_miss(searches: pd.DataFrame, figure: PaperFigure) -> None:
    columns = ("linear_off", "rotational_off", "variety_off", "displacement_m", "distinct_segments")
    for axes, column, factor in zip(figure.axes, columns, (100.0, 100.0, 100.0, 1000.0, 1.0), strict=True):
        places = [c.get_offsets() for c in axes.collections if c.get_gid() == f"dances {column}"]
        drawn = np.sort(np.asarray(np.concatenate(places))[:, 0])
        assert drawn == pytest.approx(np.sort(np.maximum(factor * searches[column].abs().to_numpy(), 0.01)))


def test_medians_and_shares_are_those_of_condition_and_preset(searches, figure: PaperFigure) -> None:
    axes = figure.axes[0]
    medians = [float(c.get_offsets()[0, 0]) for c in axes.collections if c.get_gid() == "median"]
    shares = [text.get_text() for text in axes.texts if text.get_gid() == "share"]
    light_easy_on = searches[searches["condition"] == "light-easy-on"]
    for number, preset in enumerate(("studykit", "paper")):
        off = light_easy_on[light_easy_on["preset"] == preset]["linear_off"].abs()
        assert medians[number] == pytest.approx(100.0 * off.median())
        assert shares[number] == f"{100.0 * (off <= 0.05).mean():.0f}"
    assert axes.get_yticklabels()[0].get_text() == "Light – Easy, on"


def test_a_dance_hits_when_it_misses_nothing() -> None:
    columns = ("linear_off", "rotational_off", "variety_off")
    rows = [(0.0, 0.0, 0.0), (-0.05, 0.05, -0.1), (0.06, 0.0, 0.0), (0.0, 0.0, -0.11)]
    dances = pd.DataFrame(rows, columns=columns)
    assert hits(dances) == 0.5
    apart = np.mean([hits(dances, {column: 0.05}) for column in columns])
    assert apart != hits(dances)  # Wrong: the mean of the shares of single targets
    assert np.isnan(hits(dances.iloc[:0]))


def test_the_legend_says_how_many_hit_all(searches: pd.DataFrame, figure: PaperFigure) -> None:
    (legend,) = figure.legends
    said = [text.get_text() for text in legend.get_texts()]
    for words, preset in zip(said, ("studykit", "paper"), strict=False):
        share = hits(searches[searches["preset"] == preset])
        assert words == f"{preset}: {100.0 * share:.1f} % hit all"


def test_what_was_not_tried_is_left_out(searches: pd.DataFrame) -> None:
    few = searches[searches["condition"].isin(["light-easy-on", "light-hard-off"])]
    few = few[~((few["preset"] == "paper") & (few["condition"] == "light-hard-off"))]
    axes = hit_rates(few).axes[0]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["Light – Easy, on", "Light – Hard, off"]
    assert len([c for c in axes.collections if c.get_gid() == "median"]) == 3


def test_hit_rates_say_what_is_made_up_and_what_is_missing(searches: pd.DataFrame) -> None:
    assert hit_rates(searches[:2], synthetic=True).get_suptitle() == style.SYNTHETIC
    assert hit_rates(searches[:2]).get_suptitle() == ""
    with pytest.raises(InputError, match="no dance"):
        hit_rates(searches.iloc[:0])
    with pytest.raises(InputError, match="no column 'variety_off'"):
        hit_rates(searches.drop(columns="variety_off"))
