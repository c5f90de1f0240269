"""How every figure looks: sizes, colours, words, and the mark of simulated data."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from studykit.figures.canvas import PaperFigure

MM_PER_INCH = 25.4
COLUMN_MM = 88.0
"""Width of a figure in one column of a journal."""
PAGE_MM = 180.0
"""Width of a figure across a page."""

INK = "#222222"
FAINT = "#8a8a8a"
GRID = "#e4e4e4"
# The pair of Okabe and Ito's palette that every common kind of colour vision tells apart, also in grey.
INTENSITY = {"light": "#0072B2", "intense": "#D55E00"}
MARKERS = {"easy": "o", "hard": "^"}
INTENSITY_MAP = "inferno_r"

SIMULATED_WORDS = "SIMULATED DATA"

RC: dict[str, Any] = {
    "axes.axisbelow": True,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.labelsize": 8.0,
    "axes.linewidth": 0.6,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 8.5,
    "figure.constrained_layout.h_pad": 0.03,
    "figure.constrained_layout.w_pad": 0.03,
    "figure.facecolor": "white",
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "legend.fontsize": 7.0,
    "legend.frameon": False,
    "pdf.fonttype": 42,
    "savefig.dpi": 200,
    "svg.fonttype": "path",
    "svg.hashsalt": "studykit",
    "text.color": INK,
    "xtick.color": INK,
    "xtick.labelsize": 7.5,
    "xtick.major.width": 0.6,
    "ytick.color": INK,
    "ytick.labelsize": 7.5,
    "ytick.major.width": 0.6,
}


def in_style() -> AbstractContextManager[None]:
    """Draw in studykit's style inside a `with` block; matplotlib's own settings stay as they are."""
    import matplotlib as mpl

    return mpl.rc_context(RC)


def sheet(*, width_mm: float, height_mm: float, simulated: bool) -> PaperFigure:
    """Give an empty figure, marked when what it will show was simulated.

    Parameters
    ----------
    width_mm, height_mm : float
        Size on paper, mm.
    simulated : bool
        Whether any of the data come from simulated people or devices.
    """
    from studykit.figures.canvas import PaperFigure

    figure = PaperFigure(width_mm=width_mm, height_mm=height_mm)
    if simulated:
        mark_simulated(figure)
    return figure


def mark_simulated(figure: Figure) -> None:
    """Write "SIMULATED DATA" across the top of a figure, so that no copy of it can lose the words."""
    figure.suptitle(
        SIMULATED_WORDS,
        x=0.5,
        fontsize=7.0,
        fontweight="bold",
        color="#8a1c1c",
        gid="simulated-data",
    )


def rule(axes: Axes, *, along: str = "y") -> None:
    """Draw faint lines behind the data at the ticks of one axis."""
    axes.grid(visible=True, axis="x" if along == "x" else "y")
    axes.tick_params(length=2.0)


def label(condition: str) -> str:
    """Give a condition as words on two lines for an axis: its intensity, then its variety.

    Examples
    --------
    >>> label("light-easy-on")
    'Light\\nEasy'
    """
    intensity, variety, *_ = condition.split("-")
    return f"{intensity.capitalize()}\n{variety.capitalize()}"
