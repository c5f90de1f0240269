"""What can be put right is said in one sentence, also when it happened in another process."""

from __future__ import annotations

import pickle

from studykit.core.errors import InputError, MistakesError


def test_an_error_is_one_sentence() -> None:
    error = InputError("no frames,\nnone at all", where="salsa/01.bvh", remedy="export the take again")
    assert str(error) == "salsa/01.bvh: no frames, none at all; export the take again."


def test_an_error_comes_back_from_another_process_whole() -> None:
    error = InputError("no frames", where="salsa/01.bvh", remedy="export the take again")
    again = pickle.loads(pickle.dumps(error))
    assert isinstance(again, InputError)
    assert (str(again), again.problem, again.where, again.remedy) == (
        str(error),
        "no frames",
        "salsa/01.bvh",
        "export the take again",
    )


def test_several_errors_have_a_line_each_also_from_another_process() -> None:
    several = MistakesError([InputError(f"no {what}", where="row", remedy="add it") for what in ("a", "b")])
    again = pickle.loads(pickle.dumps(several))
    assert isinstance(again, InputError)
    assert str(again) == str(several) == "row: no a; add it.\nrow: no b; add it."
