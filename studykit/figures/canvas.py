"""The sheet on which every figure is drawn: it prints the same on any machine."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.transforms import Bbox

from studykit.figures import style

_UNDATED: dict[str, dict[str, None]] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}


class PaperFigure(Figure):
    """A matplotlib figure sized in millimetres that takes studykit's style with it.

    It belongs to no window and to no global state of matplotlib; a notebook shows it as the last value of
    a cell. Saved files carry their fonts and no date, so equal data give equal bytes. `marks` says what in
    it is simulated or made up.
    """

    marks: tuple[str, ...] = ()

    def __init__(self, *, width_mm: float, height_mm: float) -> None:
        size = (width_mm / style.MM_PER_INCH, height_mm / style.MM_PER_INCH)
        super().__init__(figsize=size, layout="constrained")
        FigureCanvasAgg(self)

    def savefig(self, fname: Any, **options: Any) -> None:
        """Write the figure in the style's fonts and without a date; the arguments are matplotlib's."""
        ending = options.get("format") or Path(str(fname)).suffix.lstrip(".")
        metadata = _UNDATED.get(ending, {}) | options.pop("metadata", {})
        with style.in_style():
            self._fix_layout()
            super().savefig(fname, metadata=metadata or None, **options)

    def file_bytes(self, file_format: str) -> bytes:
        """Give the figure as the content of a file.

        Parameters
        ----------
        file_format : str
            "svg", "pdf" or "png".
        """
        buffer = io.BytesIO()
        self.savefig(buffer, format=file_format)
        return buffer.getvalue()

    def _fix_layout(self) -> None:
        """Lay the figure out once and for all: another round would move things by a hair."""
        if not isinstance(self.get_layout_engine(), ConstrainedLayoutEngine):
            return
        self.draw_without_rendering()
        self.set_layout_engine(None)  # an engine, even an idle one, would have every file drawn twice
        for axes in self.axes:
            # The solver's last digits hang on where objects lie in memory.
            axes.set_position(Bbox(np.round(axes.get_position().get_points(), 6)))

    def _repr_png_(self) -> bytes:
        return self.file_bytes("png")
