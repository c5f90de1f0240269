"""The power curve shows the table that it is given."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from studykit.core.errors import InputError
from studykit.figures import power_curve

TABLE = pd.DataFrame(
    {
        "test": ["heart rate", "heart rate", "smoothness", "smoothness"],
        "participants": [20, 8, 8, 20],
        "power": [0.99, 0.7, 0.2, 0.5],
        "low": [0.97, 0.65, 0.15, 0.45],
        "high": [1.0, 0.75, 0.25, 0.55],
    }
)


def test_each_test_is_a_line_in_order_of_size_in_per_cent() -> None:
    lines = [line for line in power_curve(TABLE).axes[0].lines if line.get_gid() == "power"]
    assert [line.get_label() for line in lines] == ["heart rate", "smoothness"]
    assert np.asarray(lines[0].get_xydata()).tolist() == [[8.0, 70.0], [20.0, 99.0]]
    assert np.asarray(lines[1].get_xydata()).tolist() == [[8.0, 20.0], [20.0, 50.0]]


def test_lines_differ_in_colour_marker_and_dashes() -> None:
    first, second = (line for line in power_curve(TABLE).axes[0].lines if line.get_gid() == "power")
    assert first.get_color() != second.get_color()
    assert first.get_marker() != second.get_marker()
    assert first.get_linestyle() != second.get_linestyle()


def test_levels_wanted_are_marked_and_one_test_needs_no_name() -> None:
    figure = power_curve(TABLE.iloc[:2].drop(columns="test"), wanted=(0.8,))
    levels = [line for line in figure.axes[0].lines if line.get_gid() != "power"]
    assert [float(np.asarray(line.get_ydata())[0]) for line in levels] == [80.0]
    assert not figure.legends


def test_a_table_without_rows_or_columns_is_refused() -> None:
    with pytest.raises(InputError, match="there is no row"):
        power_curve(TABLE.iloc[:0])
    with pytest.raises(InputError, match='there is no column "low"'):
        power_curve(TABLE.drop(columns="low"))
