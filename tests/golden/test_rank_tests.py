"""Friedman, Kendall's W, Wilcoxon and corrections against R, coin, SciPy's and pingouin's documentation."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from studykit.analysis.friedman import Friedman, friedman
from studykit.analysis.multiplicity import bonferroni, holm
from studykit.analysis.wilcoxon import Wilcoxon, wilcoxon

HERE = Path(__file__).parent / "rank_tests.json"
NAMES = ("rounding_times", "pulse", "wine")
ORIGINS = ("here", "shared")


def exactly(value: Any) -> Any:
    return pytest.approx(value, rel=1e-9, abs=0.0)


@pytest.fixture
def case(request: pytest.FixtureRequest, shared_data: Callable[[str], Path]) -> dict[str, Any]:
    """One table with its numbers, from the file beside this test or from the real data."""
    origin, name = request.param
    if origin == "here":
        return json.loads(HERE.read_text())["repeated_measures"][name]
    folder = shared_data("questionnaires")
    found = json.loads((folder / "expected_statistics.json").read_text())["repeated_measures"][name]
    return found | {"table": pd.read_csv(folder / found["file"]).to_dict("list")}


every_case = pytest.mark.parametrize("case", [(o, n) for o in ORIGINS for n in NAMES], indirect=True, ids=str)


def check_friedman(case: dict[str, Any], test: Callable[..., Friedman]) -> None:
    result = test(np.column_stack(list(case["table"].values())), rng=np.random.default_rng(1))
    assert result.chi_squared == exactly(case["friedman"]["chi_squared"])
    assert result.degrees_of_freedom == case["friedman"]["df"] == case["k_conditions"] - 1
    assert result.p == exactly(case["friedman"]["p"])
    assert result.kendalls_w == exactly(case["kendalls_w"])
    assert result.mean_ranks == exactly(tuple(case["mean_ranks"]))
    assert result.n == case["n_blocks"]


def check_wilcoxon(case: dict[str, Any], test: Callable[..., Wilcoxon]) -> None:
    for pair in case["pairs"]:
        a, b = (np.array(case["table"][pair[side]]) for side in "ab")
        exact, normal = test(a, b), test(a, b, p="normal")
        pratt = test(a, b, p="normal", zeros="pratt")
        assert exact.w_plus == pair["W_plus"]
        assert exact.w_minus == pair["W_minus"]
        assert exact.n_nonzero == pair["n_nonzero"]
        assert exact.rank_biserial == exactly(pair["rank_biserial"])
        assert exact.z == normal.z == exactly(pair["Z_wilcoxon_zeros_dropped"])
        assert pratt.z == exactly(pair["Z_pratt"])
        assert exact.p == exactly(pair["p_exact"])
        assert normal.p == exactly(pair["p_asymptotic"])
        assert test(a, b, p="normal_continuity").p == exactly(pair["p_asymptotic_continuity"])
        assert pratt.p == exactly(pair["p_pratt"])


@every_case
def test_friedman_and_kendalls_w_equal_r(case: dict[str, Any]) -> None:
    check_friedman(case, friedman)


@every_case
def test_every_variant_of_wilcoxon_equals_r(case: dict[str, Any]) -> None:
    check_wilcoxon(case, wilcoxon)


@every_case
def test_corrections_equal_r(case: dict[str, Any]) -> None:
    pairs, adjusted = case["pairs"], case["adjusted"]
    continuity = [pair["p_asymptotic_continuity"] for pair in pairs]
    exact = [pair["p_exact"] for pair in pairs]
    found = {
        "bonferroni_of_p_asymptotic_continuity": bonferroni(continuity),
        "holm_of_p_asymptotic_continuity": holm(continuity),
        "bonferroni_of_p_exact": bonferroni(exact),
    }
    for name, values in found.items():
        assert values.tolist() == exactly(adjusted[name])


def paired(origin: str, shared_data: Callable[[str], Path]) -> dict[str, Any]:
    path = HERE if origin == "here" else shared_data("questionnaires/expected_statistics.json")
    return json.loads(path.read_text())["paired"]


@pytest.mark.parametrize("origin", ORIGINS)
def test_paired_examples_equal_r_and_scipy(origin: str, shared_data: Callable[[str], Path]) -> None:
    depression, maize = (paired(origin, shared_data)[name] for name in ("depression", "maize"))
    a, b = depression["x"], depression["y"]
    assert wilcoxon(a, b).w_plus == depression["expected"]["V"]
    assert wilcoxon(a, b).p == exactly(depression["expected"]["p_exact_two_sided"])
    assert wilcoxon(a, b, alternative="greater").p == exactly(depression["expected"]["p_exact_greater"])
    differences, zeros, expected = maize["d"], np.zeros(len(maize["d"])), maize["expected"]
    result = wilcoxon(differences, zeros)
    assert (result.w_plus, result.w_minus) == (expected["V"], expected["smaller_rank_sum"])
    assert result.p == exactly(expected["p_exact_two_sided"])
    assert wilcoxon(differences, zeros, alternative="greater").p == exactly(expected["p_exact_greater"])
    # The file prints this one number with seven digits.
    assert wilcoxon(differences, zeros, p="normal").p == pytest.approx(
        expected["p_asymptotic_two_sided"], abs=5e-9
    )


def test_rank_sums_30_40_60_70_give_chi_squared_30_and_w_one_half() -> None:
    table = np.array([(2, 1, 4, 3)] * 10 + [(1, 3, 2, 4)] * 10)
    assert table.sum(axis=0).tolist() == [30, 40, 60, 70]
    result = friedman(10.0 * table, rng=np.random.default_rng(1))
    assert result.chi_squared == exactly(30.0)
    assert result.degrees_of_freedom == 3
    assert result.kendalls_w == exactly(0.5)


# What follows is wrong on purpose: the checks above must notice.


def friedman_without_correction_for_ties(table: np.ndarray, *, rng: np.random.Generator) -> Friedman:
    ranks = stats.rankdata(table, axis=1)
    n, k = ranks.shape
    chi_squared = float(12.0 / (n * k * (k + 1)) * np.sum(ranks.sum(axis=0) ** 2) - 3 * n * (k + 1))
    return replace(
        friedman(table, rng=rng), chi_squared=chi_squared, p=float(stats.chi2.sf(chi_squared, k - 1))
    )


def wilcoxon_exact_as_if_untied(a: np.ndarray, b: np.ndarray, **options: Any) -> Wilcoxon:
    right = wilcoxon(a, b, **options)
    if options:
        return right
    sums = np.convolve([1.0], [1.0])
    for rank in range(1, right.n_nonzero + 1):
        sums = np.convolve(sums, [0.5, *[0.0] * (rank - 1), 0.5])
    found = int(right.w_plus)
    return replace(right, p=min(1.0, 2.0 * min(sums[found:].sum(), sums[: found + 1].sum())))


with_ties = pytest.mark.parametrize(
    "case", [("here", "rounding_times"), ("here", "wine")], indirect=True, ids=str
)


@with_ties
def test_friedman_without_correction_for_ties_is_caught(case: dict[str, Any]) -> None:
    with pytest.raises(AssertionError):
        check_friedman(case, friedman_without_correction_for_ties)


@with_ties
def test_the_exact_distribution_without_ties_is_caught(case: dict[str, Any]) -> None:
    with pytest.raises(AssertionError):
        check_wilcoxon(case, wilcoxon_exact_as_if_untied)
