from __future__ import annotations

import re
import struct
from collections.abc import Callable

import matplotlib as mpl
import pandas as pd
import pytest
from IPython.core.formatters import DisplayFormatter

from studykit.figures import movement_by_condition
from studykit.figures.canvas import PaperFigure
from studykit.figures.style import INTENSITY, sheet


@pytest.mark.parametrize("ending", ["svg", "png", "pdf"])
def test_equal_data_give_equal_bytes(ending: str, made_trials: Callable[..., pd.DataFrame]) -> None:
    first, second = (movement_by_condition(made_trials()).file_bytes(ending) for _ in range(2))
    assert first == second
    assert b"CreationDate" not in first
    assert b"<dc:date>" not in first


def test_saving_twice_gives_equal_bytes(made_trials: Callable[..., pd.DataFrame]) -> None:
    figure = movement_by_condition(made_trials())
    assert figure.file_bytes("svg") == figure.file_bytes("svg")


def test_a_notebook_shows_it_as_a_picture() -> None:
    shown, _ = DisplayFormatter().format(sheet(width_mm=50.0, height_mm=40.0, simulated=True))
    assert shown["image/png"].startswith(b"\x89PNG")


def test_it_is_as_large_as_it_says() -> None:
    figure = PaperFigure(width_mm=88.0, height_mm=76.2)
    width, height = struct.unpack(">II", figure.file_bytes("png")[16:24])
    assert (width, height) == (int(88.0 / 25.4 * 200), 600)


def test_text_in_files_needs_no_fonts_of_the_reader(made_trials: Callable[..., pd.DataFrame]) -> None:
    figure = movement_by_condition(made_trials())
    assert b"<text" not in figure.file_bytes("svg")
    assert b"/FontFile2" in figure.file_bytes("pdf")


def test_settings_of_the_reader_stay_as_they_are(made_trials: Callable[..., pd.DataFrame]) -> None:
    before = dict(mpl.rcParams)
    figure = movement_by_condition(made_trials())
    plain = figure.file_bytes("svg")
    assert dict(mpl.rcParams) == before
    with mpl.rc_context({"font.size": 30.0, "axes.grid": True, "savefig.dpi": 50}):
        assert movement_by_condition(made_trials()).file_bytes("svg") == plain


def test_the_two_intensities_differ_for_every_common_kind_of_colour_vision() -> None:
    # Linear RGB as seen without red or green receptors (Viénot, Brettel and Mollon 1999), and in grey.
    kinds = {
        "protanopia": [[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]],
        "deuteranopia": [[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]],
    }
    light, intense = (
        [(int(v, 16) / 255) ** 2.2 for v in re.findall("..", c[1:])] for c in INTENSITY.values()
    )
    for rows in kinds.values():
        seen = [[sum(a * b for a, b in zip(row, c, strict=True)) for row in rows] for c in (light, intense)]
        assert max(abs(a - b) for a, b in zip(*seen, strict=True)) > 0.2
