"""Forests and sensitivity: squares and lines stand where the table says; p is never told by colour alone."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex

from studykit.core.errors import InputError
from studykit.figures import forest, sensitivity

TABLE = pd.DataFrame(
    {
        "outcome": ["Heart rate (beats/min)"] * 3 + ["Distance (m)"],
        "choice": ["declared", "other", "third", "declared"],
        "a": ["light-easy-on"] * 4,
        "b": ["light-hard-on", "intense-easy-on", "light-easy-off", "light-hard-on"],
        "estimate": [-1.5, -20.0, 2.0, 0.05],
        "low": [-3.0, -24.0, -1.0, float("nan")],
        "high": [0.5, -17.0, 5.0, float("nan")],
        "p": [0.2, 0.0004, 0.0499, 0.05],
    }
)


def test_every_estimate_has_its_place_and_its_interval() -> None:
    axes = forest(TABLE).axes[0]
    squares = [one for one in axes.collections if one.get_gid() == "estimates"]
    drawn = {tuple(place) for one in squares for place in np.asarray(one.get_offsets()).tolist()}
    assert drawn == {(-1.5, 0.0), (-20.0, 1.0), (2.0, 2.0)}
    (lines,) = (one for one in axes.collections if one.get_gid() == "intervals")
    ends = [path.vertices[:, 0].tolist() for path in lines.get_paths()]
    assert ends == [[-3.0, 0.5], [-24.0, -17.0], [-1.0, 5.0]]


def test_squares_are_filled_where_p_is_below_the_level_and_p_is_written() -> None:
    axes = forest(TABLE, alpha=0.05).axes[0]
    squares = [one for one in axes.collections if one.get_gid() == "estimates"]
    faces = {to_hex(one.get_facecolor()[0]): np.asarray(one.get_offsets())[:, 1].tolist() for one in squares}
    assert faces == {"#222222": [1.0, 2.0], "#ffffff": [0.0]}
    assert [text.get_text().split("   ")[1] for text in axes.texts] == ["p = .200", "p < .001", "p = .050"]


def test_pairs_are_named_in_words() -> None:
    labels = [text.get_text() for text in forest(TABLE).axes[0].get_yticklabels()]
    assert labels[1] == "Light – Easy, on  −  Intense – Easy, on"


def test_outcomes_of_different_units_have_axes_of_their_own() -> None:
    figure = forest(TABLE)
    assert [axes.get_xlabel() for axes in figure.axes] == ["Heart rate (beats/min)", "Distance (m)"]
    assert len(figure.axes[1].get_yticks()) == 1  # without an interval it is still shown


def test_the_declared_choice_is_marked() -> None:
    axes = sensitivity(TABLE).axes[0]
    dashed = [line for line in axes.lines if line.get_linestyle() == "--"]
    assert [float(np.asarray(line.get_xdata())[0]) for line in dashed] == [-1.5]
    assert not [line for line in forest(TABLE).axes[0].lines if line.get_linestyle() == "--"]


@pytest.mark.parametrize("draw", [forest, sensitivity])
def test_a_table_without_rows_or_columns_is_refused(draw) -> None:
    with pytest.raises(InputError, match="there is no row"):
        draw(TABLE.iloc[:0])
    with pytest.raises(InputError, match='there is no column "p"'):
        draw(TABLE.drop(columns="p"))
    assert draw(TABLE, simulated=True).marks
    assert not draw(TABLE).marks
