"""Means, percentages and sums: what whole answers and whole people can give."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from studykit.analysis.consistency import attainable
from studykit.analysis.consistency.claims import Claim, Printed
from studykit.analysis.consistency.finding import Finding, finding, shown, span
from studykit.analysis.heart_rate import maximum
from studykit.core.errors import InputError

_VIGOROUS = 0.7
_MOST_TOTALS = 1000  # with more of them, some fits


def whole_answers(claim: Claim) -> Iterator[Finding]:
    """Test means and standard deviations of whole-number answers (GRIM and GRIMMER)."""
    if not (claim.has("mean", "n") and (claim.has("items") or claim.has("scale_first"))):
        return
    n, items, mean = claim.whole("n"), claim.whole("items", 1), claim.numbers["mean"]
    totals = attainable.whole_totals(mean.low, mean.high, n * items)
    nearest = np.array([math.floor(mean.value * n * items), math.ceil(mean.value * n * items)]) / (n * items)
    words = (
        f"{n} people and {items} item{'s' * (items > 1)} can have this mean"
        if totals
        else f"whole answers of {n} people to {items} item{'s' * (items > 1)} have no mean of {shown(mean)}; "
        f"the nearest are {nearest[0]:.4f} and {nearest[1]:.4f}"
    )
    yield finding("GRIM", claim, (), is_consistent=bool(totals), words=words)
    if claim.has("scale_first"):
        yield _within_scale(claim)
    if claim.has("sd") and n > 1 and totals:
        sd = claim.numbers["sd"]
        fits = any(attainable.whole_squares(t, n, items, (sd.low, sd.high)) for t in totals[:_MOST_TOTALS])
        words = f"whole answers {'can' if fits else 'cannot'} have this mean and SD = {shown(sd)}"
        yield finding("GRIMMER", claim, (), is_consistent=fits, words=words)


def _within_scale(claim: Claim) -> Finding:
    first, last = (claim.numbers[f"scale_{end}"].value for end in ("first", "second"))
    mean, n = claim.numbers["mean"], claim.whole("n")
    is_consistent = mean.high >= first and mean.low <= last
    words = f"a mean on this scale lies from {first:g} to {last:g}"
    if claim.has("sd") and n > 1 and is_consistent:
        # Bhatia & Davis (2000): answers at both ends of the scale spread most.
        nearest = min(max((first + last) / 2.0, mean.low), mean.high)
        most = math.sqrt(max(0.0, (last - nearest) * (nearest - first)) * n / (n - 1.0))
        is_consistent = claim.numbers["sd"].low <= most
        words += f", and the SD beside this mean is {most:.2f} at most"
    return finding("scale", claim, (first, last), is_consistent=is_consistent, words=words)


def percentages(claim: Claim) -> Iterator[Finding]:
    """Hold a percentage against the people, the scale or the seconds that it is a share of."""
    if not claim.has("percent"):
        return
    percent = claim.numbers["percent"]
    if claim.has("scale_first", "items"):
        yield _percent_of_scale(claim, percent)
    elif claim.has("seconds", "age", "rest", "tau"):
        yield _time_above(claim, percent)
    elif claim.has("count", "n"):
        count, n = claim.numbers["count"].value, claim.whole("n")
        share = 100.0 * count / n
        is_consistent = percent.allows(share, share) and count <= n
        words = f"{count:g} of {n} are {share:.2f} %"
        yield finding("percentage", claim, (share, share), is_consistent=is_consistent, words=words)
    elif claim.has("n"):
        n = claim.whole("n")
        counts = attainable.whole_totals(percent.low / 100.0, percent.high / 100.0, n)
        words = (
            f"{span(counts[0], counts[-1])} of {n} are {shown(percent)} %"
            if counts
            else f"no whole count of {n} is {shown(percent)} %"
        )
        yield finding("percentage", claim, (), is_consistent=bool(counts), words=words)


def _percent_of_scale(claim: Claim, percent: Printed) -> Finding:
    """Give the totals that a percentage of a questionnaire may mean."""
    items = claim.whole("items")
    low, high = (items * claim.numbers[f"scale_{end}"].value for end in ("first", "second"))
    of_maximum = percent.value / 100.0 * high
    of_range = low + percent.value / 100.0 * (high - low)
    return finding(
        "percentage of a scale",
        claim,
        (of_maximum, of_range),
        is_consistent=0.0 <= percent.value <= 100.0,
        words=f"{shown(percent)} % is a total of {of_maximum:.1f} as a share of the highest one ({high:g}), "
        f"but {of_range:.1f} as a share of the range from {low:g}; the claim must say which",
    )


def _time_above(claim: Claim, percent: Printed) -> Finding:
    """Ask which steady heart rate would cross the vigorous threshold early enough, rising exponentially."""
    seconds, age, rest, tau = (claim.numbers[name].value for name in ("seconds", "age", "rest", "tau"))
    if min(seconds, age, rest, tau) <= 0.0:
        raise InputError(
            "seconds, age, rest and tau must be above zero",
            where=claim.text,
            remedy='write "vigorous=74 % of 32 s, age=25, rest=80, tau=30"',
        )
    highest = maximum(age, "tanaka")
    threshold = _VIGOROUS * highest
    crossed_s = seconds * (1.0 - percent.high / 100.0)
    steady = rest + (threshold - rest) / -math.expm1(-crossed_s / tau) if crossed_s > 0.0 else math.inf
    return finding(
        "time above a threshold",
        claim,
        (steady,),
        is_consistent=steady <= highest,
        words=f"to spend {shown(percent)} % of {seconds:g} s above {threshold:.0f} beats/min, a heart that "
        f"starts at {rest:g} must cross it within {crossed_s:.1f} s and head for {steady:.0f}, "
        f"when {highest:.0f} is the highest that age {age:g} predicts (time constant {tau:g} s)",
    )


def sums(claim: Claim) -> Iterator[Finding]:
    """Add up again."""
    for parts, printed in claim.sums:
        total = printed
        low, high = sum(part.low for part in parts), sum(part.high for part in parts)
        if all(part.half >= 0.5 for part in parts):  # whole numbers in a sum are counts
            low = high = sum(part.value for part in parts)
            total = Printed(value=total.value)
        words = f"the parts add up to {span(low, high)}"
        yield finding("sum", claim, (low, high), is_consistent=total.allows(low, high), words=words)
