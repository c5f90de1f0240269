"""Laws of the search: what is carried from change to change is what would be measured from nothing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from studykit.choreography import dance_library
from studykit.choreography.rjmcmc.moves import MoveSet
from studykit.choreography.rjmcmc.sequence import Repertoire

SIZE = 7
changes = st.lists(
    st.tuples(st.sampled_from(["insert", "remove", "replace"]), st.integers(0, 99), st.integers(0, SIZE - 1)),
    max_size=40,
)


@pytest.fixture(scope="module", params=["euclidean_z", "cosine", "euclidean_z on demand"])
def repertoire(request, made_library):
    library = made_library(SIZE, seed=len(request.param))
    with pytest.MonkeyPatch.context() as patch:
        if "on demand" in request.param:
            patch.setattr(dance_library, "DENSE_LIMIT", 0)
        return Repertoire(library, request.param.split()[0])


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(steps=changes)
def test_changes_add_up_to_what_is_measured_from_nothing(repertoire, steps) -> None:
    now, plain = repertoire.sequence((0, 1, 1)), [0, 1, 1]
    for kind, anywhere, segment in steps:
        place = anywhere % (len(plain) + (kind == "insert"))
        if kind == "insert":
            now = repertoire.inserted(now, place, segment)
            plain.insert(place, segment)
        elif kind == "replace":
            now = repertoire.replaced(now, place, segment)
            plain[place] = segment
        elif len(plain) > 1:
            now = repertoire.removed(now, place)
            del plain[place]
        anew = repertoire.sequence(tuple(plain))
        assert now.segments == anew.segments
        assert now.displacements_m == anew.displacements_m
        assert now.linear_energy == pytest.approx(anew.linear_energy, rel=1e-9)
        assert now.rotational_energy == pytest.approx(anew.rotational_energy, rel=1e-9)
        assert now.distance_sum == pytest.approx(anew.distance_sum, rel=1e-6, abs=1e-3)
        assert now.measures.duration_s == 4.0 * len(plain)


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    seed=st.integers(0, 10_000),
    low=st.integers(1, 3),
    room=st.integers(0, 3),
    novelty=st.sampled_from([None, 0.5, 3.0, float("inf")]),
)
def test_no_move_ever_leaves_the_bounds(repertoire, seed, low, room, novelty) -> None:
    moves = MoveSet(repertoire=repertoire, bounds=(low, low + room), novelty=novelty)
    rng = np.random.default_rng(seed)
    now = repertoire.sequence(tuple(range(low)))
    for _ in range(60):
        if (proposal := moves.propose(now, rng)) is not None:
            now = proposal.sequence
        assert low <= len(now.segments) <= low + room
        assert all(0 <= segment < SIZE for segment in now.segments)
        if novelty is None:
            assert len(set(now.segments)) == len(now.segments)
