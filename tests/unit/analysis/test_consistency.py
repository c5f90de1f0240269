"""Printed numbers held against each other: what is right is never called wrong, what is wrong is found."""

from __future__ import annotations

from contextlib import suppress
from itertools import permutations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from studykit.analysis.consistency import Finding, attainable, check_text
from studykit.analysis.consistency.claims import Printed, claims
from studykit.analysis.consistency.published import example
from studykit.core.errors import InputError


def wrong(text: str) -> list[str]:
    """Give the kinds of what cannot be true."""
    return [finding.kind for finding in check_text(text) if not finding.is_consistent]


def found(text: str, kind: str) -> Finding:
    return next(finding for finding in check_text(text) if finding.kind == kind)


@pytest.mark.parametrize(
    "text",
    [
        # From the documentation of R's friedman.test and wilcox.test, and of SciPy's wilcoxon.
        "Friedman chi2(2)=11.143, p=.003805, W=.2532, n=22",
        "Friedman chi2(2)=10.571, p=.0050634, W=.7551, n=7",
        "V=40, n=9, p=.01953, one-sided",
        "V=24, n=15, p=.04126",
        # Worked cases of the statcheck manual's kind
        "t(28)=2.20, p=.036",
        "t(28)=2.20, p=.018, one-sided",
        "F(2, 67)=3.18, p<.05",
        "z=1.96, p=.05",
        "r(48)=.30, p=.034",
        "χ²(1, N=90)=6.53, p=.011",
        r"$\chi^2(3) = 30.00, p < 0.001, W = 0.50$",
        "t(9)=0.04, ns",
        "t=-2.10, n=20, p=.049",
        "z=-3.052, r=.64, n=23",
        "Wilcoxon, n=6, p=.031",
        "M=5.18, SD=1.19, n=28, items=1, scale=1-7",
        "17/20=85%; 17 of 20 (85 %); 12+8=20; 85%, n=20; 1.1 + 2.2 = 3.4",
        "items=18, scale=1-7, 85 %",
        "Friedman chi2(3)=7.80, n=10, p=.02, exact",
    ],
)
def test_what_fits_together_is_left_alone(text: str) -> None:
    assert wrong(text) == []


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("chi2(3)=30.00, p=.01", "p against chi2"),
        ("F(3, 57)=4.20, p=.02", "p against F"),
        ("t(28)=2.20, p=.018", "p against t"),
        ("z=1.96, p=.025", "p against z"),
        ("r=.883, p<.001, n=4", "p against r"),
        ("r=.897, p=.031", "r"),
        ("r=1.2, p=.03, n=9", "r"),
        ("r(20)=.5, n=20, p=.018", "degrees of freedom"),
        ("z=-3.05, r=.80, n=23", "r against z"),
        ("p=1.2; t(9)=2.0, p=.077", "p"),
        ("chi2(3)=30.00, W=0.60, n=20", "W against chi2"),
        ("chi2(3)=30.00, W=0.422", "W against chi2"),
        ("chi2(3)=61.00, W=1.02, n=20", "rank table"),
        ("Friedman chi2(2)=5.90, n=7, no ties", "rank table"),
        ("Friedman chi2(3)=30.00, n=20, separated=2+2", "separation"),
        ("V=50, n=9, p=.5", "signed ranks"),
        ("V=40, n=9, p=.02", "p against signed ranks"),
        ("Wilcoxon, pairs=6, Bonferroni, p<.01, n=8", "smallest p"),
        ("Wilcoxon, n=5, p=.031", "smallest p"),
        ("M=5.19, SD=1.20, n=28, items=1", "GRIM"),
        ("M=5.18, SD=1.20, n=28, items=1", "GRIMMER"),
        ("M=7.50, n=20, scale=1-7", "scale"),
        ("M=4.00, SD=3.50, n=20, scale=1-7", "scale"),
        ("66.17%, n=640", "percentage"),
        ("16/20=85%", "percentage"),
        ("vigorous=73.67 % of 32 s, age=25.3, rest=80, tau=30", "time above a threshold"),
        ("12+9=20", "sum"),
    ],
)
def test_what_cannot_be_true_is_found(text: str, kind: str) -> None:
    assert kind in wrong(text)


