"""What came of holding one printed number against others."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from studykit.analysis.consistency.claims import Claim, Printed


@dataclass(frozen=True, kw_only=True, slots=True)
class Finding:
    """One number held against others.

    Parameters
    ----------
    kind : str
        What was checked, such as "p against chi2" or "GRIM".
    claim : str
        The claim, as it was given.
    recomputed : tuple of float
        Lowest and highest value that the other numbers leave possible; empty if it is no single interval.
    is_consistent : bool
        Whether the number can be right.
    words : str
        What was found, for a reader.
    """

    kind: str
    claim: str
    recomputed: tuple[float, ...]
    is_consistent: bool
    words: str


def finding(
    kind: str, claim: Claim, recomputed: tuple[float, ...], *, is_consistent: bool, words: str
) -> Finding:
    """Tell what was found about a claim."""
    return Finding(
        kind=kind, claim=claim.text, recomputed=recomputed, is_consistent=is_consistent, words=words
    )


def p_digits(p: float) -> str:
    """Write a p with two digits that count.

    Examples
    --------
    >>> p_digits(0.0494), p_digits(0.00977), p_digits(1.4e-6)
    ('.049', '.0098', '1.4e-06')
    """
    return f"{p:.{3 if p >= 0.01 else 4}f}".removeprefix("0") if p >= 0.001 else f"{p:.2g}"


def span(low: float, high: float, show: Callable[[float], str] = "{:.4g}".format) -> str:
    """Write an interval, or one number if its ends read the same."""
    return show(low) if show(low) == show(high) else f"{show(low)} to {show(high)}"


def shown(number: Printed) -> str:
    """Write a number with the digits that it was printed with."""
    decimals = max(0, round(-math.log10(2.0 * number.half))) if number.half else 0
    return f"{number.value:.{decimals}f}"


def printed_p(p: Printed) -> str:
    """Write a p as it was printed."""
    return f"{p.relation} {shown(p).removeprefix('0')}".removeprefix("= ")
