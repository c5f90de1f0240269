"""What differs between old and new results is found, named and explained."""

from __future__ import annotations

import copy

import pytest

from studykit.analysis.changes import changes

OLD = {
    "alpha": 0.05,
    "tests": [
        {
            "name": "pulse",
            "friedman": {"p": 0.04, "mean_ranks": [1.0, 2.5]},
            "pairs": [{"a": "x", "b": "y", "p": 0.02}, {"a": "x", "b": "z", "p": 0.5}],
        }
    ],
    "correlations": [{"name": "pulse", "r": 0.5, "warning": None}],
    "provenance": {
        "protocol_sha256": "1f",
        "dances_sha256": "aa",
        "visits": {"sub-01_ses-01": "11", "sub-02_ses-01": "22"},
        "versions": {"scipy": "1.17"},
    },
}


def changed(**places: object) -> dict[str, object]:
    new = copy.deepcopy(OLD)
    for place, value in places.items():
        *way, last = place.split("__")
        at = new
        for step in way:
            at = at[int(step) if step.isdigit() else step]
        at[int(last) if last.isdigit() else last] = value
    return new


def test_equal_results_have_no_changes() -> None:
    found = changes(OLD, copy.deepcopy(OLD))
    assert (found.causes, found.changes, found.rounded) == ((), (), 0)
    assert str(found) == "every result is as before"


@pytest.mark.parametrize(
    ("place", "value", "where"),
    [
        ("alpha", 0.01, "alpha"),
        ("tests__0__friedman__p", 0.06, "tests.pulse.friedman.p"),
        ("tests__0__friedman__mean_ranks__1", 2.0, "tests.pulse.friedman.mean_ranks.2"),
        ("tests__0__pairs__1__p", 0.4, "tests.pulse.pairs.x - z.p"),
        ("correlations__0__warning", "beware", "correlations.pulse.warning"),
        ("tests__0__is_significant", False, "tests.pulse.is_significant"),
    ],
)
def test_each_kind_of_value_is_found_by_its_name(place: str, value: object, where: str) -> None:
    found = changes(OLD, changed(**{place: value}))
    assert [(one.where, one.new) for one in found.changes] == [(where, value)]
    assert "nothing that went in differs" in str(found)


def test_rounding_is_counted_and_not_listed() -> None:
    found = changes(OLD, changed(tests__0__friedman__p=0.04 * (1.0 + 1e-13)))
    assert (found.changes, found.rounded) == ((), 1)
    found = changes(OLD, changed(tests__0__friedman__p=0.04 * (1.0 + 1e-6)))
    assert (len(found.changes), found.rounded) == (1, 0)


def test_a_verdict_that_turns_is_no_rounding() -> None:
    new = changed(tests__0__friedman__p=True)
    assert len(changes(changed(tests__0__friedman__p=False), new).changes) == 1


@pytest.mark.parametrize(
    ("place", "value", "cause"),
    [
        ("provenance__protocol_sha256", "2e", "the protocol is another"),
        ("provenance__dances_sha256", "bb", "the dances are others"),
        ("provenance__versions__scipy", "1.18", "scipy was 1.17 and is 1.18"),
        ("provenance__versions__numba", "0.68", "numba was absent and is 0.68"),
        ("provenance__visits__sub-02_ses-01", "33", "visits were recorded otherwise: sub-02_ses-01"),
        ("provenance__visits__sub-03_ses-01", "33", "visits are new: sub-03_ses-01"),
        ("provenance__visits", {"sub-01_ses-01": "11"}, "visits are gone: sub-02_ses-01"),
    ],
)
def test_what_went_in_otherwise_is_named_as_the_cause(place: str, value: object, cause: str) -> None:
    found = changes(OLD, changed(**{place: value, "alpha": 0.01}))
    assert found.causes == (cause,)
    assert str(found).splitlines()[1:] == [f"  {cause}", "alpha: 0.05 -> 0.01"]
    assert f"although {cause}" in str(changes(OLD, changed(**{place: value})))


def test_what_an_older_version_did_not_have_is_told() -> None:
    older = {"alpha": 0.05}
    found = changes(older, OLD)
    assert {one.old for one in found.changes} == {None}
    assert "tests.pulse.friedman.p: none -> 0.04" in str(found)
    assert found.to_dict()["changes"][0]["new"] == "pulse"


def test_results_that_do_not_name_their_visits_are_compared_by_their_data_as_a_whole() -> None:
    older = changed(provenance={"data_sha256": "12", "protocol_sha256": "1f", "dances_sha256": "aa"})
    newer = changed(provenance=OLD["provenance"] | {"data_sha256": "34", "versions": {}})
    assert changes(older, newer).causes == ("what was recorded is not the same",)
