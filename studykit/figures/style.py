"""How every figure looks: sizes, colours, words, and the mark of simulated data."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from studykit.choreography.dance import Dance
    from studykit.figures.canvas import PaperFigure

MM_PER_INCH = 25.4
COLUMN_MM = 88.0
"""Width of a figure in one column of a journal."""
PAGE_MM = 180.0
"""Width of a figure across a page."""

INK = "#222222"
FAINT = "#8a8a8a"
GRID = "#e4e4e4"
WARNING = "#8a1c1c"
# The pair of Okabe and Ito's palette that every common kind of colour vision tells apart, also in grey.
INTENSITY = {"light": "#0072B2", "intense": "#D55E00"}
MARKERS = {"easy": "o", "hard": "^"}
INTENSITY_MAP = "inferno_r"
BODY = "#4a4a4a"
SPARED = "#009E73"
"""Joints that a dance spares; not a colour of the map of intensities."""
TINTS = ("#9fd3f2", "#f3cf80", "#e3b6d0", "#8fd0b9", "#f5ee9a", "#8ab6d6", "#eeb68a")
"""Okabe and Ito's palette, pale enough to write on."""

SERIES: tuple[tuple[str, str, Any], ...] = (
    ("#0072B2", "o", "-"),
    ("#D55E00", "D", (0, (5, 1.5))),
    ("#009E73", "s", (0, (1, 1))),
    ("#CC79A7", "^", (0, (5, 1, 1, 1))),
    ("#222222", "v", (0, (8, 2))),
)
"""Colour, marker and dashes of lines that stand beside each other: no two share any of the three."""

SIMULATED = "SIMULATED DATA"
SYNTHETIC = "SYNTHETIC MOVEMENT"

RC: Any = {
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
    "text.hinting": "none",  # hinted letters are wider at some sizes, and would leave the sheet
    "text.parse_math": False,  # a dollar in the question of a protocol is a dollar
    "xtick.color": INK,
    "xtick.labelsize": 7.5,
    "xtick.major.width": 0.6,
    "ytick.color": INK,
    "ytick.labelsize": 7.5,
    "ytick.major.width": 0.6,
}


def in_style() -> AbstractContextManager[None]:
    """Draw in studykit's style inside a `with` block; the reader's settings neither matter nor change."""
    from matplotlib import style

    return style.context(["default", RC])


def sheet(*, width_mm: float, height_mm: float, simulated: bool, synthetic: bool = False) -> PaperFigure:
    """Give an empty figure, marked when what it will show was simulated.

    Parameters
    ----------
    width_mm, height_mm : float
        Size on paper, mm.
    simulated : bool
        Whether any of the data come from simulated people or devices.
    synthetic : bool, optional
        Whether any of the dances was made up rather than danced by a person.
    """
    from studykit.figures.canvas import PaperFigure

    figure = PaperFigure(width_mm=width_mm, height_mm=height_mm)
    marks = ((SIMULATED, simulated), (SYNTHETIC, synthetic))
    figure.marks = tuple(words for words, is_meant in marks if is_meant)
    if figure.marks:
        figure.suptitle(" · ".join(figure.marks), fontsize=7.0, fontweight="bold", color=WARNING, gid="mark")
    return figure


def rule(axes: Axes, *, at: Literal["x", "y"] = "y") -> None:
    """Draw faint lines behind the data at the ticks of one axis."""
    axes.grid(visible=True, axis=at)
    axes.tick_params(length=2.0)


def words(condition: str, *, between: str = " – ") -> str:
    """Give the intensity and the variety of a condition as words.

    Examples
    --------
    >>> words("light-easy-on")
    'Light – Easy'
    """
    return between.join(part.capitalize() for part in condition.split("-")[:2])


_SCHEDULES = {"hiit": "HIIT", "warm-up": "Warm-up"}
"""Names of schedules that are no levels."""


def title(dance: Dance) -> str:
    """Name a dance: its condition in words, and what it spares."""
    from studykit.figures.body import topmost

    name, _, transition = dance.condition.rpartition("-")
    if name and transition in ("on", "off"):
        words = _SCHEDULES.get(name) or " – ".join(part.capitalize() for part in name.split("-"))
        name = f"{words}, transition {transition}"
    else:
        name = dance.condition
    if dance.mask is None:
        return name
    return f"{name}, sparing {' and '.join(topmost(dance.mask.spared))}"


def colour(condition: str) -> str:
    """Give the colour of a condition: that of its intensity."""
    return INTENSITY.get(condition.split("-", maxsplit=1)[0], INK)


def marker(condition: str) -> str:
    """Give the marker of a condition: that of its variety."""
    return MARKERS.get(condition.split("-")[1], "o")
