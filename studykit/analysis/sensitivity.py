"""Whether a result hangs on a choice that could have been made otherwise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from studykit.analysis.planned.comparison import compare
from studykit.analysis.results import TestResult
from studykit.protocol.analysis_plan import AnalysisPlan, TestPlan

if TYPE_CHECKING:
    import pandas as pd

DECLARED = "as declared"


@dataclass(frozen=True, kw_only=True, slots=True)
class Alternative:
    """One declared test, made with one choice made otherwise.

    Parameters
    ----------
    name : str
        The test, as the protocol calls it.
    outcome : str
        The column compared.
    choice : str
        What was chosen otherwise, in words; "as declared" for the test itself.
    participants : int
        People compared.
    chi_squared, p, kendalls_w : float or None
        Of Friedman's test, p of the kind declared; None if not computed.
    kendalls_w_interval : tuple of float or None
        Plausible values of W.
    significant_pairs : int
        Pairs whose corrected p lies below alpha.
    same_verdict : bool or None
        Whether test and pairs are as significant as declared ones; None if not computed.
    not_computed_because : str or None
        Why there are no numbers, if there are none.
    """

    name: str
    outcome: str
    choice: str
    participants: int
    chi_squared: float | None
    p: float | None
    kendalls_w: float | None
    kendalls_w_interval: tuple[float, float] | None
    significant_pairs: int
    same_verdict: bool | None
    not_computed_because: str | None


def sensitivity(
    plan: AnalysisPlan, declared: pd.DataFrame, others: Mapping[str, pd.DataFrame]
) -> tuple[Alternative, ...]:
    """Make every declared test again with each choice that concerns it.

    Parameters
    ----------
    plan : AnalysisPlan
        What was declared.
    declared : DataFrame
        The trials as the protocol wants them measured.
    others : mapping of str to DataFrame
        The same trials with one choice made otherwise, by what it is in words: measured in another way, or
        other trials valid.

    Returns
    -------
    tuple of Alternative
        Test by test, the declared one first. A choice that changes no value of a test is not listed.
    """
    return tuple(row for test in plan.tests for row in _of_test(test, plan.alpha, declared, others))


def _of_test(
    test: TestPlan, alpha: float, declared: pd.DataFrame, others: Mapping[str, pd.DataFrame]
) -> Iterator[Alternative]:
    own = compare(test, declared, alpha)
    yield _row(DECLARED, own, own)
    before = _entering(test, declared)
    for choice, trials in others.items():
        if not _entering(test, trials).equals(before):
            yield _row(choice, compare(test, trials, alpha), own)


def _entering(test: TestPlan, trials: pd.DataFrame) -> pd.DataFrame:
    """Give the values that a test looks at, in one order."""
    valid = trials[trials["is_valid"] & trials["condition"].isin(test.conditions)]
    columns = valid[["participant", "condition", test.outcome]].dropna()
    return columns.sort_values(["participant", "condition"]).reset_index(drop=True)


def _row(choice: str, found: TestResult, own: TestResult) -> Alternative:
    omnibus = found.friedman
    return Alternative(
        name=found.plan.name,
        outcome=found.plan.outcome,
        choice=choice,
        participants=found.participants,
        chi_squared=None if omnibus is None else omnibus.chi_squared,
        p=found.p,
        kendalls_w=None if omnibus is None else omnibus.kendalls_w,
        kendalls_w_interval=found.kendalls_w_interval,
        significant_pairs=sum(pair.is_significant for pair in found.pairs),
        same_verdict=None if omnibus is None else _verdict(found) == _verdict(own),
        not_computed_because=found.not_computed_because,
    )


def _verdict(found: TestResult) -> tuple[bool | None, tuple[tuple[bool, bool], ...]]:
    """Give what is significant, and in which direction."""
    return found.is_significant, tuple(
        (pair.is_significant, pair.is_significant and pair.test.rank_biserial > 0.0) for pair in found.pairs
    )
