"""Friedman and Wilcoxon: effect sizes against statistics, and what ranks can give at all."""

from __future__ import annotations

import math
from collections.abc import Iterator

from studykit.analysis.consistency import attainable
from studykit.analysis.consistency.claims import Claim, Printed
from studykit.analysis.consistency.finding import Finding, finding, p_digits, printed_p, shown, span
from studykit.analysis.consistency.p_values import degrees, sides
from studykit.core.errors import InputError

_MOST_PEOPLE = 10_000
_MOST_EXACT = 500


def friedman(claim: Claim) -> Iterator[Finding]:
    """Hold Kendall's W = chi2 / (n (k - 1)) and the grid of rank sums against chi-squared."""
    is_kendall = claim.has("chi2", "w")
    if not claim.has("chi2") or not (is_kendall or "friedman" in claim.words):
        return
    (df,) = degrees(claim, "chi2", 1)
    chi2 = claim.numbers["chi2"]
    if is_kendall:
        yield _kendall(claim, chi2, df)
    if not claim.has("n"):
        return
    n, k = claim.whole("n"), round(df) + 1
    if chi2.low > n * df:
        words = f"chi2 of {n} people and {k} conditions is {n * df:g} at most"
        yield finding("rank table", claim, (0.0, n * df), is_consistent=False, words=words)
        return
    if claim.has("separated_first"):
        yield _separated(claim, n, k)
    fits = attainable.friedman_without_ties(n, k, max(0.0, chi2.low), chi2.high)
    words = (
        f"ranks of {n} people and {k} conditions can give it"
        if fits
        else f"no ranks of {n} people and {k} conditions give it without ties"
    )
    yield finding("rank table", claim, (), is_consistent=fits or "no ties" not in claim.words, words=words)


def _kendall(claim: Claim, chi2: Printed, df: float) -> Finding:
    w = claim.numbers["w"]
    if claim.has("n"):
        n = claim.whole("n")
        low, high = max(0.0, chi2.low) / (n * df), chi2.high / (n * df)
        is_consistent = w.allows(low, high) and low <= 1.0
        return finding(
            "W against chi2",
            claim,
            (low, high),
            is_consistent=is_consistent,
            words=f"W = chi2 / (n (k - 1)) = {span(low, high, '{:.3f}'.format)}, "
            f"{'as printed' if is_consistent else f'not {shown(w)}'}",
        )
    if w.high <= 0.0:
        return finding("W against chi2", claim, (), is_consistent=chi2.low <= 0.0, words="W is zero")
    first = math.ceil(max(1.0, chi2.low / (df * w.high) - 1e-9))
    last = math.floor(chi2.high / (df * w.low) + 1e-9) if w.low > 0.0 else _MOST_PEOPLE
    fits = first <= last
    words = f"they fit n = {span(first, last)} people" if fits else "they fit no whole number of people"
    return finding("W against chi2", claim, (first, last) if fits else (), is_consistent=fits, words=words)


def _separated(claim: Claim, n: int, k: int) -> Finding:
    first, second = claim.whole("separated_first"), claim.whole("separated_second")
    if first + second != k:
        raise InputError(
            f"{first} and {second} conditions are not the {k} of chi2",
            where=claim.text,
            remedy="count the conditions again",
        )
    least = attainable.separated_chi_squared(n, first, second)
    chi2 = claim.numbers["chi2"]
    words = f"with {second} conditions above the other {first} in all {n} people, chi2 is {least:g} or more"
    return finding("separation", claim, (least, n * (k - 1.0)), is_consistent=chi2.high >= least, words=words)


def signed_ranks(claim: Claim) -> Iterator[Finding]:
    """Hold a sum of signed ranks against n and p; a W of at most 1 is Kendall's unless Wilcoxon is named."""
    name = "v" if claim.has("v") else "w"
    if not claim.has(name) or (name == "w" and claim.has("chi2")):
        return
    if name == "w" and claim.numbers["w"].value <= 1.0 and "wilcoxon" not in claim.words:
        return
    if not claim.has("n"):
        raise InputError("a sum of signed ranks needs n", where=claim.text, remedy="add n, as in V=40, n=9")
    n, v = claim.whole("n"), claim.numbers[name].value
    most = n * (n + 1) / 2.0
    if not 0.0 <= v <= most:
        words = f"the signed ranks of {n} people add up to {most:g} at most"
        yield finding("signed ranks", claim, (0.0, most), is_consistent=False, words=words)
    elif claim.has("p"):
        yield _signed_ranks_p(claim, n, v)


def _signed_ranks_p(claim: Claim, n: int, v: float) -> Finding:
    halves = sides(claim) / 2.0
    readings = {
        "normal": attainable.signed_rank_normal_p(v, n, continuity=False),
        "normal with continuity correction": attainable.signed_rank_normal_p(v, n, continuity=True),
    }
    if n <= _MOST_EXACT:  # further out the normal distribution is as good
        exact = [attainable.signed_rank_p(x, n) for x in (math.floor(v), math.ceil(v))]
        readings = {"exact": exact[0]} | ({"exact, upper": exact[1]} if v != int(v) else {}) | readings
    p = claim.numbers["p"]
    found = {way: halves * value for way, value in readings.items()}
    fitting = [way for way, value in found.items() if p.allows(value, value)]
    told = ", ".join(f"{way} {p_digits(value)}" for way, value in found.items())
    verdict = f"fits ({', '.join(fitting)})" if fitting else "fits none"
    return finding(
        "p against signed ranks",
        claim,
        (min(found.values()), max(found.values())),
        is_consistent=bool(fitting),
        words=f"a sum of {v:g} of {n} people gives p: {told}; the printed {printed_p(p)} {verdict}",
    )


def smallest_p(claim: Claim) -> Iterator[Finding]:
    """Hold p of an exact signed-rank test against its grid: multiples of 2 / 2^n, times the pairs."""
    if not (claim.has("p", "n") and ("wilcoxon" in claim.words or claim.has("pairs"))):
        return
    if claim.has("v") or claim.has("w") or claim.has("z"):
        return
    n, p = claim.whole("n"), claim.numbers["p"]
    pairs = claim.whole("pairs", 1) if claim.words & {"bonferroni", "holm"} else 1
    step = min(1.0, pairs * sides(claim) * 0.5 ** min(n, _MOST_EXACT))
    if p.relation in "<≤":
        is_consistent = p.allows(step, step)
        against = (
            attainable.most_against(n, 2.0 * p.value / (pairs * sides(claim))) if n <= _MOST_EXACT else None
        )
        words = f"the smallest p that {n} people can give is {p_digits(step)}"
        if is_consistent and against is not None:
            words += f"; at most {against} of {n} may differ the other way"
    else:
        multiple = max(1.0, math.ceil(p.low / step - 1e-9)) * step
        is_consistent = multiple <= max(p.high, 0.0) + 1e-12 or p.relation in ">≥"
        words = f"p of {n} people comes in steps of {p_digits(step)}"
    yield finding("smallest p", claim, (step, 1.0), is_consistent=is_consistent, words=words)
