"""What holds for every figure of dances: its words stay on the sheet and apart."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations

import pytest
from matplotlib.legend import Legend
from matplotlib.text import Text

from studykit.choreography.dance import Dance
from studykit.figures import (
    energy_profile,
    film_strips,
    joint_intensity_map,
    search_trace,
    targets_and_achieved,
)
from studykit.figures.canvas import PaperFigure
from studykit.figures.style import in_style
from studykit.motion.joint_mask import spare

FIGURES: tuple[Callable[[Sequence[Dance]], PaperFigure], ...] = (
    film_strips,
    joint_intensity_map,
    energy_profile,
    targets_and_achieved,
    lambda dances: search_trace(dances[-1]),
)
NAMES = ("film", "map", "profile", "targets", "trace")


@pytest.fixture(scope="module")
def pair(made_dance) -> list[Dance]:
    mask = spare(["right_shoulder", "left_knee"], speed_limits_rad_s=4.0)
    return [
        made_dance("ABACABAa"),
        made_dance("ABCDABCD" * 2, condition="intense-hard-off", mask=mask, blocks=2),
    ]


def words(figure: PaperFigure) -> list[Text]:
    """Give all that is written on a figure."""
    found = [text for legend in figure.legends for text in legend.get_texts()]
    for axes in figure.axes:
        found += [*axes.texts, axes.title, axes._left_title]
        found += [text for legend in axes.findobj(Legend) for text in legend.get_texts()]
        if not axes.axison:
            continue
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            found.append(axis.label)
            found += [tick.label1 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
            found += [tick.label2 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
    return found


@pytest.mark.parametrize("draw", FIGURES, ids=NAMES)
def test_words_stay_on_the_sheet_and_apart(pair: list[Dance], draw) -> None:
    figure = draw(pair)
    with in_style():
        figure.draw_without_rendering()
        inches = figure.get_tightbbox()
        boxes = {
            f"{number} {text.get_text()}": text.get_window_extent().padded(-1.0)
            for number, text in enumerate(words(figure))
            if text.get_text() and text.get_visible()
        }
    assert min(inches.x0, inches.y0) >= 0.0
    assert inches.x1 <= figure.get_figwidth()
    assert inches.y1 <= figure.get_figheight()
    assert not [(a, b) for a, b in combinations(boxes, 2) if boxes[a].overlaps(boxes[b])]
