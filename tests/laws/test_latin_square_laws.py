from __future__ import annotations

from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from studykit.io.protocol_file import read_protocol
from studykit.protocol.latin_square import assignment, balance, williams
from studykit.protocol.study_protocol import StudyProtocol

PROTOCOL = read_protocol(Path(__file__).resolve().parents[2] / "protocols" / "dance-2x2x2.toml")


@given(st.integers(2, 30))
def test_every_square_is_balanced(count: int) -> None:
    square = williams(count)
    squares = 1 + count % 2
    assert square.shape == (squares * count, count)
    for period in square.T:
        assert np.bincount(period, minlength=count).tolist() == [squares] * count
    pairs = np.zeros((count, count), dtype=int)
    np.add.at(pairs, (square[:, :-1], square[:, 1:]), 1)
    assert (pairs == squares * (1 - np.eye(count, dtype=int))).all()


@settings(max_examples=40)
@given(participants=st.integers(1, 60), seed=st.integers(0, 2**31))
def test_everybody_gets_every_condition_once_and_the_square_is_used_evenly(
    participants: int, seed: int
) -> None:
    values = PROTOCOL.with_participants(participants).model_dump(mode="json")
    values["study"]["seed"] = seed
    protocol = StudyProtocol.model_validate(values)
    given_out = assignment(protocol)
    assert len({sequence.participant for sequence in given_out}) == participants
    assert all(sorted(s.conditions) == sorted(protocol.conditions_list()) for s in given_out)
    uses = np.bincount([sequence.number - 1 for sequence in given_out], minlength=8)
    assert np.ptp(uses) <= 1
    report = balance(given_out)
    assert report.position_counts.sum() == 8 * participants
    assert report.carry_overs.sum() == 7 * participants
    assert report.is_balanced == (participants % 8 == 0)
    assert np.ptp(report.position_counts) <= 1
    assert np.ptp(report.carry_overs) <= 1
