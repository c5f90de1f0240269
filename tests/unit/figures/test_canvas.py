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
from studykit.figures.style import RC, sheet


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
    assert fonts_are_embedded(figure.file_bytes("pdf"))


def fonts_are_embedded(pdf: bytes) -> bool:
    """Tell whether every font of a PDF is TrueType (Type 42) with its glyphs, as journals ask."""
    kinds = set(re.findall(rb"/Subtype /(Type0|Type1|Type3|TrueType|CIDFontType\d)", pdf))
    descriptors, files = pdf.count(b"/Type /FontDescriptor"), len(re.findall(rb"/FontFile2 \d+ 0 R", pdf))
    return kinds <= {b"Type0", b"CIDFontType2", b"TrueType"} and 0 < descriptors == files


def test_fonts_of_matplotlibs_own_kind_would_be_noticed(made_trials: Callable[..., pd.DataFrame]) -> None:
    figure = movement_by_condition(made_trials())
    with pytest.MonkeyPatch.context() as patched:
        patched.setitem(RC, "pdf.fonttype", 3)
        assert not fonts_are_embedded(figure.file_bytes("pdf"))


def test_a_file_takes_one_drawing(made_trials: Callable[..., pd.DataFrame]) -> None:
    figure = movement_by_condition(made_trials())
    figure.file_bytes("svg")  # lays it out
    counted = Counted(figure)
    figure.file_bytes("svg")
    assert counted.times == 1


class Counted:
    """How often a figure's first axes are drawn."""

    def __init__(self, figure: PaperFigure) -> None:
        self.times = 0
        draw = figure.axes[0].draw

        def count(renderer: object) -> None:
            self.times += 1
            draw(renderer)

        figure.axes[0].draw = count  # type: ignore[method-assign]


def test_settings_of_the_reader_stay_as_they_are(made_trials: Callable[..., pd.DataFrame]) -> None:
    before = dict(mpl.rcParams)
    figure = movement_by_condition(made_trials())
    plain = figure.file_bytes("svg")
    assert dict(mpl.rcParams) == before
    with mpl.rc_context({"font.size": 30.0, "axes.grid": True, "savefig.dpi": 50}):
        assert movement_by_condition(made_trials()).file_bytes("svg") == plain
