"""Work on many processes."""

from __future__ import annotations

import os

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

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


def cores() -> list[int]:
    return [one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"]


def test_linear_algebra_keeps_to_one_core_until_the_last_thread_has_done() -> None:
    np.linalg.inv(np.eye(3))
    with threadpool_limits(limits=2, user_api="blas"):
        first, second = one_core(), one_core()
        first.__enter__()
        second.__enter__()
        assert set(cores()) == {1}
        first.__exit__(None, None, None)
        assert set(cores()) == {1}
        second.__exit__(None, None, None)
        assert set(cores()) == {2}
