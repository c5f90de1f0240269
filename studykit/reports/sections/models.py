"""Models, order effects and whatever else the results hold, each with its words of explanation."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from studykit.reports.document import Block, Paragraph, Section, Table, Words, italic, listed
from studykit.reports.naming import condition, outcome, sentence, titled, unit, with_unit
from studykit.reports.numbers import anything, bounded, decimals_for, limits, number, p_cell, p_value, percent

_SYMBOLS: dict[str, Words] = {
    "p": (italic("p"),), "f": (italic("F"),), "t": (italic("t"),), "f_p": (italic("p"), " of F"),
    "n": (italic("n"),), "df": "df", "is_equivalent": "Equivalent", "p_low": (italic("p"), " low"),
    "p_high": (italic("p"), " high"), "numerator_df": "Numerator df", "denominator_df": "Denominator df",
    "chi_squared": "χ²", "kendalls_w": (italic("W"),), "kendalls_w_interval": "Interval of W",
    "degrees_of_freedom": "df", "standard_error": "SE", "partial_eta_squared": "Partial η²",
    "p_greenhouse_geisser": (italic("p"), " (Greenhouse–Geisser)"), "bayes_factor": "BF₁₀",
    "start_s": "From (s)", "stop_s": "To (s)", "same_verdict": "Same verdict",
}  # fmt: skip
_TITLES = {
    "models": "Models",
    "order_effects": "Order of the conditions",
    "factorials": "Factors and their interactions",
    "curves": "Curves",
    "equivalences": "Equivalence",
    "bayes_factors": "Bayes factors",
}
_OPENINGS = {
    "models": "A mixed model gives every participant a level of their own and uses all valid "
    "trials, also those of people who lack some. Intervals and tests rest on how much participants differ in "
    "what a factor does to them, so that they hold where people respond differently.",
    "order_effects": "Whether an outcome changed from period to period, differed between sequences, "
    "or carried over from the dance before, beside the conditions. Period and carry-over are tested by how "
    "much participants differ in them; sequence, which lies between them, by how much their levels differ.",
    "factorials": "Each factor’s effect after aligned ranks.",
    "curves": "Where two conditions differ over time: stretches (clusters) that chance seldom "
    "makes so large, found by permuting whose curve is whose.",
    "equivalences": "Whether conditions are the same within limits named before the study: two "
    "one-sided tests, one against each limit.",
    "bayes_factors": "How much better a difference explains the data than none.",
}
_KNOWN = frozenset(
    {"alpha", "participants", "trials", "valid_trials", "is_simulated", "tests", "correlations", "enjoyment",
     "provenance", "warnings", "sensitivity", "choices_without_effect", "vigorous_times"}
)  # fmt: skip


def further(results: dict[str, Any]) -> tuple[Section, ...]:
    """Give a section to everything in the results that has none of its own."""
    ordered = [*_TITLES, *(key for key in results if key not in _TITLES)]
    return tuple(
        Section(
            title=_TITLES.get(key, titled(key)),
            blocks=(*_opening(key), *_flat(results[key])),
            sections=tuple(_entry(entry) for entry in _entries(results[key])),
        )
        for key in ordered
        if key not in _KNOWN and results.get(key)
    )


def _opening(key: str) -> tuple[Block, ...]:
    return (Paragraph(words=_OPENINGS[key]),) if key in _OPENINGS else ()


def _entries(value: Any) -> list[dict[str, Any]]:
    """Give the parts of a result that have a heading of their own."""
    entries = [entry for entry in (value if isinstance(value, list) else [value]) if isinstance(entry, dict)]
    return [] if _is_rows(entries) else entries


def _flat(value: Any) -> tuple[Block, ...]:
    """Give the parts that are rows of one table."""
    rows = [entry for entry in (value if isinstance(value, list) else []) if isinstance(entry, dict)]
    if not rows or not _is_rows(rows):
        return ()
    return (_table(rows, ""),)


def _is_rows(entries: list[dict[str, Any]]) -> bool:
    """Tell whether all are plain values; what was not computed has a heading."""
    failed = any(entry.get("not_computed_because") for entry in entries)
    return not failed and all(map(_is_flat, entries))


def _is_flat(entry: Mapping[str, Any]) -> bool:
    return not any(_is_nested(value) for value in entry.values())


def _is_nested(value: Any) -> bool:
    return isinstance(value, dict) or (
        isinstance(value, list) and bool(value) and all(isinstance(one, dict) for one in value)
    )


def _entry(entry: dict[str, Any]) -> Section:
    name = entry.get("name")
    about = with_unit(entry["outcome"]) if "outcome" in entry else ""
    title = f"{titled(name)}: {about}" if name and about else sentence(about) or titled(str(name or "Result"))
    if reason := entry.get("not_computed_because"):
        return Section(title=title, blocks=(Paragraph(words=f"Not computed: {reason}.", kind="warning"),))
    for is_its_kind, tell in _KINDS:
        if is_its_kind(entry):
            return Section(title=title, blocks=tuple(tell(entry)))
    rest = {key: value for key, value in entry.items() if key not in ("name", "outcome")}
    return Section(title=title, blocks=tuple(_blocks(rest)))


def _model(entry: Mapping[str, Any]) -> Iterator[Block]:
    """Tell a mixed model: its terms, the differences between levels, and how much people vary."""
    fit = entry["mixed_model"]
    yield _table(fit["terms"], "Terms of the model: does the outcome depend on them")
    order = ("period", "sequence", "carry")
    titles = {"means": "Estimated means", "differences": "Differences between levels, first minus second"}
    for key, title in titles.items():
        rows = [row for row in fit.get(key) or [] if not str(row["name"]).startswith(order)]
        if rows:
            yield _table(_untested(rows) if key == "means" else rows, title)
    yield Paragraph(
        words=f"{fit['n']} trials of {fit['participants']} participants; standard deviation between "
        "participants "
        f"{anything(fit['between_sd'])}, within {anything(fit['within_sd'])}. {sentence(fit['variant'])}. "
        f"Formula: {fit['formula']}.",
        kind="note",
    )
    yield from (
        Paragraph(words=f"{sentence(str(note))}.".replace("..", "."), kind="warning") for note in fit["notes"]
    )


def _untested(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Leave out the test that a mean is zero, which nobody asks."""
    return [{key: value for key, value in row.items() if key not in ("t", "p")} for row in rows]


