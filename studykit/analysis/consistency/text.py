"""Whether published numbers can be true together: each checked against the others of its claim."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from studykit.analysis.consistency.answers import percentages, sums, whole_answers
from studykit.analysis.consistency.claims import Claim, claims
from studykit.analysis.consistency.finding import Finding, finding
from studykit.analysis.consistency.p_values import correlations, p_of_statistics, range_of_p
from studykit.analysis.consistency.ranks import friedman, signed_ranks, smallest_p
from studykit.core.errors import InputError


def check_text(text: str) -> list[Finding]:
    """Check every claim of a text: p, effect sizes, means and counts against each other.

    Every printed number stands for all values that would be rounded to it, so what can be explained by
    rounding is never called wrong.

    Parameters
    ----------
    text : str
        Claims separated by ";" or line ends, such as "chi2(3)=30.00, p<.001, W=0.50, n=20".

    Raises
    ------
    InputError
        If something cannot be read, or a claim holds nothing that can be checked against anything.

    Examples
    --------
    >>> [finding.is_consistent for finding in check_text("chi2(3)=30.00, W=0.50, n=20")]
    [True, True]
    >>> print(check_text("t(19)=2.10, p=.001")[0].words)
    t(19) = 2.10 gives p = .049 to .050, not .001
    """
    found: list[Finding] = []
    seen: dict[tuple[float, tuple[float, ...]], str] = {}
    for claim in claims(text):
        own = [finding for rule in _RULES for finding in rule(claim)]
        if not own:
            raise InputError(
                "nothing in it can be held against anything else",
                where=claim.text,
                remedy='add what belongs to it, as in "chi2(3)=30.00, p<.001, W=0.50, n=20"',
            )
        found += own
        if repeated := _repeated(claim, seen):
            found.append(repeated)
    return found


def _repeated(claim: Claim, seen: dict[tuple[float, tuple[float, ...]], str]) -> Finding | None:
    """Tell of a chi-squared that an earlier claim has too; it may be a copy, or chance."""
    chi2, name = claim.numbers.get("chi2"), claim.text.partition(":")[0]
    if chi2 is None or claim.has("separated_first"):
        return None
    before = seen.setdefault((chi2.value, chi2.df), name)
    if before == name:
        return None
    words = f'also that of "{before}": two outcomes seldom share one, so it may have been copied'
    return finding("repeated chi2", claim, (), is_consistent=True, words=words)


_RULES: tuple[Callable[[Claim], Iterator[Finding]], ...] = (
    range_of_p,
    p_of_statistics,
    correlations,
    friedman,
    signed_ranks,
    smallest_p,
    whole_answers,
    percentages,
    sums,
)
