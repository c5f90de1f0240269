"""What must hold of tests of equivalence and of Bayes factors whatever the data."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import integrate, stats

from studykit.analysis.bayes import bayes_factor, evidence
from studykit.analysis.equivalence import equivalence
from studykit.core.errors import InputError

seeds = st.integers(0, 2**32 - 1)


@settings(deadline=None, max_examples=50)
@given(seeds, st.integers(6, 30), st.floats(0.1, 3.0))
def test_conditions_are_equivalent_when_the_interval_lies_within_the_bounds(
    seed: int, people: int, bound: float
) -> None:
    a, b = np.random.default_rng(seed).normal(size=(2, people))
    found = equivalence(a, b, low=-bound, high=bound)
    for kind in (found.by_t, found.by_ranks):
        assert kind.is_equivalent == (-bound < kind.interval[0] and kind.interval[1] < bound)
        assert kind.is_equivalent == (kind.p < 0.05)


@settings(deadline=None, max_examples=20)
@given(seeds, st.integers(-5, 5))
def test_swapping_conditions_mirrors_everything(seed: int, shift: int) -> None:
    # Whole numbers: ties must stay ties when a bound is taken off.
    a, b = np.random.default_rng(seed).integers(0, 9, size=(2, 12)) * 0.1
    b[0] = a[0] + 1.3
    first = equivalence(a + 0.1 * shift, b, low=-0.4, high=0.7)
    second = equivalence(b, a + 0.1 * shift, low=-0.7, high=0.4)
    for ours, other in ((first.by_t, second.by_t), (first.by_ranks, second.by_ranks)):
        assert (ours.p_low, ours.p_high) == pytest.approx((other.p_high, other.p_low))
        assert ours.interval == pytest.approx((-other.interval[1], -other.interval[0]))


def test_conditions_that_differ_by_a_bound_are_called_equivalent_as_rarely_as_alpha() -> None:
    rng = np.random.default_rng(1)
    called = np.array(
        [
            [found.by_t.is_equivalent, found.by_ranks.is_equivalent]
            for found in (
                equivalence(rng.normal(1.0, 0.5, 16), np.zeros(16), low=-1.0, high=1.0) for _ in range(1500)
            )
        ]
    ).mean(axis=0)
    # Two standard errors of 1,500 draws are 1.1 %.
    assert np.all(called <= 0.061)
    assert np.all(called >= 0.035)
    # Wrong on purpose: "no significant difference from zero", taken for equivalence, errs far more often.
    silent = np.mean([stats.ttest_1samp(rng.normal(0.4, 1.0, 16), 0.0).pvalue > 0.05 for _ in range(500)])
    assert silent > 0.061


def test_bounds_and_data_that_make_no_sense_are_refused() -> None:
    a = np.array([1.0, 2.0, 4.0])
    with pytest.raises(InputError, match="is not below the upper bound"):
        equivalence(a, a, low=1.0, high=-1.0)
    with pytest.raises(InputError, match="all participants have the same difference"):
        equivalence(a, a - 1.0, low=-1.0, high=1.0)
    with pytest.raises(ValueError, match="two values or more"):
        equivalence(a[:1], a[:1], low=-1.0, high=1.0)


@pytest.mark.parametrize(("effect", "people"), [(0.0, 20), (0.3, 12), (1.0, 20), (3.0, 8)])
def test_a_bayes_factor_is_the_mean_likelihood_over_the_prior(effect: float, people: int) -> None:
    # Not Rouder's formula but what it stands for: noncentral t over a Cauchy prior of the effect.
    differences = stats.zscore(np.random.default_rng(people).normal(size=people), ddof=1) + effect
    t = stats.ttest_1samp(differences, 0.0).statistic
    mean = integrate.quad(
        lambda size: (
            stats.nct.pdf(t, people - 1, size * np.sqrt(people)) * stats.cauchy.pdf(size, scale=0.707)
        ),
        -10.0,
        10.0,
        points=[0.0, effect],
        limit=200,
    )[0]
    expected = mean / stats.t.pdf(t, people - 1)
    assert bayes_factor(differences, np.zeros(people)) == pytest.approx(expected, rel=1e-3)


def test_a_published_bayes_factor() -> None:
    # pingouin's documentation, checked there against R's BayesFactor: t = 3.5 of 20 pairs gives 17.185.
    differences = stats.zscore(np.random.default_rng(2).normal(size=20), ddof=1) + 3.5 / np.sqrt(20.0)
    factor = bayes_factor(differences, np.zeros(20))
    assert factor == pytest.approx(17.185, abs=5e-4)
    assert bayes_factor(np.zeros(20), differences) == pytest.approx(factor)
    assert evidence(factor) == "strong evidence for a difference"


def test_evidence_is_weighed_alike_on_both_sides() -> None:
    assert evidence(1.0) == "anecdotal evidence for a difference"
    assert evidence(1.0 / 50.0) == "very strong evidence for no difference"
    assert evidence(1000.0) == "extreme evidence for a difference"
    with pytest.raises(ValueError, match="all differences are alike"):
        bayes_factor(np.ones(4), np.zeros(4))
    with pytest.raises(ValueError, match="two values or more"):
        bayes_factor(np.ones(1), np.zeros(1))