def _notes(entry: Mapping[str, Any]) -> Iterator[Paragraph]:
    for note in entry.get("notes") or []:
        yield Paragraph(words=f"{sentence(str(note))}.".replace("..", "."), kind="warning")


def _order(entry: Mapping[str, Any]) -> Iterator[Block]:
    """Tell whether the order mattered; the model behind it stands in the results."""
    effects = entry["effects"]
    found = [effects[key] for key in ("period", "sequence", "carry_over") if effects.get(key)]
    if found:
        yield _table(found, "Period, sequence and carry-over")
    if effects.get("period_means"):
        yield _table(_untested(effects["period_means"]), "Means by period, other things equal")
    yield from _notes(effects.get("model") or {})


def _factorial(entry: Mapping[str, Any]) -> Iterator[Block]:
    """Tell the effects of factors after aligned ranks."""
    effects = entry["effects"]
    people = f"{effects[0]['n']} participants"
    if left_out := effects[0].get("left_out"):
        people += f"; left out for lack of a value: {', '.join(map(str, left_out))}"
    keys = ("effect", "f", "df", "p", "partial_eta_squared")
    table = _table([{key: effect.get(key) for key in keys} for effect in effects], "Effects of the factors")
    yield replace(table, note=f"{sentence(str(effects[0]['variant']))}. {people}.")


def _equivalence(entry: Mapping[str, Any]) -> Iterator[Block]:
    """Tell both ways to test equivalence, in the outcome's unit."""
    found, measure = entry["found"], unit(entry["outcome"])
    limits_said = f"between {anything(entry['low'])} and {anything(entry['high'])} {measure}".rstrip()
    kinds = (("by_t", "means (t)"), ("by_ranks", "signed ranks"))
    names = ("estimate", "interval", "p_low", "p_high", "p", "is_equivalent")
    rows = [{"by": words, **{name: found[key][name] for name in names}} for key, words in kinds]
    table = _table(rows, f"{condition(entry['a'])} − {condition(entry['b'])}: is it {limits_said}")
    methods = ". ".join(sentence(found[key]["method"]) for key, _ in kinds)
    yield replace(
        table,
        note=f"{found['n']} participants. p low, p high: against a difference at the lower and at the upper "
        "limit; "
        f"p: the larger of them. Interval: {percent(1.0 - 2.0 * found['alpha'], 0)}, as both tests together "
        f"need. {methods}.",
    )


def _curve(entry: Mapping[str, Any]) -> Iterator[Block]:
    """Tell where curves differ."""
    found = entry["found"]
    compared = listed([condition(name) for name in entry["conditions"]])
    counted = f"{found['n']} participants, {found['permutations']} permutations"
    told = f"{compared}: stretches above the threshold: {len(found['clusters'])}; "
    of_largest = f" of the largest {p_value(found['p'])}, {counted}."
    yield Paragraph(words=(told, italic("p"), of_largest), kind="result")
    if found["clusters"]:
        yield _table(found["clusters"], "Stretches in which the conditions differ")
    yield Paragraph(words=f"{sentence(found['method'])}.", kind="note")


_KINDS: tuple[
    tuple[Callable[[Mapping[str, Any]], bool], Callable[[Mapping[str, Any]], Iterator[Block]]], ...
] = (
    (lambda entry: bool(entry.get("mixed_model")), _model),
    (lambda entry: isinstance(entry.get("effects"), dict) and "period_means" in entry["effects"], _order),
    (lambda entry: isinstance(entry.get("effects"), list) and bool(entry["effects"]), _factorial),
    (lambda entry: isinstance(entry.get("found"), dict) and "by_ranks" in entry["found"], _equivalence),
    (lambda entry: isinstance(entry.get("found"), dict) and "clusters" in entry["found"], _curve),
)


