"""Make the tests that the protocol declares, and say what was left out and why."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from studykit.analysis import correlation, multiplicity, tables
from studykit.analysis.friedman import friedman, kendalls_w_interval
from studykit.analysis.results import (
    ConditionSummary,
    CorrelationResult,
    Exclusions,
    PairResult,
    Results,
    TestResult,
)
from studykit.analysis.wilcoxon import PValue, Zeros, rank_biserial_interval, wilcoxon
from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.core.seeding import stream
from studykit.protocol.analysis_plan import AnalysisPlan, CorrelationPlan, TestPlan

if TYPE_CHECKING:
    import pandas as pd

_NEEDED = ("participant", "session", "condition", "is_valid", "exclusion_reason", "simulated")
_CORRECTIONS: dict[str, Callable[[Sequence[float]], Floats]] = {
    "holm": multiplicity.holm,
    "bonferroni": multiplicity.bonferroni,
    "none": np.asarray,
}
# The variant that counts comes first; the others show that nothing hangs on the choice.
_VARIANTS: tuple[tuple[PValue, Zeros], ...] = (
    ("exact", "drop"),
    ("normal", "drop"),
    ("normal_continuity", "drop"),
    ("normal", "pratt"),
)


def run(plan: AnalysisPlan, trials: pd.DataFrame) -> Results:
    """Make every test and correlation that was declared before the study.

    Only valid trials count. A test compares the people who have a value in all of its conditions; a
    correlation uses the people with at least two.

    Parameters
    ----------
    plan : AnalysisPlan
        The tests declared.
    trials : pandas.DataFrame
        One row a trial, columns as in `tables.TRIALS` (those that the plan needs).

    Returns
    -------
    Results
        A test that cannot be made says why instead of giving numbers.

    Raises
    ------
    InputError
        If there are no trials, a column is missing or wrong, or somebody has two valid trials of a condition.
    """
    outcomes = [test.outcome for test in plan.tests]
    for declared in plan.correlations:
        outcomes += [*declared.x, declared.y]
    if not len(trials):
        raise InputError("there are no trials", where=tables.TRIALS.name, remedy="run a session first")
    tables.check(trials, tables.TRIALS, columns=dict.fromkeys((*_NEEDED, *outcomes)))
    valid = trials[trials["is_valid"]]
    _refuse_repeats(valid)
    return Results(
        alpha=plan.alpha,
        participants=int(trials["participant"].nunique()),
        trials=len(trials),
        valid_trials=len(valid),
        is_simulated=bool(trials["simulated"].any()),
        tests=tuple(_test(test, trials, plan.alpha) for test in plan.tests),
        correlations=tuple(_correlate(declared, trials, plan.alpha) for declared in plan.correlations),
    )


def _refuse_repeats(valid: pd.DataFrame) -> None:
    twice = valid[valid.duplicated(["participant", "condition"])]
    if len(twice):
        first = twice.iloc[0]
        raise InputError(
            f"participant {first['participant']} has two valid trials of {first['condition']}",
            where=tables.TRIALS.name,
            remedy="mark one of them as not valid, with a reason",
        )


def _values(trials: pd.DataFrame, conditions: Sequence[str], values: pd.Series[float]) -> pd.DataFrame:
    """Give the valid, finite values as a table of people and conditions; NaN where there is none."""
    usable = trials.assign(value=values)[trials["is_valid"] & trials["condition"].isin(conditions)]
    table = usable.pivot(index="participant", columns="condition", values="value")
    people = sorted(trials["participant"].unique())
    return table.reindex(index=people, columns=list(conditions)).astype("float64")


def _exclusions(
    trials: pd.DataFrame, conditions: Sequence[str], values: pd.DataFrame, kept: pd.DataFrame
) -> Exclusions:
    of_conditions = trials[trials["condition"].isin(conditions)]
    valid = of_conditions["is_valid"]
    reasons = of_conditions.loc[~valid, "exclusion_reason"].fillna("no reason given").value_counts()
    left_out = values.drop(index=kept.index)
    return Exclusions(
        trials=len(of_conditions),
        used=int(kept.notna().to_numpy().sum()),
        not_valid={str(reason): int(count) for reason, count in sorted(reasons.items())},
        without_value=int(valid.sum() - values.notna().to_numpy().sum()),
        participants_left_out={
            str(person): [name for name in values.columns if math.isnan(row[name])]
            for person, row in left_out.iterrows()
        },
    )


def _test(plan: TestPlan, trials: pd.DataFrame, alpha: float) -> TestResult:
    values = _values(trials, plan.conditions, trials[plan.outcome])
    complete = values.dropna()
    exclusions = _exclusions(trials, plan.conditions, values, complete)
    table = complete.to_numpy()
    problem = _why_not_compared(values, table)
    if problem:
        return TestResult(
            plan=plan, exclusions=exclusions, participants=len(table), not_computed_because=problem
        )
    omnibus = friedman(table)
    return TestResult(
        plan=plan,
        exclusions=exclusions,
        participants=len(table),
        friedman=omnibus,
        is_significant=omnibus.p < alpha,
        kendalls_w_interval=kendalls_w_interval(
            table, rng=stream(0, "kendalls_w_interval", plan.name), confidence=1.0 - alpha
        ),
        summaries=_summaries(plan.conditions, table, omnibus.mean_ranks),
        pairs=_pairs(plan, complete, alpha),
    )


def _why_not_compared(values: pd.DataFrame, table: Floats) -> str | None:
    """Say why conditions cannot be compared, or None if they can."""
    empty = [name for name in values.columns if values[name].isna().all()]
    if empty:
        return f"nobody has a value in {', '.join(empty)}"
    if len(table) < 2:
        people = "nobody has" if not len(table) else "only one participant has"
        return f"{people} a value in all conditions; at least two are needed"
    if np.all(table == table[:, :1]):
        return "every participant has the same value in all conditions"
    return None


def _summaries(
    conditions: Sequence[str], table: Floats, mean_ranks: Sequence[float]
) -> tuple[ConditionSummary, ...]:
    quartiles = np.quantile(table, [0.25, 0.5, 0.75], axis=0)
    return tuple(
        ConditionSummary(
            condition=name,
            mean=float(table[:, place].mean()),
            standard_deviation=float(table[:, place].std(ddof=1)),
            median=float(quartiles[1, place]),
            lower_quartile=float(quartiles[0, place]),
            upper_quartile=float(quartiles[2, place]),
            mean_rank=mean_ranks[place],
        )
        for place, name in enumerate(conditions)
    )


def _pairs(plan: TestPlan, complete: pd.DataFrame, alpha: float) -> tuple[PairResult, ...]:
    pairs = plan.pairs_list()
    column = {name: complete[name].to_numpy() for name in plan.conditions}
    variants = [
        [wilcoxon(column[a], column[b], p=p, zeros=zeros) for p, zeros in _VARIANTS] for a, b in pairs
    ]
    corrected = _CORRECTIONS[plan.correction]([tests[0].p for tests in variants])
    return tuple(
        PairResult(
            a=a,
            b=b,
            median_difference=float(np.median(column[a] - column[b])),
            test=test,
            p_corrected=float(p),
            is_significant=bool(p < alpha),
            rank_biserial_interval=rank_biserial_interval(
                test.rank_biserial, test.n_nonzero, confidence=1.0 - alpha
            ),
            p_by_variant={other.variant: other.p for other in others},
        )
        for (a, b), (test, *others), p in zip(pairs, variants, corrected, strict=True)
    )


def _correlate(plan: CorrelationPlan, trials: pd.DataFrame, alpha: float) -> CorrelationResult:
    across = _values(trials, plan.conditions, trials[list(plan.x)].sum(axis=1, skipna=False))
    up = _values(trials, plan.conditions, trials[plan.y])
    both = across.notna() & up.notna()
    kept = both.sum(axis=1) >= 2
    across, up, both = across.where(both), up.where(both), both[kept]
    exclusions = _exclusions(trials, plan.conditions, up, up[kept])
    x, y = across[kept].to_numpy()[both.to_numpy()], up[kept].to_numpy()[both.to_numpy()]
    people = np.repeat(both.index.to_numpy(), both.sum(axis=1))
    distinct = len(np.unique(x))
    if not len(x):
        return CorrelationResult(
            plan=plan,
            exclusions=exclusions,
            distinct_x=distinct,
            not_computed_because="nobody has values in two conditions or more",
        )
    try:
        within = correlation.repeated_measures(people.tolist(), x, y, confidence=1.0 - alpha)
        pooled = correlation.pearson(x, y, confidence=1.0 - alpha)
    except ValueError as problem:
        return CorrelationResult(
            plan=plan, exclusions=exclusions, distinct_x=distinct, not_computed_because=str(problem)
        )
    return CorrelationResult(
        plan=plan, exclusions=exclusions, distinct_x=distinct, repeated_measures=within, pooled=pooled
    )
