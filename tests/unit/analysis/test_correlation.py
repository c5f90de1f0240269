from __future__ import annotations

import pytest

from studykit.analysis.correlation import pearson, repeated_measures


def test_pooling_hides_what_every_person_shows() -> None:
    # Everybody falls, but those with more x have more y.
    people = ["a", "a", "a", "b", "b", "b"]
    x, y = [1.0, 2.0, 3.0, 11.0, 12.0, 13.0], [3.0, 2.0, 1.0, 13.0, 12.0, 11.0]
    assert pearson(x, y).r > 0.9
    assert repeated_measures(people, x, y).r == pytest.approx(-1.0)


def test_who_counts_as_what() -> None:
    pooled = pearson([1.0, 2.0, 4.0], [1.0, 3.0, 2.0])
    assert (pooled.n, pooled.participants, pooled.degrees_of_freedom) == (3, None, 1)
    assert pooled.interval is None
    assert pooled.warning is not None
    within = repeated_measures(["a", "a", "b", "b"], [1.0, 2.0, 4.0, 6.0], [1.0, 3.0, 2.0, 1.0])
    assert (within.n, within.participants, within.degrees_of_freedom) == (4, 2, 1)
    assert within.warning is None


def test_what_does_not_vary_is_refused() -> None:
    with pytest.raises(ValueError, match="y does not vary"):
        pearson([1.0, 2.0, 3.0], [0.1, 0.1, 0.1])
    with pytest.raises(ValueError, match="x within people does not vary"):
        repeated_measures(["a", "a", "b", "b"], [0.1, 0.1, 0.3, 0.3], [1.0, 2.0, 3.0, 5.0])


def test_lists_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match="three values"):
        pearson([1.0, 2.0], [1.0, 2.0])
    with pytest.raises(ValueError, match="finite"):
        pearson([1.0, 2.0, float("nan")], [1.0, 2.0, 3.0])
    with pytest.raises(ValueError, match="same length"):
        repeated_measures(["a"], [1.0, 2.0, 3.0], [1.0, 2.0, 4.0])
    with pytest.raises(ValueError, match="too few"):
        repeated_measures(["a", "a", "b"], [1.0, 2.0, 3.0], [1.0, 2.0, 4.0])
