"""One chain: from the smallest repertoires, and where nothing that is met is allowed."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from threading import Lock

import numpy as np
import pytest

from studykit.choreography.reach import nearest
from studykit.choreography.request import requested
from studykit.choreography.rjmcmc import chain, kernel
from studykit.choreography.rjmcmc.annealing import Annealing
from studykit.choreography.rjmcmc.chain import Search
from studykit.choreography.rjmcmc.repertoire import Repertoire
from studykit.choreography.rjmcmc.trace import TraceRow
from studykit.core.errors import InputError
from studykit.motion.joint_mask import spare
from studykit.motion.skeleton import JOINT_NAMES

SHORT = Annealing.geometric(iterations=500, start=0.3, end=0.01, start_width=3.0)
HAND = JOINT_NAMES.index("right_hand")


@pytest.mark.parametrize("left", [1, 2, 3])
def test_a_mask_may_leave_very_few_segments(made_library, left) -> None:
    library = made_library(20)
    limit = float(np.sort(library.peak_speeds[:, HAND])[left - 1])
    goal = requested(library, duration_s=8.0, spare=spare("right_hand", speed_limits_rad_s=limit))
    known = Repertoire(library, goal.preset, mask=goal.mask)
    assert known.size == left
    found = Search(goal=goal, repertoire=known, annealing=SHORT).run(np.random.default_rng(0))
    assert {segment for block in found.blocks for segment in block} <= set(range(left))


def test_who_waits_for_the_compiler_is_told_once(made_library, monkeypatch, capsys) -> None:
    library = made_library(20)
    goal = requested(library, duration_s=8.0)
    search = Search(goal=goal, repertoire=Repertoire(library, goal.preset), annealing=SHORT)
    monkeypatch.setattr(sys, "ps1", ">>> ", raising=False)
    monkeypatch.setattr(chain, "_TO_BE_TOLD", Lock())
    for is_compiled, told in ((True, ""), (False, f"{kernel.COMPILING}\n"), (False, "")):
        monkeypatch.setattr(kernel, "is_compiled", lambda known=is_compiled: known)
        search.run(np.random.default_rng(0))
        assert capsys.readouterr().out == told


def test_a_search_that_ran_is_compiled(made_library) -> None:
    library = made_library(20)
    goal = requested(library, duration_s=8.0)
    Search(goal=goal, repertoire=Repertoire(library, goal.preset), annealing=SHORT).run(
        np.random.default_rng(0)
    )
    assert kernel.is_compiled()


def test_a_dance_that_breaks_a_rule_is_never_called_within_reach(made_library, monkeypatch) -> None:
    library = made_library(20)
    goal = requested(library, duration_s=16.0)
    known = Repertoire(library, goal.preset)
    assert nearest(goal, known).is_allowed
    monkeypatch.setattr(Repertoire, "is_held", lambda *_: False)
    known.tables.speed_limits.resize(0)
    with pytest.raises(InputError, match="no order of 20 segments"):
        nearest(replace(goal, condition="held"), known)


def test_a_row_of_the_trace_survives_json_without_infinity() -> None:
    row = TraceRow(
        iteration=1,
        temperature=0.3,
        width=1.0,
        cost=0.5,
        best_cost=math.inf,
        segments=8,
        accepted=0.1,
        terms={"duration": 0.0},
    )
    assert row.to_dict()["best_cost"] is None
    assert TraceRow.from_dict(row.to_dict()) == row
