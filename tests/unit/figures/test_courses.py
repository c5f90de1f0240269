"""Courses of conditions: stretches of difference stand where they are, and say how sure they are."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.colors import to_hex

from studykit.core.errors import InputError
from studykit.figures import Course, PeopleCurve, compared_courses

TIMES_S = np.arange(0.25, 8.0, 0.5)


def course(**changes) -> Course:
    curves = {
        name: PeopleCurve(label="Heart rate", times_s=TIMES_S, values=level + TIMES_S * [[1.0], [1.2]])
        for name, level in (("light-easy-on", 80.0), ("intense-hard-on", 100.0))
    }
    return Course(**({"curves": curves, "clusters": ((2.25, 5.75, 0.004), (6.25, 7.75, 0.2))} | changes))


def test_lines_are_means_in_looks_that_differ_without_colour() -> None:
    first, second = (
        line for line in compared_courses([course()]).axes[0].lines if line.get_gid() == "people"
    )
    assert np.asarray(first.get_ydata()) == pytest.approx(80.0 + 1.1 * TIMES_S)
    assert np.asarray(second.get_ydata()) == pytest.approx(100.0 + 1.1 * TIMES_S)
    assert first.get_linestyle() != second.get_linestyle()


def test_stretches_of_difference_stand_where_they_are_and_are_filled_where_sure() -> None:
    axes = compared_courses([course()], alpha=0.05).axes[0]
    bars = [patch for patch in axes.patches if patch.get_gid() == "cluster"]
    assert [(bar.get_x(), bar.get_width()) for bar in bars] == [(2.25, 3.5), (6.25, 1.5)]
    assert [to_hex(bar.get_facecolor()) for bar in bars] == ["#222222", "#ffffff"]
    assert [bar.get_hatch() for bar in bars] == [None, "////"]
    assert [text.get_text() for text in axes.texts] == ["p = .004", "p = .200"]


def test_curves_leave_room_for_the_bar() -> None:
    axes = compared_courses([course()]).axes[0]
    low, high = axes.get_ylim()
    assert low + 0.1 * (high - low) < 80.0


def test_nothing_to_compare_is_refused_and_simulated_people_are_said() -> None:
    with pytest.raises(InputError, match="nothing to compare"):
        compared_courses([])
    assert compared_courses([course()], simulated=True).marks
