"""The power curve shows the table that it is given."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from studykit.core.errors import InputError
from studykit.figures import power_curve

TABLE = pd.DataFrame(
    {
        "test": ["heart_rate"] * 6 + ["smoothness"] * 2,
        "question": ["any condition"] * 2 + ["any pair"] * 2 + ["a - b"] * 2 + ["any condition"] * 2,
        "participants": [20, 8, 8, 20, 8, 20, 8, 20],
        "power": [0.99, 0.7, 0.6, 0.9, 0.3, 0.4, 0.2, 0.5],
        "low": [0.97, 0.65, 0.55, 0.85, 0.25, 0.35, 0.15, 0.45],
        "high": [1.0, 0.75, 0.65, 0.95, 0.35, 0.45, 0.25, 0.55],
    }
)


def lines(figure, panel: int) -> dict[str, list[list[float]]]:
    drawn = [line for line in figure.axes[panel].lines if line.get_gid() == "power"]
    return {line.get_label(): np.asarray(line.get_xydata()).tolist() for line in drawn}


def test_each_test_is_a_panel_and_each_question_a_line_in_order_of_size_in_per_cent() -> None:
    figure = power_curve(TABLE)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["Heart rate", "Smoothness"]
    assert lines(figure, 0) == {
        "any condition": [[8.0, 70.0], [20.0, 99.0]],
        "any pair": [[8.0, 60.0], [20.0, 90.0]],
        "single pairs": [[8.0, 30.0], [20.0, 40.0]],
    }
    assert lines(figure, 1) == {"any condition": [[8.0, 20.0], [20.0, 50.0]]}


def test_questions_differ_in_colour_marker_and_dashes() -> None:
    first, second, pair = (line for line in power_curve(TABLE).axes[0].lines if line.get_gid() == "power")
    assert first.get_color() != second.get_color()
    assert first.get_marker() != second.get_marker()
    assert first.get_linestyle() != second.get_linestyle()
    assert pair.get_linewidth() < first.get_linewidth()


def test_levels_wanted_are_marked_and_one_question_needs_no_name() -> None:
    figure = power_curve(TABLE.iloc[:2].drop(columns="question"), wanted=(0.8,))
    levels = [line for line in figure.axes[0].lines if line.get_gid() != "power"]
    assert [float(np.asarray(line.get_ydata())[0]) for line in levels] == [80.0]
    assert not figure.legends


def test_a_table_without_rows_or_columns_is_refused() -> None:
    with pytest.raises(InputError, match="there is no row"):
        power_curve(TABLE.iloc[:0])
    with pytest.raises(InputError, match='there is no column "low"'):
        power_curve(TABLE.drop(columns="low"))
