"""Pages that need nothing else: filled from templates, figures within."""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import resources
from typing import TYPE_CHECKING, Any

from studykit.core.errors import InputError
from studykit.figures.style import MM_PER_INCH
from studykit.reports import numbers

if TYPE_CHECKING:
    from studykit.figures.canvas import PaperFigure

_FILTERS = ("number", "percent")


@dataclass(frozen=True, kw_only=True, slots=True)
class Picture:
    """A figure of a page, or why it could not be drawn."""

    title: str
    caption: str
    image: str = ""
    width_mm: float = 0.0
    problem: str = ""


def filled(template: str, *, filters: Mapping[str, Callable[..., Any]] | None = None, **values: Any) -> str:
    """Fill a template of this room; whatever a value says is shown as text, never as HTML.

    Parameters
    ----------
    template : str
        Its file name.
    filters : mapping of str to callable, optional
        Beside those of `numbers`.
    **values
        What it asks for; nothing may be missing.
    """
    import jinja2

    folder = resources.files("studykit.reports")
    environment = jinja2.Environment(
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        loader=jinja2.FunctionLoader(lambda name: folder.joinpath(name).read_text(encoding="utf-8")),
    )
    environment.filters |= {name: getattr(numbers, name) for name in _FILTERS} | dict(filters or {})
    return environment.get_template(template).render(values)


def embedded(svg: bytes) -> str:
    """Give the bytes of a drawing as the address of an image within a page."""
    return f"data:image/svg+xml;base64,{base64.b64encode(svg).decode()}"


def width_mm(figure: PaperFigure) -> float:
    """Give how wide a figure is."""
    return float(MM_PER_INCH * figure.get_figwidth())


def picture(title: str, draw: Callable[[], PaperFigure], caption: str) -> Picture:
    """Draw a figure for a page; what keeps it from being drawn is told in its place."""
    try:
        figure = draw()
    except InputError as error:
        return Picture(title=title, caption=caption, problem=str(error))
    image = embedded(figure.file_bytes("svg"))
    return Picture(title=title, caption=caption, image=image, width_mm=width_mm(figure))
