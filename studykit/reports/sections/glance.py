"""Every result that the protocol declared, in one table for the first page."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from studykit.reports.document import Block, Paragraph, Table, Words, italic, listed
from studykit.reports.naming import condition, outcome, titled, unit
from studykit.reports.numbers import (
    bounded,
    decimals_for,
    interval,
    limits,
    number,
    p_cell,
    percent,
)

_Row = tuple[Words, ...]


def at_a_glance(results: dict[str, Any]) -> tuple[Block, ...]:
    """Give every declared result in one table, for the first page.

    Parameters
    ----------
    results : dict
        The content of `results.json`; older ones may lack some kinds of result.
    """
    rows = (
        *map(_test, results["tests"]),
        *map(_correlation, results["correlations"]),
        *(row for model in results.get("models") or () for row in _model(model)),
        *(_equivalence(one, results["alpha"]) for one in results.get("equivalences") or ()),
        *map(_curve, results.get("curves") or ()),
    )
    if not rows:
        return (Paragraph(words="The protocol declares no result."),)
    is_starred = any(str(row[0]).endswith(" *") for row in rows)
    starred = " *: to be read with the warning in section Models." if is_starred else ""
    table = Table(
        title="Every result that the protocol declares.",
        head=(
            "Result", "Statistic", (italic("p"),), "Effect",
            f"{percent(1.0 - results['alpha'], 0)} interval", (italic("n"),),
        ),
        rows=rows,
        text_columns=frozenset({1, 3}),
        note="W: Kendall’s coefficient of concordance, 0 (people rank the conditions at random) to 1 (all "
        "rank them alike). r: correlation within people, unless called pooled. η²: partial. n: participants. "
        "Interactions of factors, period and carry-over: section Models. Each p stands for itself; within a "
        f"test, pairs are corrected for their number.{starred}",
    )  # fmt: skip
    return (table,)


def _not_computed(about: str, participants: object = "") -> _Row:
    return (about, "not computed", "", "", "", str(participants))


def _test(test: dict[str, Any]) -> _Row:
    about, found = f"{titled(test['name'])}: {outcome(test['outcome'])}", test["friedman"]
    if found is None:
        return _not_computed(about, test["participants"])
    value = test.get("p")
    f_df = found.get("f_degrees_of_freedom")
    by_f = test.get("p_from") == "f" and f_df
    return (
        about,
        f"F({f_df[0]}, {f_df[1]}) = {number(found['f'])}"
        if by_f
        else f"χ²({found['degrees_of_freedom']}) = {number(found['chi_squared'])}",
        p_cell(float(value if value is not None else found["p"])),
        (italic("W"), f" = {bounded(found['kendalls_w'])}"),
        interval(test["kendalls_w_interval"]),
        str(found["n"]),
    )


def _correlation(result: dict[str, Any]) -> _Row:
    across = " plus ".join(outcome(name) for name in result["x"])
    about = f"{titled(result['name'])}: {outcome(result['y'])} with {across}"
    is_pooled = result["method"] == "pearson"
    found = result["pooled" if is_pooled else "repeated_measures"]
    if found is None:
        return _not_computed(about)
    return (
        about,
        f"r({found['degrees_of_freedom']}) = {bounded(found['r'])}{' (pooled)' if is_pooled else ''}",
        p_cell(found["p"]),
        (italic("r"), f" = {bounded(found['r'])}"),
        interval(found["interval"]),
        str(found["participants"] or f"{found['n']} trials"),
    )


def _model(model: dict[str, Any]) -> Iterator[_Row]:
    """Give a row a factor: its difference if it has two levels, as the ranks know none else its share."""
    about = titled(model["name"])
    if model.get("not_computed_because"):
        yield _not_computed(f"{about}: {outcome(model['outcome'])}")
        return
    fit = model.get("mixed_model")
    if fit is None:
        for effect in model["effects"]:
            if effect["effect"] in model["factors"]:
                share = f"η² = {bounded(effect['partial_eta_squared'])}"
                above, below = effect["df"]
                statistic = f"F({_df(above)}, {_df(below)}) = {number(effect['f'])}"
                name = f"{about}: {effect['effect']}"
                yield (name, statistic, p_cell(effect["p"]), share, "–", str(effect["n"]))
        return
    star = " *" if fit.get("notes") else ""
    for term in fit["terms"]:
        if term["name"] not in model["factors"]:
            continue
        levels = [row for row in fit["differences"] if str(row["name"]).startswith(f"{term['name']}: ")]
        statistic = f"F({_df(term['numerator_df'])}, {_df(term['denominator_df'])}) = {number(term['f'])}"
        effect, ends = ("–", "–") if len(levels) != 1 else _difference(levels[0], model["outcome"])
        people = str(fit["participants"])
        yield (f"{about}: {term['name']}{star}", statistic, p_cell(term["p"]), effect, ends, people)


def _difference(row: dict[str, Any], column: str) -> tuple[str, str]:
    """Say which level lies above which by how much, and the interval."""
    places = decimals_for(float(row["standard_error"] or 0.0))
    levels = str(row["name"]).split(": ", 1)[1].replace(" - ", " − ")
    amount = f"{number(row['estimate'], places)} {unit(column)}".rstrip()
    return f"{levels} = {amount}", limits(row["interval"], places)


def _equivalence(result: dict[str, Any], alpha: float) -> _Row:
    about = f"{titled(result['name'])}: {condition(result['a'])} − {condition(result['b'])}"
    found, measure = result["found"], unit(result["outcome"])
    if found is None:
        return _not_computed(about)
    by_t, wide = found["by_t"], f"{percent(1.0 - 2.0 * alpha, 0)}: "
    ends = by_t["interval"]
    places = decimals_for((ends[1] - ends[0]) / 4.0) if ends else 2
    within = f"within {number(result['low'], 1)} to {number(result['high'], 1)} {measure}".rstrip()
    return (
        about,
        f"{within}: {'yes' if by_t['is_equivalent'] else 'not shown'}",
        p_cell(by_t["p"]),
        f"{number(by_t['estimate'], places)} {measure}".rstrip(),
        f"{wide}{limits(ends, places)}",
        str(found["n"]),
    )


def _curve(result: dict[str, Any]) -> _Row:
    about, found = titled(result["name"]), result["found"]
    if found is None:
        return _not_computed(about)
    stretches = [f"{number(one['start_s'])} to {number(one['stop_s'])} s" for one in found["clusters"]]
    differ = f"differ from {listed(stretches)}" if stretches else "no stretch differs"
    return (about, differ, p_cell(found["p"]), "–", "–", str(found["n"]))


def _df(value: float) -> str:
    return number(value, 0 if abs(value - round(value)) < 0.05 else 1)
