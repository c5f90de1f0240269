"""Whether a result hangs on a choice that could have been made otherwise."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from studykit.analysis.planned.comparison import compare
from studykit.analysis.results import PairResult, TestResult
from studykit.protocol.analysis_plan import AnalysisPlan, TestPlan

if TYPE_CHECKING:
    import pandas as pd

DECLARED = "as declared"
_TRIAL = ["participant", "session", "condition", "repetition"]


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
    other_verdicts : tuple of str
        Pairs, as "a - b", that are significant in another way than declared.
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
    other_verdicts: tuple[str, ...]
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
        other_verdicts=tuple(
            f"{a.a} - {a.b}" for a, b in zip(found.pairs, own.pairs, strict=False) if _of(a) != _of(b)
        ),
        not_computed_because=found.not_computed_because,
    )


def _verdict(found: TestResult) -> tuple[bool | None, tuple[tuple[bool, bool], ...]]:
    """Give what is significant, and in which direction."""
    return found.is_significant, tuple(map(_of, found.pairs))


def _of(pair: PairResult) -> tuple[bool, bool]:
    return pair.is_significant, pair.is_significant and pair.test.rank_biserial > 0.0


def without_effect(rows: Iterable[Alternative], others: Iterable[str]) -> tuple[str, ...]:
    """Name the choices that were tried and changed no value of any declared test.

    Parameters
    ----------
    rows : iterable of Alternative
        What `sensitivity` gave.
    others : iterable of str
        All choices.
    """
    changing = {row.choice for row in rows}
    return tuple(choice for choice in others if choice not in changing)


@dataclass(frozen=True, kw_only=True, slots=True)
class VigorousTime:
    """For how long people danced vigorously, under one choice of what vigorous is and when it counts.

    Parameters
    ----------
    choice : str
        What was chosen otherwise, in words; "as declared" for the measure itself.
    condition : str
        Of the trials.
    n : int
        Valid trials with a value.
    mean : float
        Share of the window, 0 to 1.
    """

    choice: str
    condition: str
    n: int
    mean: float


RESERVE = "at or above 60 % of the heart-rate reserve"


def vigorous_times(
    conditions: Iterable[str], declared: pd.DataFrame, others: Mapping[str, pd.DataFrame]
) -> tuple[VigorousTime, ...]:
    """Give the time at vigorous intensity under each choice that changes it.

    Parameters
    ----------
    conditions : iterable of str
        In the order wanted.
    declared : DataFrame
        The trials as the protocol wants them measured.
    others : mapping of str to DataFrame
        As for `sensitivity`.

    Returns
    -------
    tuple of VigorousTime
        Choice by choice, the declared one first, then the share at or above 60 % of the heart-rate reserve.
    """
    whole = declared[declared["is_valid"]]
    measured = {DECLARED: whole.set_index(_TRIAL)["vigorous_fraction"]}
    if whole["vigorous_fraction_reserve"].notna().any():
        measured[RESERVE] = whole.set_index(_TRIAL)["vigorous_fraction_reserve"]
    for choice, trials in others.items():
        values = trials[trials["is_valid"]].set_index(_TRIAL)["vigorous_fraction"]
        if not values.equals(measured[DECLARED]):
            measured[choice] = values
    return tuple(
        VigorousTime(choice=choice, condition=name, n=len(some), mean=float(some.mean()))
        for choice, values in measured.items()
        for name in conditions
        if len(some := values[values.index.get_level_values("condition") == name].dropna())
    )