@settings(max_examples=60, deadline=None)
@given(t=st.floats(-6.0, 6.0), df=st.integers(2, 200), t_digits=st.integers(1, 3), p_digits=st.integers(2, 4))
def test_rounding_alone_is_never_called_wrong(t: float, df: int, t_digits: int, p_digits: int) -> None:
    p = 2.0 * stats.t.sf(abs(t), df)
    assert wrong(f"t({df})={t:.{t_digits}f}, p={p:.{p_digits}f}") == []
    r = t / np.sqrt(t * t + df)
    assert wrong(f"r({df})={r:.{t_digits}f}, n={df + 2}, p={p:.{p_digits}f}") == []


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 30), k=st.integers(3, 8))
def test_friedman_of_real_ranks_is_never_called_wrong(seed: int, n: int, k: int) -> None:
    ranks = np.array([np.random.default_rng((seed, i)).permutation(k) + 1 for i in range(n)])
    chi2 = 12.0 / (n * k * (k + 1)) * ((ranks.sum(axis=0) - n * (k + 1) / 2.0) ** 2).sum()
    p, w = stats.chi2.sf(chi2, k - 1), chi2 / (n * (k - 1))
    text = f"Friedman chi2({k - 1})={chi2:.2f}, p={p:.3f}, W={w:.2f}, n={n}, no ties"
    assert wrong(text) == []
    assert wrong(text.replace(f", n={n}", "")) == []


@settings(max_examples=80, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 40), items=st.integers(1, 18))
def test_real_answers_are_never_called_wrong(seed: int, n: int, items: int) -> None:
    means = np.random.default_rng(seed).integers(1, 8, size=(n, items)).mean(axis=1)
    text = f"M={means.mean():.2f}, SD={means.std(ddof=1):.2f}, n={n}, items={items}, scale=1-7"
    assert wrong(text) == []


def test_grim_refuses_just_the_means_between_the_points_of_the_grid() -> None:
    means = [f"{hundredths / 100:.2f}" for hundredths in range(100, 701)]
    possible = [mean for mean in means if not wrong(f"M={mean}, n=20, items=1")]
    assert possible == [mean for mean in means if mean[-1] in "05"]


@pytest.mark.parametrize(("n", "k"), [(2, 3), (3, 3), (4, 3), (5, 3), (2, 4), (3, 4)])
def test_the_rank_tables_tried_are_all_there_are(n: int, k: int) -> None:
    orders = np.array(list(permutations(range(1, k + 1))))
    # The first person's order is only a naming of the conditions.
    others = product(range(len(orders)), repeat=n - 1)
    sums = np.array([orders[0] + orders[list(rows)].sum(axis=0) for rows in others])
    real = {round(4.0 * s) for s in ((sums - n * (k + 1) / 2.0) ** 2).sum(axis=1)}
    scale = 12.0 / (n * k * (k + 1))
    quarters = range(4 * n * n * k * k)
    claimed = {s for s in quarters if attainable.friedman_without_ties(n, k, *[s / 4 * scale] * 2)}
    assert claimed == real


def test_more_conditions_keep_to_the_parity_of_the_sums() -> None:
    rng = np.random.default_rng(3)
    for n, k in ((4, 5), (5, 6), (3, 8)):
        for _ in range(50):
            sums = sum(rng.permutation(k) + 1 for _ in range(n))
            chi2 = 12.0 / (n * k * (k + 1)) * float(((sums - n * (k + 1) / 2.0) ** 2).sum())
            assert attainable.friedman_without_ties(n, k, chi2, chi2)
            step = 12.0 / (n * k * (k + 1))
            assert not attainable.friedman_without_ties(n, k, chi2 + step, chi2 + step)


