"""Whether a study's own results agree with each other and with its trials, each number found again."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.analysis.consistency import attainable
from studykit.analysis.consistency.finding import Finding
from studykit.core.arrays import Floats

if TYPE_CHECKING:
    import pandas as pd

Values = Mapping[str, Any]
_RELATIVE, _ABSOLUTE = 1e-6, 1e-9
_T_TEST = frozenset({"t", "degrees_of_freedom", "p", "estimate", "standard_error"})
_LONGEST_EXACT = 60  # people; beyond, all signs of the ranks take too long


def check_results(results: Values, trials: pd.DataFrame) -> list[Finding]:
    """Find every number of a study's results again, from its trials or from the numbers beside it.

    Counts from the rows of the trials; means, medians, ranks, chi-squared, signed ranks, shifts and
    correlations from their values, by other code than that which made them; p from statistics, W from
    chi-squared, F from chi-squared; intervals around their estimates; means of whole answers by GRIM.

    Parameters
    ----------
    results : mapping
        The content of `results.json`.
    trials : DataFrame
        The rows of `trials.csv`.

    Returns
    -------
    list of Finding
        One for every number that was held against something; `claim` says where it stands.
    """
    found = [*_counts(results, trials)]
    for test in results["tests"]:
        found += _test(test, trials, results["alpha"])
    for one in results["correlations"]:
        found += _correlation(one, trials)
    found += _terms(results)
    told = results.get("enjoyment") or {}
    found += _enjoyment(told, "enjoyment")
    found += _enjoyment(told.get("five_items") or {}, "enjoyment.five_items")
    found += _intervals(results)
    return found


def _same(kind: str, place: str, stated: Any, recomputed: float) -> Finding:
    """Hold a stated number against the one found again."""
    is_number = isinstance(stated, int | float) and not isinstance(stated, bool)
    fits = is_number and math.isclose(stated, recomputed, rel_tol=_RELATIVE, abs_tol=_ABSOLUTE)
    words = f"{place} is {stated if not is_number else format(stated, '.6g')}, found again {recomputed:.6g}"
    return Finding(kind=kind, claim=place, recomputed=(recomputed,), is_consistent=fits, words=words)


def _true(kind: str, place: str, *, holds: bool, words: str) -> Finding:
    return Finding(kind=kind, claim=place, recomputed=(), is_consistent=holds, words=f"{place}: {words}")


def _counts(results: Values, trials: pd.DataFrame) -> Iterator[Finding]:
    for key, count in (
        ("participants", trials["participant"].nunique()),
        ("trials", len(trials)),
        ("valid_trials", int(trials["is_valid"].sum())),
    ):
        yield _same("count", key, results[key], count)


def _complete(conditions: Sequence[str], outcome: str, trials: pd.DataFrame) -> tuple[Floats, pd.DataFrame]:
    """Give the values of those who have one in all conditions, shape (person, condition), and all trials."""
    rows = trials[trials["condition"].isin(conditions)]
    by_person = [
        [own.loc[own["condition"] == name, outcome].mean() for name in conditions]
        for _, own in rows[rows["is_valid"].astype(bool)].groupby("participant")
    ]
    table = np.array(by_person, dtype=float).reshape(-1, len(conditions))
    return table[np.isfinite(table).all(axis=1)], rows


def _test(test: Values, trials: pd.DataFrame, alpha: float) -> Iterator[Finding]:
    place = f"tests.{test['name']}"
    table, rows = _complete(test["conditions"], test["outcome"], trials)
    left_out, n = test["exclusions"], len(table)
    valid = rows["is_valid"].astype(bool)
    yield _same("count", f"{place}.participants", test["participants"], n)
    yield _same("count", f"{place}.exclusions.trials", left_out["trials"], len(rows))
    yield _same("count", f"{place}.exclusions.used", left_out["used"], table.size)
    not_valid = sum(left_out["not_valid"].values())
    yield _same("count", f"{place}.exclusions.not_valid", not_valid, int((~valid).sum()))
    without = int(rows.loc[valid, test["outcome"]].isna().sum())
    yield _same("count", f"{place}.exclusions.without_value", left_out["without_value"], without)
    if test["friedman"]:
        yield from _friedman(test["friedman"], f"{place}.friedman", table)
        yield from _verdict(test, place, alpha)
        for place_, row in enumerate(test["summaries"]):
            yield from _summary(row, f"{place}.summaries.{row['condition']}", table, place_)
        for pair in test["pairs"]:
            a, b = (table[:, test["conditions"].index(pair[side])] for side in "ab")
            yield from _pair(pair, f"{place}.pairs.{pair['a']} - {pair['b']}", a - b)
        yield from _corrected(test, place, alpha)


def _ranks(table: Floats) -> Floats:
    """Rank each row, ties sharing their mean rank."""
    below = (table[:, None, :] < table[:, :, None]).sum(axis=2)
    equal = (table[:, None, :] == table[:, :, None]).sum(axis=2)
    return np.asarray(below + (equal + 1) / 2.0)


def _friedman(found: Values, place: str, table: Floats) -> Iterator[Finding]:
    from scipy import stats

    ranks = _ranks(table)
    n, k = ranks.shape
    chi2, df = found["chi_squared"], k - 1
    away = ((ranks.sum(axis=0) - n * (k + 1) / 2.0) ** 2).sum()
    recomputed = df * away / ((ranks - (k + 1) / 2.0) ** 2).sum()
    yield _same("chi-squared", f"{place}.chi_squared", chi2, float(recomputed))
    yield _same("degrees of freedom", f"{place}.degrees_of_freedom", found["degrees_of_freedom"], df)
    yield _same("count", f"{place}.n", found["n"], n)
    yield _same("p against chi2", f"{place}.p", found["p"], float(stats.chi2.sf(chi2, df)))
    yield _same("W against chi2", f"{place}.kendalls_w", found["kendalls_w"], chi2 / (n * df))
    yield _same("rank sum", f"{place}.mean_ranks", sum(found["mean_ranks"]), k * (k + 1) / 2.0)
    if found.get("f") is not None:
        yield _same("F against chi2", f"{place}.f", found["f"], (n - 1) * chi2 / (n * df - chi2))
        p = float(stats.f.sf(found["f"], *found["f_degrees_of_freedom"]))
        yield _same("p against F", f"{place}.f_p", found["f_p"], p)
    if (chance := found.get("permutation_p")) is not None:
        low, high = found.get("permutation_p_interval") or (0.0, 1.0)
        words = f"{chance:.6g} lies from {low:.6g} to {high:.6g}"
        yield _true("interval", f"{place}.permutation_p", holds=low <= chance <= high, words=words)


def _verdict(test: Values, place: str, alpha: float) -> Iterator[Finding]:
    found = test["friedman"]
    p = test["p"] if test.get("p") is not None else found["p"]
    ways = [found["p"], found.get("f_p"), found.get("permutation_p")]
    is_one = any(way is not None and math.isclose(p, way, rel_tol=_RELATIVE) for way in ways) or p == 0.0
    yield _true("declared p", f"{place}.p", holds=is_one, words=f"{p:.6g} is one of the p values of the test")
    yield _true(
        "verdict",
        f"{place}.is_significant",
        holds=test["is_significant"] == (p < alpha),
        words=f"{test['is_significant']} for p = {p:.6g} at {alpha:g}",
    )


def _summary(row: Values, place: str, table: Floats, column: int) -> Iterator[Finding]:
    values = table[:, column]
    low, middle, high = np.quantile(values, [0.25, 0.5, 0.75])
    for key, value in (
        ("mean", values.sum() / len(values)),
        ("standard_deviation", math.sqrt(((values - values.mean()) ** 2).sum() / (len(values) - 1))),
        ("median", middle),
        ("lower_quartile", low),
        ("upper_quartile", high),
        ("mean_rank", _ranks(table)[:, column].mean()),
    ):
        yield _same(key.replace("_", " "), f"{place}.{key}", row[key], float(value))
    if np.all(values == np.round(values)):
        fits = bool(attainable.whole_totals(row["mean"] - _ABSOLUTE, row["mean"] + _ABSOLUTE, len(values)))
        words = f"{row['mean']:.6g} is a mean of {len(values)} whole answers"
        yield _true("GRIM", f"{place}.mean", holds=fits, words=words)


def _pair(pair: Values, place: str, differences: Floats) -> Iterator[Finding]:
    zeros = "pratt" if "(Pratt)" in pair["variant"] else "split" if "half" in pair["variant"] else "drop"
    kept = differences[differences != 0.0] if zeros == "drop" else differences
    ranks = _ranks(np.abs(kept)[None])[0] if len(kept) else kept
    shared = ranks[kept == 0.0].sum() / 2.0 if zeros == "split" else 0.0
    plus, minus = ranks[kept > 0.0].sum() + shared, ranks[kept < 0.0].sum() + shared
    yield _same("count", f"{place}.n", pair["n"], len(differences))
    yield _same("count", f"{place}.n_nonzero", pair["n_nonzero"], int((differences != 0.0).sum()))
    yield _same(
        "median", f"{place}.median_difference", pair["median_difference"], float(np.median(differences))
    )
    yield _same("signed ranks", f"{place}.w_plus", pair["w_plus"], float(plus))
    yield _same("signed ranks", f"{place}.w_minus", pair["w_minus"], float(minus))
    if plus + minus:
        size = float((plus - minus) / (plus + minus))
        yield _same("rank-biserial", f"{place}.rank_biserial", pair["rank_biserial"], size)
    if "exact" in pair["variant"] and len(kept) <= _LONGEST_EXACT:
        p = attainable.p_of_ranks(ranks[kept != 0.0], float(ranks[kept > 0.0].sum()))
        yield _same("p against signed ranks", f"{place}.p", pair["p"], p)
    if shift := pair.get("shift"):
        pairwise = (differences[:, None] + differences[None, :])[np.triu_indices(len(differences))] / 2.0
        yield _same("shift", f"{place}.shift.estimate", shift["estimate"], float(np.median(pairwise)))


def _corrected(test: Values, place: str, alpha: float) -> Iterator[Finding]:
    p = np.array([pair["p"] for pair in test["pairs"]])
    order = np.argsort(p, kind="stable")
    steps = np.maximum.accumulate(p[order] * (len(p) - np.arange(len(p)))) if len(p) else p
    holm = np.empty(len(p))
    holm[order] = np.minimum(1.0, steps)
    expected = {"holm": holm, "bonferroni": np.minimum(1.0, len(p) * p), "none": p}.get(test["correction"])
    for number, pair in enumerate(test["pairs"]):
        where = f"{place}.pairs.{pair['a']} - {pair['b']}"
        corrected = pair["p_corrected"]
        if expected is not None:
            yield _same("corrected p", f"{where}.p_corrected", corrected, float(expected[number]))
        yield _true(
            "verdict",
            f"{where}.is_significant",
            holds=pair["is_significant"] == (corrected < alpha),
            words=f"{pair['is_significant']} for p = {corrected:.6g} at {alpha:g}",
        )


def _correlation(result: Values, trials: pd.DataFrame) -> Iterator[Finding]:
    from scipy import stats

    place = f"correlations.{result['name']}"
    if not (result.get("pooled") and result.get("repeated_measures")):
        return
    rows = trials[trials["is_valid"].astype(bool) & trials["condition"].isin(result["conditions"])]
    pairs = rows.assign(x=rows[list(result["x"])].sum(axis=1, skipna=False), y=rows[str(result["y"])])
    pairs = pairs[["participant", "x", "y"]].dropna()
    pairs = pairs[pairs.groupby("participant")["x"].transform("size") >= 2]
    x, y = pairs["x"].to_numpy(), pairs["y"].to_numpy()
    own = pairs.groupby("participant")[["x", "y"]].transform("mean").to_numpy()
    for key, dx, dy in (
        ("pooled", x - x.mean(), y - y.mean()),
        ("repeated_measures", x - own[:, 0], y - own[:, 1]),
    ):
        found = result[key]
        r, df = float((dx * dy).sum() / math.sqrt((dx**2).sum() * (dy**2).sum())), found["degrees_of_freedom"]
        people = pairs["participant"].nunique()
        yield _same("r", f"{place}.{key}.r", found["r"], r)
        yield _same("count", f"{place}.{key}.n", found["n"], len(pairs))
        expected_df = len(pairs) - (2 if key == "pooled" else people + 1)
        yield _same("degrees of freedom", f"{place}.{key}.degrees_of_freedom", df, expected_df)
        t = abs(found["r"]) * math.sqrt(df / max(1e-300, 1.0 - found["r"] ** 2))
        yield _same("p against r", f"{place}.{key}.p", found["p"], float(2.0 * stats.t.sf(t, df)))


def _terms(results: Values) -> Iterator[Finding]:
    """Hold F and t of every model against their p, wherever they stand."""
    from scipy import stats

    for place, entry in _dictionaries(results, ""):
        if {"f", "numerator_df", "denominator_df", "p"} <= entry.keys() and entry["f"] is not None:
            p = float(stats.f.sf(entry["f"], entry["numerator_df"], entry["denominator_df"]))
            yield _same("p against F", f"{place}.p", entry["p"], p)
        elif entry.keys() >= _T_TEST and all(entry[key] for key in ("t", "standard_error")):
            p = float(2.0 * stats.t.sf(abs(entry["t"]), entry["degrees_of_freedom"]))
            yield _same("p against t", f"{place}.p", entry["p"], p)
            yield _same("t", f"{place}.t", entry["t"], entry["estimate"] / entry["standard_error"])
        elif {"f", "df", "p", "effect"} <= entry.keys():
            yield _same("p against F", f"{place}.p", entry["p"], float(stats.f.sf(entry["f"], *entry["df"])))


def _dictionaries(value: Any, place: str) -> Iterator[tuple[str, Values]]:
    if isinstance(value, Mapping):
        yield place, value
        for key, entry in value.items():
            yield from _dictionaries(entry, f"{place}.{key}".lstrip("."))
    elif isinstance(value, list | tuple):
        for number, entry in enumerate(value):
            name = entry.get("name", number) if isinstance(entry, Mapping) else number
            yield from _dictionaries(entry, f"{place}.{name}")


def _intervals(results: Values) -> Iterator[Finding]:
    """Hold every estimate against its own interval."""
    for place, entry in _dictionaries(results, ""):
        for key, name in (
            ("interval", "estimate" if "estimate" in entry else "r"),
            ("rank_biserial_interval", "rank_biserial"),
        ):
            estimate, ends = entry.get(name), entry.get(key)
            if ends is None or estimate is None:
                continue
            slack = _ABSOLUTE + _RELATIVE * abs(estimate)
            holds = ends[0] - slack <= estimate <= ends[1] + slack
            words = f"{estimate:.6g} lies from {ends[0]:.6g} to {ends[1]:.6g}"
            yield _true("interval", f"{place}.{key}", holds=holds, words=words)
        if ends := entry.get("kendalls_w_interval"):
            words = f"{ends[0]:.6g} and {ends[1]:.6g} are in order, from 0 to 1"
            holds = -_ABSOLUTE <= ends[0] <= ends[1] <= 1.0 + _ABSOLUTE
            yield _true("interval", f"{place}.kendalls_w_interval", holds=holds, words=words)


def _enjoyment(found: Values, place: str) -> Iterator[Finding]:
    """Hold the four ways to print enjoyment against each other, and the item mean against whole answers."""
    if not found.get("participants"):
        return
    mean = found["mean"]["item_mean"]
    items = round(found["mean"]["total"] / mean)
    for key, value in (
        ("total", items * mean),
        ("percent_of_maximum", 100.0 * mean / 7.0),
        ("percent_of_range", 100.0 * (mean - 1.0) / 6.0),
    ):
        yield _same("enjoyment", f"{place}.mean.{key}", found["mean"][key], value)
    answers = found["participants"] * items
    if found.get("answers") == answers:  # an answer left out takes the mean of the others
        fits = bool(attainable.whole_totals(mean - _ABSOLUTE, mean + _ABSOLUTE, answers))
        words = f"{mean:.6g} is a mean of {answers} whole answers"
        yield _true("GRIM", f"{place}.mean.item_mean", holds=fits, words=words)