def _blocks(entry: Mapping[str, Any], about: str = "") -> Iterator[Block]:
    """Turn nested results into a table of single values, then one table for each list within."""
    single = {k: v for k, v in entry.items() if not _is_nested(v) and v not in (None, [], {})}
    terms = {k: v for k, v in entry.items() if isinstance(v, dict) and _is_flat(v) and v}
    notes = [str(note) for note in single.pop("notes", [])]
    words = {key: value for key, value in single.items() if isinstance(value, str) and len(value) > 40}
    facts = {key: value for key, value in single.items() if key not in words}
    alike = [value for value in terms.values() if value.keys() == next(iter(terms.values())).keys()]
    if terms and len(alike) == len(terms) and "name" in alike[0]:
        yield _table(alike, about or "Tests.")
    else:
        for key, value in terms.items():
            yield _facts(value, titled(key))
    for key, value in entry.items():
        if isinstance(value, list) and _is_nested(value):
            yield _table(value, titled(key))
        elif isinstance(value, dict) and key not in terms:
            yield from _blocks(value, titled(key))
    if facts:
        yield _facts(facts, about or "In numbers")
    for key, told in words.items():
        yield Paragraph(words=f"{titled(key)}: {told}.".replace("..", "."), kind="note")
    for note in notes:
        yield Paragraph(words=sentence(note), kind="warning")


def _head(key: str) -> Words:
    return _SYMBOLS.get(key, sentence(key.replace("_", " ")))


def _effect(name: str) -> str:
    """Write an effect or an interaction as people read it."""
    return re.sub(r"(?<=\w):(?=\w)", " × ", name).replace("_", " ")


_WORDS: dict[str, Callable[[str], str]] = {
    "outcome": outcome,
    "a": condition,
    "b": condition,
    "condition": condition,
    "name": _effect,
    "effect": _effect,
}


_NUMBERS: dict[str, Callable[[Any], str]] = {
    **dict.fromkeys(("f", "t", "chi_squared"), number),
    **dict.fromkeys(("degrees_of_freedom", "denominator_df"), partial(number, decimals=1)),
    "partial_eta_squared": bounded,
}


def _cell(key: str, value: Any, places: int | None) -> str:
    """Write one value; estimates and what goes with them have as many decimals as their errors deserve."""
    if isinstance(value, str):
        return _WORDS.get(key, str)(value)
    if key == "p" or key.endswith("_p") or key.startswith("p_"):
        return p_cell(value) if isinstance(value, int | float) else anything(value)
    if key == "df" and isinstance(value, list):
        return ", ".join(anything(one) for one in value)
    if places is not None and key in ("estimate", "standard_error"):
        return number(value, places)
    if places is not None and key == "interval":
        return limits(value, places)
    return _NUMBERS.get(key, anything)(value)


def _places(rows: Iterable[Mapping[str, Any]]) -> int | None:
    """Tell how many decimals estimates deserve: two digits of the largest standard error."""
    errors = [row["standard_error"] for row in rows if isinstance(row.get("standard_error"), float)]
    return decimals_for(max(errors)) if errors else None


def _table(rows: list[dict[str, Any]], title: str) -> Table:
    """Set entries of one kind as the rows of a table; what no entry has is left out."""
    keys = [key for key in dict.fromkeys(key for row in rows for key in row) if _is_worth(rows, key)]
    long = [
        key for key in keys if all(isinstance(row.get(key), str) for row in rows) and _is_alike(rows, key)
    ]
    shown = [key for key in keys if key not in long or key == keys[0]]
    note = " ".join(f"{titled(key)}: {rows[0][key]}." for key in long if key != keys[0])
    places = _places(rows)
    words = {n for n, key in enumerate(shown) if any(isinstance(row.get(key), str) for row in rows)}
    return Table(
        title=f"{title.rstrip('.')}." if title else "Results.",
        head=tuple(_head(key) for key in shown),
        rows=tuple(tuple(_cell(key, row.get(key), places) for key in shown) for row in rows),
        text_columns=frozenset(words),
        note=note.replace("..", "."),
    )


def _is_worth(rows: list[dict[str, Any]], key: str) -> bool:
    return any(row.get(key) not in (None, [], {}) for row in rows)


def _is_alike(rows: list[dict[str, Any]], key: str) -> bool:
    """Tell whether all rows say the same in many words, which then stand once in the note."""
    return len(rows) > 1 and len({row.get(key) for row in rows}) == 1 and len(str(rows[0][key])) > 20


def _facts(values: Mapping[str, Any], title: str) -> Table:
    return Table(
        title=f"{title.rstrip('.')}.",
        head=("Quantity", "Value"),
        rows=tuple((_head(key), _cell(key, value, _places([values]))) for key, value in values.items()),
    )