@pytest.mark.parametrize("n", [1, 2, 5, 9])
def test_signed_ranks_are_those_of_all_signs(n: int) -> None:
    sums = np.array([np.dot(signs, range(1, n + 1)) for signs in product((0, 1), repeat=n)])
    chances = attainable.signed_rank_probabilities(n)
    assert chances == pytest.approx(np.bincount(sums) / 2**n, abs=1e-15)
    for v in range(n * (n + 1) // 2 + 1):
        tail = min(np.mean(sums <= v), np.mean(sums >= v))
        assert attainable.signed_rank_p(v, n) == pytest.approx(min(1.0, 2.0 * tail), abs=1e-14)


def test_how_many_may_differ_the_other_way() -> None:
    assert attainable.most_against(20, 0.01) == 8
    assert attainable.most_against(20, 0.01 / 6) == 6
    assert attainable.most_against(5, 0.05) is None
    assert attainable.signed_rank_p(36, 20) < 0.01 < attainable.signed_rank_p(45, 20)


def test_the_numbers_of_the_paper_are_judged_one_by_one() -> None:
    findings = check_text(example())
    assert len(findings) == 18
    assert [(f.kind, f.claim.rpartition(": ")[2]) for f in findings if not f.is_consistent] == [
        ("separation", "Friedman chi2(3)=30.00, n=20, separated=2+2"),
        ("p against r", "r=.883, p<.001, n=4"),
        ("r", "r=.897, p=.031"),
        ("time above a threshold", "vigorous=73.67 % of 32 s, age=25.3, rest=80, tau=30"),
    ]
    said = {finding.kind: finding.words for finding in findings}
    assert "total of 107.1 as a share of the highest one (126), but 109.8" in said["percentage of a scale"]
    assert "may have been copied" in said["repeated chi2"]
    assert found("r=.883, p<.001", "r").recomputed[0] == 10
    assert found("Friedman chi2(3)=30.00, n=20, separated=2+2", "separation").recomputed[0] == 48.0
    assert found("chi2(7)=18.53, p<.01, n=20", "p against chi2").recomputed == pytest.approx(
        (0.0098, 0.0098), abs=1e-4
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("hello", '"hello" cannot be read'),
        ("", "there is no claim"),
        ("# only a remark", "there is no claim"),
        ("chi2(3)=30.00", "nothing in it can be held against anything else"),
        ("chi2=30.00, p=.01", "degrees of freedom of chi2 are missing"),
        ("F(3)=4.2, p=.01", "F(3, 57)=4.20"),
        ("t(x)=2.1, p=.04", '"(x)" cannot be read'),
        ("p=.01, p=.02, z=2", "p is given twice"),
        ("V=40, p=.04", "needs n"),
        ("chi2(3)=30.0, W=.5, n=20.5", "n = 20.5 is no count"),
        ("r=.5, p=.1, n=2", "three points or more"),
        ("chi2(3)=30, n=20, Friedman, separated=2+3", "are not the 4 of chi2"),
        ("vigorous=70 % of 32 s, age=25, rest=80, tau=0", "must be above zero"),
        ("q(3)=2.1, p=.04", '"q" is no statistic known here'),
    ],
)
def test_what_cannot_be_read_is_said_with_the_notation(text: str, said: str) -> None:
    with pytest.raises(InputError) as refused:
        check_text(text)
    assert said in str(refused.value)


TOKENS = (
    *(
        "chi2(3)",
        "chi2(0)",
        "F(1, 2)",
        "t(9)",
        "t",
        "z",
        "r",
        "W",
        "V",
        "T",
        "p",
        "n",
        "M",
        "SD",
        "items",
        "scale",
    ),
    *(
        "separated",
        "pairs",
        "vigorous",
        "of 32 s",
        "age",
        "rest",
        "tau",
        "=",
        "=",
        "=",
        "<",
        ">",
        "%",
        "+",
        "-",
    ),
    *(
        ",",
        ",",
        ";",
        ":",
        "0",
        "1",
        "20",
        "0.5",
        ".031",
        "-2",
        "1e9",
        "1e-99",
        "999999999999999",
        "1-7",
        "2+2",
    ),
    *("Wilcoxon", "Friedman", "Bonferroni", "no ties", "one-sided", "exact", "(", ")", "\u03c7\u00b2", "nan"),
)


@settings(max_examples=400, deadline=None)
@given(st.lists(st.sampled_from(TOKENS), max_size=14))
def test_whatever_is_typed_is_judged_or_refused(tokens: list[str]) -> None:
    with suppress(InputError):
        check_text(" ".join(tokens))


@settings(max_examples=200, deadline=None)
@given(
    st.dictionaries(
        st.sampled_from(
            ("chi2(3)", "F(2, 9)", "t(4)", "z", "r", "W", "V", "p", "n", "M", "SD", "items", "pairs")
        ),
        st.sampled_from(("0", "1", "-1", "0.5", ".031", "7", "20", "1e15", "1e-99", "999999999999999")),
        min_size=2,
    ),
    st.sampled_from(("", ", Wilcoxon", ", Friedman", ", scale=1-7", ", scale=7-1", ", 85 %", ", no ties")),
)
def test_odd_numbers_in_good_notation_are_judged_or_refused(numbers: dict[str, str], more: str) -> None:
    with suppress(InputError):
        check_text(", ".join(f"{name}={value}" for name, value in numbers.items()) + more)


def test_a_printed_number_stands_for_an_interval() -> None:
    assert (Printed.read("30.0").low, Printed.read("30.0").high) == (29.95, 30.05)
    (claim,) = claims("heart rate: chi2(3, N=20) = 1.2e1, p < .01")
    assert claim.numbers["n"].value == 20
    assert claim.numbers["chi2"].df == (3.0,)
    assert claim.numbers["p"].relation == "<"
