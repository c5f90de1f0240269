from __future__ import annotations

from collections.abc import Callable

import pandas as pd
import pytest

from studykit.core.errors import InputError
from studykit.figures import asked_and_achieved
from studykit.figures.style import SYNTHETIC, in_style


def test_every_dance_stands_where_it_came(made_dances: Callable[..., pd.DataFrame]) -> None:
    dances = made_dances()
    figure = asked_and_achieved(dances, body_mass_kg=100.0)
    for axes, goal, factor in zip(
        figure.axes, ("linear_energy", "rotational_energy", "variety"), (100.0, 100.0, 1.0), strict=True
    ):
        drawn = {c.get_gid(): float(c.get_offsets()[0, 0]) for c in axes.collections if c.get_gid()}
        for _, dance in dances.iterrows():
            assert drawn[f"dance {dance['condition']}"] == pytest.approx(factor * dance[f"{goal}_achieved"])


def test_synthetic_movement_says_so(made_dances: Callable[..., pd.DataFrame]) -> None:
    assert asked_and_achieved(made_dances(is_synthetic=True)).get_suptitle() == SYNTHETIC
    assert asked_and_achieved(made_dances(is_synthetic=False)).get_suptitle() == ""


def test_no_dance_is_said(made_dances: Callable[..., pd.DataFrame]) -> None:
    with pytest.raises(InputError, match="no dance to show"):
        asked_and_achieved(made_dances().iloc[:0])


@pytest.mark.parametrize("dots_per_inch", [50, 72, 100, 200, 300])
def test_no_word_leaves_the_sheet(made_dances: Callable[..., pd.DataFrame], dots_per_inch: int) -> None:
    figure = asked_and_achieved(made_dances())
    figure.file_bytes("svg")
    figure.set_dpi(dots_per_inch)
    with in_style():
        inches = figure.get_tightbbox()
    assert min(inches.x0, inches.y0) >= 0.0
    assert inches.x1 <= figure.get_figwidth()
    assert inches.y1 <= figure.get_figheight()
