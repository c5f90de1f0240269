"""Every declared test and correlation, heart rate by condition, and enjoyment."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from studykit.reports.document import Block, Paragraph, Piece, Section, Table, bold, italic, listed
from studykit.reports.naming import condition, outcome, place, sentence, titled, unit, with_unit
from studykit.reports.numbers import (
    bounded,
    decimals_for,
    interval,
    limits,
    number,
    p_cell,
    p_value,
    percent,
    times,
)

if TYPE_CHECKING:
    from studykit.reports.material import Material

_RANK_BISERIAL_INTERVAL = (
    "Interval of the rank-biserial correlation: Fisher’s z with the jackknife over people; where all differ "
    "the same way, from Clopper and Pearson’s limit, which is cautious."
)
_ENJOYMENT = {
    "total": "Total",
    "percent_of_maximum": "Percent of the highest total",
    "percent_of_range": "Percent of the range from lowest to highest total",
    "item_mean": "Mean of the items (1 to 7)",
}


def declared_tests(results: dict[str, Any]) -> Section:
    """Tell every declared comparison: statistic, df, p, effect with interval, n and exclusions."""
    said = Paragraph(
        words=f"Level of significance {bounded(results['alpha'])}; intervals cover "
        f"{percent(1 - results['alpha'], 0)}. "
        "Differences are the first condition minus the second. Friedman’s test asks whether conditions "
        "differ at "
        "all, from each person’s ranking of them; Wilcoxon’s signed-rank tests ask which pairs do."
    )
    tests = tuple(_test(test, results["alpha"]) for test in results["tests"])
    return Section(
        title="Declared tests",
        blocks=(said,) if tests else (Paragraph(words="The protocol declares no test."),),
        sections=tests,
    )


def _test(test: dict[str, Any], alpha: float) -> Section:
    title = f"{titled(test['name'])}: {with_unit(test['outcome'])}"
    used = Paragraph(words=left_out(test["exclusions"]), kind="note")
    found = test["friedman"]
    if found is None:
        problem = Paragraph(words=f"Not computed: {test['not_computed_because']}.", kind="warning")
        used = Paragraph(
            words=left_out(test["exclusions"]).replace("were used", "have a value", 1), kind="note"
        )
        return Section(title=title, blocks=(problem, used))
    blocks: list[Block] = [_omnibus(test, found), _summaries(test)]
    if test["pairs"]:
        blocks += [_pairs(test, alpha), _variants(test)]
    return Section(title=title, blocks=(*blocks, *_more(test), used))


def _omnibus(test: dict[str, Any], found: dict[str, Any]) -> Paragraph:
    words: list[str | Piece] = [
        f"Friedman: χ²({found['degrees_of_freedom']}) = {number(found['chi_squared'])}, ",
        italic("p"), f" {p_value(found['p'])} (chi-squared approximation)",
    ]  # fmt: skip
    if found.get("f") is not None:
        above, below = found["f_degrees_of_freedom"]
        words += [
            "; ", italic("F"), f"({above}, {below}) = {number(found['f'])}, ", italic("p"),
            f" {p_value(found['f_p'])} (Iman and Davenport)",
        ]  # fmt: skip
    if found.get("permutation_p") is not None:
        ends = found.get("permutation_p_interval")
        within = f", between {p_cell(ends[0])} and {p_cell(ends[1])}" if ends and ends[1] >= 0.001 else ""
        method = found.get("permutation_method", "permutation")
        words += ["; ", italic("p"), f" {p_value(found['permutation_p'])} ({method}{within})"]
    words += [
        ". Kendall’s ", italic("W"),
        f" = {bounded(found['kendalls_w'])} {interval(test['kendalls_w_interval'])}, ",
        italic("n"), f" = {found['n']}. ",
    ]  # fmt: skip
    words.append(_declared_kind(test))
    words.append(
        bold("The conditions differ significantly.")
        if test["is_significant"]
        else bold("No significant difference was found, which does not show that the conditions are alike.")
    )
    return Paragraph(words=tuple(words), kind="result")


def _declared_kind(test: dict[str, Any]) -> str:
    """Say which p the protocol names."""
    kinds = {"f": "F", "permutation": "permutation"}
    return f"The protocol names the p by {kinds.get(test.get('p_from') or '', 'chi-squared')}. "


def _decimals(test: dict[str, Any]) -> int:
    spreads = [row["standard_deviation"] for row in test["summaries"] if row["standard_deviation"]]
    return decimals_for(min(spreads, default=0.0))


def _summaries(test: dict[str, Any]) -> Table:
    places = _decimals(test)
    return Table(
        title=f"{sentence(with_unit(test['outcome']))} by condition, over {test['participants']} "
        "participants.",
        head=("Condition", "Mean", "SD", "Median", "Quartiles", "Mean rank"),
        rows=tuple(
            (
                condition(row["condition"]),
                number(row["mean"], places),
                number(row["standard_deviation"], places),
                number(row["median"], places),
                f"{number(row['lower_quartile'], places)} to {number(row['upper_quartile'], places)}",
                number(row["mean_rank"]),
            )
            for row in sorted(test["summaries"], key=lambda row: place(row["condition"]))
        ),
        note="SD: standard deviation over participants. Mean rank: 1 for each person’s lowest value.",
    )


def shift_of(pair: dict[str, Any]) -> dict[str, Any] | None:
    """Give the Hodges-Lehmann shift of a pair, whatever it is called."""
    wanted = {"estimate", "interval", "method"}
    return next((v for v in pair.values() if isinstance(v, dict) and wanted <= v.keys()), None)


def _pairs(test: dict[str, Any], alpha: float) -> Table:
    places = _decimals(test)
    measure = unit(test["outcome"])
    shifts = [shift_of(pair) for pair in test["pairs"]]
    rows = []
    for pair, shift in zip(test["pairs"], shifts, strict=True):
        corrected = p_cell(pair["p_corrected"])
        rows.append(
            (
                f"{condition(pair['a'])} − {condition(pair['b'])}",
                number(pair["median_difference"], places),
                *(
                    (number(shift["estimate"], places), limits(shift["interval"], places))
                    if shift
                    else ("–", "–")
                ),
                number(pair["w_plus"], 1),
                number(pair["w_minus"], 1),
                p_cell(pair["p"]),
                (bold(corrected),) if pair["is_significant"] else corrected,
                bounded(pair["rank_biserial"]),
                interval(pair["rank_biserial_interval"]),
            )
        )
    variants = listed(sorted({pair["variant"] for pair in test["pairs"]}))
    # The longest says all that the others say, and what holds with ties besides.
    methods = max((shift["method"] for shift in shifts if shift), key=len, default="")
    shifted = f" Shift: {methods}." if methods else ""
    return Table(
        title=f"Pairs of conditions by Wilcoxon’s signed-rank test; p corrected: "
        f"{test['correction'].capitalize()}.",
        head=(
            "First − second",
            f"Median difference{f' ({measure})' if measure else ''}",
            "Shift",
            "Interval",
            (italic("W"), "+"),
            (italic("W"), "−"),
            (italic("p"),),
            (italic("p"), " corrected"),
            "Rank-biserial",
            "Interval",
        ),
        rows=tuple(rows),
        note=f"{sentence(variants)}. Bold: below {bounded(alpha)}. W+ and W−: sums of the ranks of positive "
        "and "
        "negative differences. Rank-biserial: (W+ − W−) / (W+ + W−), from −1 to 1."
        f"{shifted} {_RANK_BISERIAL_INTERVAL}",
    )


def _variants(test: dict[str, Any]) -> Table:
    names = list(test["pairs"][0]["p_by_variant"])
    return Table(
        title="The same pairs in other ways: uncorrected p, and the Bayes factor for a difference.",
        head=("First − second", *map(_briefly, names), "BF₁₀"),
        rows=tuple(
            (
                f"{condition(pair['a'])} − {condition(pair['b'])}",
                *(p_cell(pair["p_by_variant"][name]) for name in names),
                times(pair.get("bayes_factor_10")),
            )
            for pair in test["pairs"]
        ),
        note="Exact: over all signs of the ranks. Normal: by the normal approximation, corrected for ties. "
        "Pratt: people without a difference are ranked, then dropped. BF₁₀: how many times better a "
        "difference of means explains the data than none (paired, Cauchy prior of scale 0.707).",
    )


def _briefly(variant: str) -> str:
    """Name a variant of Wilcoxon's test in two words.

    Examples
    --------
    >>> _briefly("exact permutation distribution, ties kept; zeros dropped; two-sided")
    'Exact, zeros dropped'
    """
    way = "Exact" if variant.startswith("exact") else "Normal"
    way += " with continuity" if "with continuity" in variant else ""
    zeros = "Pratt" if "(Pratt)" in variant else "zeros split" if "half" in variant else "zeros dropped"
    return f"{way}, {zeros}"


def _more(test: dict[str, Any]) -> list[Block]:
    """Tell the test that keeps people who lack a condition, where one was declared."""
    found = test.get("skillings_mack")
    if reason := test.get("skillings_mack_not_computed_because"):
        return [Paragraph(words=f"Skillings and Mack's test could not be made: {reason}.", kind="warning")]
    if not found or not found["cells_missing"]:
        return []
    words = (
        f"With those who lack a condition kept (Skillings and Mack): {number(found['statistic'])} on "
        f"{found['degrees_of_freedom']} degrees of freedom, p {p_value(found['p'])}, by permutation p "
        f"{p_value(found['permutation_p'])}; {found['n']} participants, {found['cells_missing']} values "
        "missing."
    )
    return [Paragraph(words=words)]


def left_out(excluded: dict[str, Any]) -> str:
    """Say which trials a comparison did not use."""
    parts = [f"Of {excluded['trials']} trials of these conditions, {excluded['used']} were used"]
    if excluded["without_value"]:
        parts.append(f"{excluded['without_value']} valid without a value")
    parts += [f"{count} not valid ({reason})" for reason, count in excluded["not_valid"].items()]
    people = [
        f"participant {person} (no value in {listed([condition(name) for name in missing])})"
        for person, missing in excluded["participants_left_out"].items()
    ]
    return "; ".join(parts) + "." + (f" Left out: {'; '.join(people)}." if people else "")


def correlations(results: dict[str, Any]) -> Section:
    """Tell every declared correlation within people, and beside it the pooled one with its warning."""
    if not results["correlations"]:
        return Section(
            title="Correlations", blocks=(Paragraph(words="The protocol declares no correlation."),)
        )
    return Section(title="Correlations", sections=tuple(_correlation(one) for one in results["correlations"]))


def _correlation(result: dict[str, Any]) -> Section:
    across = " plus ".join(outcome(name) for name in result["x"])
    title = f"{titled(result['name'])}: {outcome(result['y'])} against {across}"
    within, pooled = result["repeated_measures"], result["pooled"]
    if within is None:
        return Section(
            title=title,
            blocks=(Paragraph(words=f"Not computed: {result['not_computed_because']}.", kind="warning"),),
        )
    declared = pooled if result["method"] == "pearson" else within
    table = Table(
        title="The correlation within people, and the one that takes every trial for another person.",
        head=(
            "Correlation",
            (italic("r"),),
            "Interval",
            "df",
            (italic("p"),),
            "Trials",
            "Participants",
            "Declared",
        ),
        rows=tuple(
            (
                sentence(one["method"]),
                bounded(one["r"]),
                interval(one["interval"]),
                str(one["degrees_of_freedom"]),
                p_cell(one["p"]),
                str(one["n"]),
                "–" if one["participants"] is None else str(one["participants"]),
                "yes" if one is declared else "no",
            )
            for one in (within, pooled)
        ),
        note=left_out(result["exclusions"]),
    )
    few = Paragraph(
        words=f"{sentence(across)} takes only {result['distinct_x']} different values, no "
        "more than there are conditions: this correlation tells conditions apart, and not what else differs "
        "between their dances.",
        kind="note",
    )
    warning = Paragraph(
        words=(bold(f"{sentence(pooled['method'])}: "), pooled["warning"] or ""), kind="warning"
    )
    is_by_dance = result["distinct_x"] <= len(result["conditions"])
    return Section(title=title, blocks=(table, *([few] if is_by_dance else []), warning))


def by_condition(material: Material) -> Section:
    """Give heart rate and time at vigorous intensity, condition by condition."""
    table = material.trials[material.trials["is_valid"].astype(bool)]
    protocol = material.protocol
    rows = []
    for name in sorted(protocol.conditions_list(), key=place):
        some = table[table["condition"] == name]
        mean = some["heart_rate_mean_bpm"].dropna()
        rows.append(
            (
                condition(name),
                str(len(mean)),
                number(float(mean.mean()) if len(mean) else None, 1),
                number(float(mean.std(ddof=1)) if len(mean) > 1 else None, 1),
                limits(_interval_of_mean(mean), 1),
                number(_mean(some["heart_rate_peak_bpm"]), 1),
                percent(_mean(some["vigorous_fraction"]), 2),
            )
        )
    formula = "208 − 0.7 × age" if protocol.heart_rate.maximum == "tanaka" else "220 − age"
    after = "" if protocol.heart_rate.window == "perform" else " and the 30 s after"
    return Section(
        title="Heart rate by condition",
        blocks=(
            Table(
                title=f"Heart rate while performing{after}, over participants.",
                head=(
                    "Condition",
                    (italic("n"),),
                    "Mean (beats/min)",
                    "SD (beats/min)",
                    "95 % interval of the mean",
                    "Mean peak (beats/min)",
                    "Mean time at vigorous intensity",
                ),
                rows=tuple(rows),
                note=f"Vigorous: at or above {percent(protocol.heart_rate.vigorous_fraction, 0)} of the "
                "maximum "
                f"predicted from age ({formula}).",
            ),
        ),
    )


def _interval_of_mean(values: Any) -> tuple[float, float] | None:
    """Give Student's 95 % interval of a mean."""
    from scipy.stats import t

    if len(values) < 2:
        return None
    reach = float(t.ppf(0.975, len(values) - 1) * values.std(ddof=1) / len(values) ** 0.5)
    return float(values.mean()) - reach, float(values.mean()) + reach


