"""How it was done, in the words of a methods section, and where every number comes from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from studykit.reports.document import Block, Paragraph, Section, Table, listed
from studykit.reports.naming import condition, outcome, titled, unit
from studykit.reports.numbers import bounded, number, percent

if TYPE_CHECKING:
    from studykit.protocol.analysis_plan import AnalysisPlan
    from studykit.reports.material import Material

_CORRECTED = {
    "holm": "corrected by Holm’s method", "bonferroni": "corrected by Bonferroni’s method",
    "closed": "corrected by closed testing", "none": "not corrected",
}  # fmt: skip


_METHODS = {
    "mixed_model": "mixed model with a level a participant, period and carry-over; standard errors robust to "
    "participants who respond differently",
    "aligned_ranks": "aligned rank transform",
}


_MAXIMA = {"tanaka": "208 − 0.7 × age, Tanaka et al. 2001", "fox": "220 − age, Fox et al. 1971"}
_WINDOWS = {"perform": "", "perform+30": " and in the 30 s after"}


def methods(material: Material, results: dict[str, Any], agreeing: int) -> Section:
    """Write the methods from the protocol, the dances and the versions used.

    Parameters
    ----------
    material : Material
        The study and its trials.
    results : dict
        The content of `results.json`.
    agreeing : int
        How many numbers were found again before the report was written.
    """
    protocol = material.protocol
    conditions = len(protocol.conditions_list())
    watched = protocol.session.watch_repetitions
    times = "once" if watched == 1 else f"{watched} times"
    design = Paragraph(
        words=f"Within-subject crossover: each of {protocol.study.participants} planned participants "
        "performs "
        f"{conditions} conditions of {number(protocol.dance.duration_s, 0)} s, in an order drawn by lot "
        "from a "
        f"{protocol.order.design.capitalize()} square (seed {protocol.study.seed}), each preceded by "
        "watching the "
        f"dance {times} and followed by "
        f"{number(protocol.session.rest_s, 0)} s "
        "of rest. The protocol was fixed before the first visit; its digest stands in every record."
    )
    measures = Paragraph(
        words="Movement of dancer and guide is compared joint by joint after moving the pelvis to the "
        "origin, "
        "giving both bodies limbs of equal length and turning the dancer, once, to the front that fits the "
        "whole "
        f"dance best, with dynamic time warping within ±{number(protocol.movement.band_s, 1)} s; the "
        "distance is the "
        "mean over aligned frames. Mean heart rate is weighted by the time for which each reading stood; "
        "silences "
        f"of the belt longer than {number(protocol.heart_rate.longest_gap_s, 0)} s count for nothing. "
        "Intensity is "
        f"vigorous at or above {percent(protocol.heart_rate.vigorous_fraction, 0)} of the "
        f"maximum predicted from age ({_MAXIMA[protocol.heart_rate.maximum]}). The heart rate counts while "
        f"the dance is performed{_WINDOWS[protocol.heart_rate.window]}."
    )
    return Section(
        title="Methods",
        sections=(
            Section(title="Design and measures", blocks=(design, measures, _dances(material))),
            Section(title="Analysis as declared", blocks=tuple(_declared(protocol.analysis))),
            Section(
                title="Provenance",
                blocks=(_checked(agreeing), _provenance(material, results), *_visits(results)),
            ),
        ),
    )


def _dances(material: Material) -> Paragraph:
    shown = material.dances.values()
    presets, seeds = sorted({dance.preset for dance in shown}), sorted({dance.seed for dance in shown})
    aims = {dance.targets_from for dance in shown}
    dance = material.protocol.dance
    text = (
        f"The dances were searched for with the preset {listed(presets)} (seed "
        f"{listed([str(s) for s in seeds])}); "
    )
    if aims == {"raters"}:
        text += (
            "energies and varieties aim at what raters of the library called light and intense, easy "
            "and hard."
        )
    elif aims == {"percentiles"}:
        text += (
            f"energies aim at percentiles {number(dance.intensity.light, 0)} (light) and "
            f"{number(dance.intensity.intense, 0)} (intense) of random dances from the same library, "
            "varieties at "
            f"{number(dance.variety.easy)} (easy) and {number(dance.variety.hard)} (hard) of the median "
            "distance "
            "between unrelated segments."
        )
    else:
        text += "what they aim at stands in the table of the dances."
    return Paragraph(words=text)


def _declared(plan: AnalysisPlan) -> list[Block]:
    blocks: list[Block] = [
        Paragraph(
            words=f"{titled(test.name)}: {outcome(test.outcome)} is compared between "
            f"{len(test.conditions)} "
            f"conditions by Friedman’s test, then {len(test.pairs_list())} pairs by Wilcoxon’s "
            "signed-rank test "
            f"with exact p, {_CORRECTED.get(test.correction, test.correction)}."
        )
        for test in plan.tests
    ]
    for one in plan.correlations:
        across = " plus ".join(outcome(name) for name in one.x)
        kind = (
            "within people (repeated measures)" if one.method == "repeated_measures" else "pooled (Pearson)"
        )
        blocks.append(
            Paragraph(words=f"{titled(one.name)}: {outcome(one.y)} is correlated with {across}, {kind}.")
        )
    level = (
        f"Level of significance {bounded(plan.alpha)}, two-sided. Nothing that is not declared is "
        f"called a result."
    )
    return [*blocks, *_further(plan), Paragraph(words=level)]


def _visits(results: dict[str, Any]) -> list[Block]:
    visits = results["provenance"].get("visits") or {}
    table = Table(
        title="Digest (SHA-256) of what was recorded in each visit.",
        head=("Visit", "Digest"),
        rows=tuple((str(name), str(digest)) for name, digest in visits.items()),
        text_columns=frozenset({1}),
    )
    return [table] if visits else []


def _checked(agreeing: int) -> Paragraph:
    return Paragraph(
        words=f"Before this report was written, {agreeing} of its numbers were found again, from the trials "
        "or from "
        "the numbers beside them: counts, means and medians, ranks, chi-squared and p from statistics, "
        "effect sizes, "
        "corrected p, intervals around their estimates. All agree; otherwise there would be no report."
    )


def _further(plan: AnalysisPlan) -> list[Block]:
    """Tell the models, equivalence tests and curves that were declared."""
    said = [
        f"{titled(one.name)}: {outcome(one.outcome)} is explained by {listed(list(one.factors))} with all "
        "their "
        f"interactions ({_METHODS.get(one.method, one.method)})."
        for one in plan.models or ()
    ]
    said += [
        f"{titled(one.name)}: {condition(one.a)} and {condition(one.b)} are the same in "
        f"{outcome(one.outcome)} if "
        f"they differ by {number(one.low, 2)} to {number(one.high, 2)} {unit(one.outcome)} (two one-sided "
        "tests)."
        for one in plan.equivalences or ()
    ]
    said += [
        f"{titled(one.name)}: {one.curve.replace('_', ' ')} over time is compared between "
        f"{len(one.conditions)} "
        "conditions by a cluster permutation test."
        for one in plan.curves or ()
    ]
    return [Paragraph(words=words) for words in said]


def _provenance(material: Material, results: dict[str, Any]) -> Table:
    found = results["provenance"]
    shown = material.dances.values()
    rows = [
        (titled(key).replace("sha256", "(SHA-256)"), str(value))
        for key, value in found.items()
        if isinstance(value, str)
    ]
    rows += [
        ("Dance library (SHA-256)", listed(sorted({dance.library_sha256 for dance in shown}))),
        ("Licences of the movement", listed(sorted({s.licence for dance in shown for s in dance.segments}))),
        ("Seed of the order", str(material.protocol.study.seed)),
        ("Seed of permutations and bootstrap", "0, with the name of the test"),
        ("Seeds of the dances", listed([str(seed) for seed in sorted({dance.seed for dance in shown})])),
        ("Versions", ", ".join(f"{name} {version}" for name, version in found["versions"].items())),
    ]
    return Table(
        title="Where every number comes from.",
        head=("What", "Digest, seed or version"),
        rows=tuple(rows),
        text_columns=frozenset({1}),
        note="Digests name the exact content of files. The same recordings, protocol and versions give the "
        "same "
        "bytes of this report.",
    )
