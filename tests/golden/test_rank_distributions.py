"""Exact p, both forms of Friedman's test and Hodges-Lehmann intervals against R, coin and exactRankTests."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import friedmanchisquare

from studykit.analysis.friedman import friedman
from studykit.analysis.skillings_mack import skillings_mack
from studykit.analysis.wilcoxon import hodges_lehmann, wilcoxon

R = json.loads((Path(__file__).parent / "rank_distributions.json").read_text())
ALTERNATIVES = ("two-sided", "greater", "less")


def statistic(value: Any) -> Any:
    return pytest.approx(value, rel=1e-8, abs=1e-8)


def exactly(value: Any) -> Any:
    return pytest.approx(value, rel=0.0, abs=1e-10)


def cases(kind: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("case", list(R[kind].values()), ids=list(R[kind]))


@cases("signed_ranks")
@pytest.mark.parametrize("zeros", ["drop", "pratt"])
def test_signed_ranks_equal_coin(case: dict[str, Any], zeros: Any) -> None:
    differences = np.array(case["differences"])
    for alternative in ALTERNATIVES:
        result = wilcoxon(differences, np.zeros(len(differences)), zeros=zeros, alternative=alternative)
        assert result.z == statistic(case["coin"][zeros]["z"])
        assert result.p == exactly(case["coin"][zeros][alternative.replace("-", "_")])


@cases("signed_ranks")
def test_signed_ranks_equal_exact_rank_tests(case: dict[str, Any]) -> None:
    result = wilcoxon(case["differences"], np.zeros(len(case["differences"])))
    assert result.w_plus == case["v"]
    assert result.p == exactly(case["p"])


@cases("signed_ranks")
def test_the_shift_equals_r_where_r_is_exact(case: dict[str, Any]) -> None:
    shift = hodges_lehmann(case["differences"])
    assert ("at least" in shift.method) == case["tied"]
    if case["tied"]:
        return
    assert shift.estimate == statistic(case["estimate"])
    assert shift.interval == statistic(tuple(case["interval"]))
    assert (shift.estimate, *shift.interval) == statistic(tuple(case["exact_rank_tests"]))
    narrower = hodges_lehmann(case["differences"], confidence=0.9)
    assert narrower.interval == statistic(tuple(case["interval_90"]))


@cases("friedman")
def test_friedmans_test_equals_r_in_all_forms(case: dict[str, Any]) -> None:
    table = np.array(case["table"])
    result = friedman(table, rng=np.random.default_rng(1), draws=99)
    assert result.chi_squared == statistic(case["chi_squared"]) == statistic(case["coin_chi_squared"])
    assert (result.p, result.f, result.f_p) == statistic((case["p"], case["f"], case["f_p"]))
    assert result.chi_squared == statistic(float(friedmanchisquare(*table.T).statistic))
    people, conditions = table.shape
    assert result.f_degrees_of_freedom == (conditions - 1, (conditions - 1) * (people - 1))
    if case["exact_p"]:
        assert result.permutation_p == exactly(case["exact_p"])
        assert result.permutation_p_interval is None


@cases("skillings_mack")
def test_skillings_and_macks_test_equals_the_paper_written_out_in_r(case: dict[str, Any]) -> None:
    result = skillings_mack(np.array(case["table"], dtype=float), rng=np.random.default_rng(1), draws=99)
    assert (result.statistic, result.p) == statistic((case["statistic"], case["p"]))
    assert result.degrees_of_freedom == case["df"]


def test_the_published_assembly_times() -> None:
    # Skillings & Mack 1981: SM = 15.493 with 3 degrees of freedom.
    table = np.array(R["skillings_mack"]["assembly_times"]["table"], dtype=float)
    result = skillings_mack(table, rng=np.random.default_rng(1), draws=99)
    assert (round(result.statistic, 3), result.degrees_of_freedom) == (15.493, 3)