def _mean(values: Any) -> float | None:
    known = values.dropna()
    return float(known.mean()) if len(known) else None


def enjoyment(results: dict[str, Any]) -> Section:
    """Give the enjoyment scale in every way in which studies print it."""
    found = results["enjoyment"]
    if not found.get("participants"):
        return Section(
            title="Enjoyment", blocks=(Paragraph(words="Nobody has answered the enjoyment scale yet."),)
        )
    forms = [found, *([five] if (five := found.get("five_items") or {}).get("participants") else [])]
    return Section(title="Enjoyment", blocks=tuple(block for form in forms for block in _enjoyment_of(form)))


def _enjoyment_of(found: dict[str, Any]) -> tuple[Block, Block]:
    """Give one form of the scale."""
    left = f", {found['left_out']} left out for too many missing answers" if found["left_out"] else ""
    alpha = found["cronbach_alpha"]
    words = (
        f"Physical Activity Enjoyment Scale, {found['version']}; {found['participants']} participants{left}. "
        f"Cronbach’s α = {bounded(alpha)} (how well the items go together)."
    )
    spread = found["standard_deviation"] or {}
    table = Table(
        title=f"Enjoyment over participants ({found['version']}); higher is more.",
        head=("Score", "Mean", "SD"),
        rows=tuple(
            (words, number(found["mean"][key]), number(spread.get(key))) for key, words in _ENJOYMENT.items()
        ),
        note="Studies print either percentage without saying which; both stand here.",
    )
    return Paragraph(words=words), table
