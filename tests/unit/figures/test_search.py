"""Traces of searches: lines are the trace, terms bear their weights."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes

from studykit.core.errors import InputError
from studykit.figures import search_trace, style


def drawn(axes: Axes) -> dict[str, np.ndarray]:
    return {line.get_gid(): np.asarray(line.get_ydata(), dtype=float) for line in axes.lines}


def test_lines_are_the_trace(made_dance) -> None:
    dance = made_dance()
    costs, terms, annealing, segments, accepted = search_trace(dance).axes
    shown = drawn(costs) | drawn(annealing) | drawn(segments)
    for name in ("cost", "best_cost", "temperature", "width", "segments"):
        assert shown[name] == pytest.approx([getattr(row, name) for row in dance.trace])
    assert drawn(accepted)["accepted"] == pytest.approx(50.0)
    assert drawn(accepted)["replaced"] == pytest.approx(60.0)
    assert drawn(accepted)["inserted"][1:3] == pytest.approx([np.nan, 10.0], nan_ok=True)
    assert "removed" not in drawn(accepted)  # never tried
    assert shown["chains"] == pytest.approx(dance.chain_costs)
    assert shown["found"] == pytest.approx([dance.cost_total])
    assert costs.lines[0].get_xdata() == pytest.approx([row.iteration for row in dance.trace])
    assert costs.get_yscale() == terms.get_yscale() == annealing.get_yscale() == "log"


def test_terms_times_their_weights_add_up_to_the_cost(made_dance) -> None:
    dance = made_dance()  # made so that they do
    terms = drawn(search_trace(dance).axes[1])
    assert set(terms) == {"term linear", "term variety"}  # what weighs nothing is not part of the cost
    assert sum(terms.values()) == pytest.approx([row.cost for row in dance.trace])
    unweighted = sum(row.terms["linear"] + row.terms["variety"] for row in dance.trace)
    assert sum(terms.values()).sum() != pytest.approx(unweighted)  # Wrong: weights forgotten


def test_a_term_of_nothing_stands_at_the_lower_edge(made_dance) -> None:
    dance = made_dance()
    last = replace(dance.trace[-1], terms=dance.trace[-1].terms | {"linear": 0.0})
    axes = search_trace(replace(dance, trace=(*dance.trace[:-1], last))).axes[1]
    assert drawn(axes)["term linear"][-1] == pytest.approx(axes.get_ylim()[0])
    assert axes.get_ylim()[0] == pytest.approx(0.5 * 1e-4)


def test_a_cost_without_bounds_is_left_out(made_dance) -> None:
    dance = made_dance()
    first = replace(dance.trace[0], best_cost=np.inf)
    axes = search_trace(replace(dance, trace=(first, *dance.trace[1:]))).axes[0]
    assert axes.get_ylim()[1] < 2.0


def test_costs_of_nothing_are_drawn_too(made_dance) -> None:
    dance = made_dance()
    trace = tuple(replace(row, cost=0.0, best_cost=0.0) for row in dance.trace)
    axes = search_trace(replace(dance, trace=trace, chain_costs=(0.0,), cost_total=0.0)).axes[0]
    assert axes.get_yscale() == "linear"


def test_a_trace_says_what_is_made_up_and_must_be_there(made_dance) -> None:
    assert search_trace(made_dance()).get_suptitle() == style.SYNTHETIC
    assert search_trace(made_dance(is_synthetic=False)).get_suptitle() == ""
    with pytest.raises(InputError, match="no trace"):
        search_trace(made_dance(trace=()))
