"""How numbers are written in a report."""

from __future__ import annotations

import math
from collections.abc import Iterable

MISSING = "–"
_MINUS = "\N{MINUS SIGN}"


def number(value: float | None, decimals: int = 2) -> str:
    """Write a number with a fixed count of decimals.

    Examples
    --------
    >>> number(104.237, 1), number(None)
    ('104.2', '–')
    """
    if value is None or not math.isfinite(value):
        return MISSING
    text = f"{value:.{decimals}f}"
    return text.replace("-", _MINUS) if float(text) else text.lstrip("-")


def percent(share: float | None, decimals: int = 1) -> str:
    """Write a share as a percentage.

    Examples
    --------
    >>> percent(0.6617)
    '66.2 %'
    """
    text = number(None if share is None else 100.0 * share, decimals)
    return text if text == MISSING else f"{text} %"


def bounded(value: float | None, decimals: int = 2) -> str:
    """Write a number that cannot exceed 1, such as a correlation, without the zero before the point.

    Examples
    --------
    >>> bounded(0.883), bounded(-1.0)
    ('.88', '−1.00')
    """
    text = number(value, decimals)
    return text.replace("0.", ".", 1) if text.lstrip(_MINUS).startswith("0.") else text


def p_value(p: float | None) -> str:
    """Write a p value, with its sign.

    Examples
    --------
    >>> p_value(0.0316), p_value(0.00004)
    ('= .032', '< .001')
    """
    if p is None or not math.isfinite(p):
        return MISSING
    return "< .001" if p < 0.001 else f"= {bounded(p, 3)}"


def p_cell(p: float | None) -> str:
    """Write a p value for a table: without the equals sign."""
    return p_value(p).removeprefix("= ")


def interval(ends: Iterable[float] | None, decimals: int = 2) -> str:
    """Write an interval of a number that cannot exceed 1.

    Examples
    --------
    >>> interval((-0.897, 0.427))
    '[−.90, .43]'
    """
    return MISSING if ends is None else f"[{', '.join(bounded(end, decimals) for end in ends)}]"


def decimals_for(spread: float) -> int:
    """Tell how many decimals a mean deserves: those that show two digits of its standard deviation.

    Examples
    --------
    >>> decimals_for(5.3), decimals_for(0.026)
    (1, 3)
    """
    if not math.isfinite(spread) or spread <= 0.0:
        return 2
    return min(6, max(0, 1 - math.floor(math.log10(spread))))


def limits(ends: Iterable[float] | None, decimals: int = 2) -> str:
    """Write an interval of a number that may have any size.

    Examples
    --------
    >>> limits((-1.561, 2.3), 1)
    '[−1.6, 2.3]'
    """
    return MISSING if ends is None else f"[{', '.join(number(end, decimals) for end in ends)}]"


def times(factor: float | None) -> str:
    """Write how many times better one thing is than another: three digits, and no more than can be believed.

    Examples
    --------
    >>> times(2.6787), times(41.23), times(0.26), times(3.1e9), times(1e-5)
    ('2.68', '41.2', '0.260', '> 1000', '< 0.001')
    """
    if factor is None or not math.isfinite(factor):
        return MISSING if factor is None or math.isnan(factor) else "> 1000"
    if factor > 1000.0:
        return "> 1000"
    if factor < 0.001:
        return "< 0.001"
    return f"{factor:#.3g}".rstrip(".")


def anything(value: object) -> str:
    """Write whatever a result holds: numbers with four digits that count, lists in brackets.

    Examples
    --------
    >>> anything(0.012346), anything(20251.4), anything((1, None)), anything(True)
    ('0.01235', '20251', '[1, –]', 'yes')
    """
    if value is None:
        return MISSING
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        digits = ".0f" if 1e4 <= abs(value) < 1e9 else ".4g"
        return f"{value:{digits}}".replace("-", _MINUS) if math.isfinite(value) else MISSING
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(anything, value))}]" if value else MISSING
    return str(value)
