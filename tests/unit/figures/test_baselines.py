"""Every figure against its picture in `baselines`, drawn small from made-up numbers.

To draw them anew after a change that is meant: STUDYKIT_DRAW_BASELINES=1 pytest THIS FILE; then look at each.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.testing.compare import compare_images

from studykit import figures
from studykit.figures.canvas import PaperFigure
from studykit.motion.joint_mask import spare
from studykit.reports.pipeline import PIPELINE

BASELINES = Path(__file__).parent / "baselines"
DPI = 60
TOLERANCE = 3.0
"""Root mean square over pixels of 0 to 255; letters that move by a tenth of a pixel make less."""


class Made:
    """Made-up things to draw."""

    def __init__(self, request: pytest.FixtureRequest) -> None:
        self.trials: Any = request.getfixturevalue("made_trials")
        self.dances: Any = request.getfixturevalue("made_dances")
        self.dance: Any = request.getfixturevalue("made_dance")
        self.strip: Any = request.getfixturevalue("made_strip")

    @property
    def sparing(self) -> Any:
        return self.dance("BACA", mask=spare("right_elbow"))

    def curve(self, duration_s: float, *, base: float = 100.0) -> figures.PeopleCurve:
        times_s = np.arange(0.25, duration_s, 0.5)
        return figures.PeopleCurve(
            label="Heart rate\n(beats/min)",
            times_s=times_s,
            values=base + np.arange(5)[:, None] + 20.0 * np.sin(times_s / 9.0),
        )

    def pairs(self, *, shift: float = 0.0) -> pd.DataFrame:
        names = ["light-easy-on", "light-hard-on", "intense-easy-on"]
        return pd.DataFrame(
            [
                {
                    "outcome": outcome,
                    "choice": f"choice {number}",
                    "a": names[number],
                    "b": "intense-hard-on",
                    "estimate": scale * (number - 1.0) + shift,
                    "low": scale * (number - 1.6) + shift,
                    "high": scale * (number - 0.3) + shift,
                    "p": 0.03 * number,
                }
                for outcome, scale in (("Heart rate (beats/min)", 10.0), ("Distance (m)", 0.02))
                for number in range(3)
            ]
        )

    def powers(self) -> pd.DataFrame:
        return pd.DataFrame(
            [
                {
                    "test": test, "question": question, "participants": people, "power": power,
                    "low": power - 0.05, "high": power + 0.04,
                }
                for test, slope in (("heart_rate", 8.0), ("smoothness", 30.0))
                for question, factor in (("conditions differ", 1.0), ("any pair", 1.6), ("a - b", 3.0))
                for people in (8, 16, 24, 32)
                for power in [float(1.0 - np.exp(-people / slope / factor))]
            ]
        )  # fmt: skip


LABELS = {"heart_rate_mean_bpm": "Mean heart rate (beats/min)", "dtw_m": "Movement (DTW) distance (m)"}
CELLS = ("light-easy-on", "light-hard-on", "intense-easy-on", "intense-hard-on")

FIGURES: dict[str, Callable[[Made], PaperFigure]] = {
    "1": lambda made: figures.free_and_sparing(made.dance("BACA"), made.sparing),
    "2": lambda made: figures.framework(PIPELINE),
    "3": lambda made: figures.film_strips(
        [made.dance(), made.dance("ABCa", condition="light-easy-off")]
    ),
    "4": lambda made: figures.meeting_segments(made.dance("ADCB")),
    "6": lambda made: figures.four_dances(
        [made.strip(name, amplitude=0.4 + 0.2 * place) for place, name in enumerate(CELLS)], simulated=True
    ),
    "7": lambda made: figures.movement_by_condition(made.trials()),
    "8": lambda made: figures.smoothness_by_condition(made.trials()),
    "9": lambda made: figures.energy_profile(
        [made.dance("BACA"), made.sparing], people=[[made.curve(16.0)], [made.curve(16.0, base=95.0)]],
        simulated=True,
    ),
    "10a": lambda made: figures.energy_profile(
        [made.dance("AACCAACC", blocks=4, condition="hiit-on")],
        measures=("linear_energy", "rotational_energy"), people=[[made.curve(32.0)]], simulated=True,
    ),
    "10b": lambda made: figures.energy_profile(
        [made.dance("AABCAABC", blocks=4, condition="waves-on")],
        measures=("variety",), people=[[made.curve(32.0)]], simulated=True,
    ),
    "heart-rate": lambda made: figures.heart_rate_by_condition(made.trials()),
    "relation": lambda made: figures.heart_rate_against_energy(made.trials()),
    "asked": lambda made: figures.asked_and_achieved(made.dances()),
    "declared": lambda made: figures.declared_outcomes(
        made.trials(),
        [(name, words, CELLS) for name, words in LABELS.items()],
    ),
    "periods": lambda made: figures.outcomes_by_period(
        made.trials().assign(period=lambda table: table.groupby("participant").cumcount() + 1), LABELS
    ),
    "forest": lambda made: figures.forest(made.pairs(), simulated=True),
    "sensitivity": lambda made: figures.sensitivity(made.pairs(), simulated=True),
    "power": lambda made: figures.power_curve(made.powers()),
    "courses": lambda made: figures.compared_courses(
        [
            figures.Course(
                curves={name: made.curve(32.0, base=90.0 + 10.0 * place) for place, name in enumerate(CELLS)},
                clusters=((4.0, 12.0, 0.002), (20.0, 23.0, 0.3)),
            )
        ],
        simulated=True,
    ),
    "searches": lambda made: figures.search_traces([made.dance(), made.dance("ABC")]),
}  # fmt: skip


def saved(figure: PaperFigure, path: Path) -> Path:
    figure.savefig(path, dpi=DPI)
    return path


@pytest.fixture
def made(request: pytest.FixtureRequest) -> Made:
    return Made(request)


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_looks_as_it_did(name: str, made: Made, tmp_path: Path) -> None:
    expected = BASELINES / f"{name}.png"
    if os.environ.get("STUDYKIT_DRAW_BASELINES"):
        saved(FIGURES[name](made), expected)
    # The comparison writes a picture of the differences beside the actual one.
    actual = saved(FIGURES[name](made), tmp_path / f"{name}.png")
    assert compare_images(str(expected), str(actual), tol=TOLERANCE) is None


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("forest", lambda made: figures.forest(made.pairs(shift=2.0), simulated=True)),
        ("forest", lambda made: figures.forest(made.pairs())),  # unmarked
        ("7", lambda made: figures.movement_by_condition(made.trials(participants=5))),
        ("1", lambda made: figures.free_and_sparing(made.sparing, made.sparing)),
        ("10a", lambda made: figures.energy_profile(
            [made.dance("AACCAACC", blocks=2, condition="hiit-on")],
            measures=("linear_energy", "rotational_energy"), people=[[made.curve(32.0)]], simulated=True,
        )),
    ],
)  # fmt: skip
def test_another_figure_does_not_pass_for_it(
    name: str, wrong: Callable[[Made], PaperFigure], made: Made, tmp_path: Path
) -> None:
    actual = saved(wrong(made), tmp_path / "wrong.png")
    assert compare_images(str(BASELINES / f"{name}.png"), str(actual), tol=TOLERANCE) is not None


def test_baselines_are_small_and_none_is_left_over() -> None:
    pictures = list(BASELINES.glob("*.png"))
    assert {path.stem for path in pictures} == set(FIGURES)
    assert sum(path.stat().st_size for path in pictures) < 1_500_000


@pytest.mark.parametrize("name", FIGURES)
def test_every_figure_is_as_wide_as_a_column_or_a_page(name: str, made: Made) -> None:
    figure = FIGURES[name](made)
    width_mm, height_mm = figure.get_size_inches() * 25.4
    assert any(abs(width_mm - wide) < 0.1 for wide in (figures.style.COLUMN_MM, figures.style.PAGE_MM))
    assert height_mm <= 250.0


@pytest.mark.parametrize("name", ["3", "4", "forest"])
def test_rare_letters_are_embedded_like_all_others(name: str, made: Made) -> None:
    # Matplotlib draws what its font lacks from another one, in a way of its own.
    pdf = FIGURES[name](made).file_bytes("pdf")
    assert b"/FontFile2" in pdf
    assert b"/Type3" not in pdf
