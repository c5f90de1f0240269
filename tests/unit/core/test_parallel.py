"""Work on many processes."""

from __future__ import annotations

import os

import pytest
from threadpoolctl import threadpool_info

from studykit.core.errors import InputError
from studykit.core.parallel import one_core, spread


@pytest.mark.parametrize("workers", [1, 2])
def test_results_come_in_the_order_of_the_jobs(workers: int) -> None:
    jobs = [(number, 2) for number in range(20)]
    assert list(spread(pow, jobs, workers=workers)) == [number**2 for number in range(20)]


def test_jobs_are_taken_as_they_are_done() -> None:
    taken = []
    results = spread(abs, ((taken.append(number) or -number,) for number in range(1000)), workers=1)
    assert next(results) == 0
    assert len(taken) < 10
    results.close()


def test_a_process_that_is_ended_from_outside_is_told() -> None:
    with pytest.raises(
        InputError, match="ended from outside, perhaps for lack of memory; run the same again"
    ):
        list(spread(os._exit, [(9,), (9,)], workers=2))


def test_what_the_work_raises_is_raised_here() -> None:
    with pytest.raises(ZeroDivisionError):
        list(spread(divmod, [(1, 1), (1, 0)], workers=2))


def test_linear_algebra_keeps_to_one_core_for_a_while() -> None:
    def cores() -> list[int]:
        return [one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"]

    before = cores()
    with one_core():
        assert set(cores()) == {1}
    assert cores() == before
