"""p against the statistic that it belongs to."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

import numpy as np

from studykit.analysis.consistency.claims import Claim, Printed
from studykit.analysis.consistency.finding import Finding, finding, p_digits, printed_p, shown, span
from studykit.core.arrays import Floats, Integers
from studykit.core.errors import InputError

_MOST_POINTS = 10_000


def _p_finding(claim: Claim, statistic: str, ends: tuple[float, float]) -> Finding:
    """Hold the printed p against the p values that a statistic leaves possible."""
    p, (low, high) = claim.numbers["p"], sorted(ends)
    is_consistent = p.allows(low, high)
    verdict = "as printed" if is_consistent else f"not {printed_p(p)}"
    name = re.split(r"[( ]", statistic, maxsplit=1)[0]
    return finding(
        f"p against {name}",
        claim,
        (low, high),
        is_consistent=is_consistent,
        words=f"{statistic} gives p = {span(low, high, p_digits)}, {verdict}",
    )


def degrees(claim: Claim, name: str, count: int) -> tuple[float, ...]:
    """Give the degrees of freedom of a statistic.

    Raises
    ------
    InputError
        If they are not there, or not as many as it has.
    """
    df = claim.numbers[name].df
    if len(df) != count or min(df) <= 0:
        example = {"f": "F(3, 57)=4.20", "chi2": "chi2(3)=30.00"}.get(name, f"{name}(19)=2.10")
        raise InputError(
            f"the degrees of freedom of {name} are missing or wrong",
            where=claim.text,
            remedy=f'write them in parentheses, as in "{example}"',
        )
    return df


def sides(claim: Claim) -> float:
    """Give by how much the chance in one tail is multiplied."""
    return 1.0 if "one-sided" in claim.words else 2.0


def _away(number: Printed) -> tuple[float, float]:
    """Give how far from zero a rounded number lies at least and at most."""
    ends = sorted((abs(number.low), abs(number.high)))
    return (0.0 if number.low <= 0.0 <= number.high else ends[0]), ends[1]


def p_of_statistics(claim: Claim) -> Iterator[Finding]:
    """Hold p against chi-squared, F, t and z; a p called exact is none of their distributions."""
    from scipy import stats

    if not claim.has("p") or "exact" in claim.words:
        return
    if claim.has("chi2"):
        (df,) = degrees(claim, "chi2", 1)
        number = claim.numbers["chi2"]
        low, high = (float(stats.chi2.sf(max(0.0, x), df)) for x in (number.high, number.low))
        yield _p_finding(claim, f"chi2({df:g}) = {shown(number)}", (low, high))
    if claim.has("f"):
        above, below = degrees(claim, "f", 2)
        number = claim.numbers["f"]
        low, high = (float(stats.f.sf(max(0.0, x), above, below)) for x in (number.high, number.low))
        yield _p_finding(claim, f"F({above:g}, {below:g}) = {shown(number)}", (low, high))
    if claim.has("t"):
        number = claim.numbers["t"]
        if not number.df and claim.has("n"):
            df = claim.whole("n") - 1.0
        else:
            (df,) = degrees(claim, "t", 1)
        near, far = _away(number)
        ends = (sides(claim) * float(stats.t.sf(far, df)), sides(claim) * float(stats.t.sf(near, df)))
        yield _p_finding(claim, f"t({df:g}) = {shown(number)}", ends)
    if claim.has("z"):
        near, far = _away(claim.numbers["z"])
        ends = (sides(claim) * float(stats.norm.sf(far)), sides(claim) * float(stats.norm.sf(near)))
        yield _p_finding(claim, f"z = {shown(claim.numbers['z'])}", ends)


def _correlation_p(r: float, n: float | Integers, sides: float) -> Floats:
    from scipy import stats

    inside = min(abs(r), 1.0 - 1e-15)
    degrees = np.asarray(n, dtype=float) - 2.0
    return np.asarray(sides * stats.t.sf(inside * np.sqrt(degrees / (1.0 - inside**2)), degrees))


def correlations(claim: Claim) -> Iterator[Finding]:
    """Hold a correlation against p and the number of points, or an effect size against z."""
    if not claim.has("r"):
        return
    r = claim.numbers["r"]
    if abs(r.value) > 1.0:
        words = f"r = {shown(r)} lies beyond 1"
        yield finding("r", claim, (-1.0, 1.0), is_consistent=False, words=words)
        return
    if claim.has("z", "n"):
        yield _effect_of_z(claim)
    elif claim.has("p") and not claim.has("v") and "exact" not in claim.words:
        near, far = _away(r)
        if r.df or claim.has("n"):
            n = r.df[0] + 2.0 if r.df else float(claim.whole("n"))
            if n < 3:
                raise InputError("r needs three points or more", where=claim.text, remedy="give a larger n")
            ends = tuple(float(_correlation_p(x, n, sides(claim))) for x in (far, near))
            yield _p_finding(claim, f"r = {shown(r)} of n = {n:g} points", (ends[0], ends[1]))
            if r.df and claim.has("n"):
                fits = r.df[0] == claim.whole("n") - 2
                words = f"{claim.whole('n')} points leave {claim.whole('n') - 2} degrees of freedom"
                yield finding("degrees of freedom", claim, (), is_consistent=fits, words=words)
        else:
            yield _points_for(claim, near, far)


def _points_for(claim: Claim, near: float, far: float) -> Finding:
    """Ask which number of points would give r and p together."""
    p, n = claim.numbers["p"], np.arange(3, _MOST_POINTS + 1)
    low, high = (_correlation_p(x, n, sides(claim)) for x in (far, near))
    fits = n[[p.allows(a, b) for a, b in zip(low.tolist(), high.tolist(), strict=True)]]
    told = f"r = {shown(claim.numbers['r'])}"
    if len(fits):
        most = "or more" if fits[-1] == _MOST_POINTS else f"to {fits[-1]}"
        words = f"{told} with p {p.relation} {shown(p).removeprefix('0')} needs {fits[0]} {most} points"
        return finding("r", claim, (float(fits[0]), float(fits[-1])), is_consistent=True, words=words)
    above = max(1, int(np.argmax(low < p.value)))
    beside = ", ".join(f"n = {n[i]} gives {p_digits((low[i] + high[i]) / 2)}" for i in (above - 1, above))
    words = f"{told} gives p = {p_digits(p.value)} with no number of points: {beside}"
    return finding("r", claim, (), is_consistent=False, words=words)


def _effect_of_z(claim: Claim) -> Finding:
    """Hold r = z / sqrt(n) against z and n; some count both values of each person."""
    near, far = _away(claim.numbers["z"])
    n, r = claim.whole("n"), claim.numbers["r"]
    size = Printed(value=abs(r.value), half=r.half)
    readings = [(near / math.sqrt(count), far / math.sqrt(count)) for count in (n, 2 * n)]
    is_consistent = any(size.allows(low, high) for low, high in readings)
    words = " or ".join(span(low, high, "{:.3f}".format) for low, high in readings)
    return finding(
        "r against z",
        claim,
        (),
        is_consistent=is_consistent,
        words=f"z / sqrt(n) is {words} (n people or 2n values){'' if is_consistent else f', not {shown(r)}'}",
    )


def range_of_p(claim: Claim) -> Iterator[Finding]:
    """Refuse a p outside 0 to 1."""
    if claim.has("p") and not 0.0 <= claim.numbers["p"].value <= 1.0:
        yield finding("p", claim, (0.0, 1.0), is_consistent=False, words="p lies from 0 to 1")
