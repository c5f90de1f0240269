from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io.protocol_file import read_protocol
from studykit.protocol.latin_square import Sequence, assignment, balance, williams
from studykit.protocol.study_protocol import StudyProtocol

SHIPPED = Path(__file__).resolve().parents[3] / "protocols" / "dance-2x2x2.toml"


@pytest.fixture(scope="module")
def protocol() -> StudyProtocol:
    return read_protocol(SHIPPED)


def sequences(square: np.ndarray, labels: tuple[str, ...]) -> list[Sequence]:
    return [
        Sequence(
            participant=f"{row + 1:02d}", number=row + 1, conditions=tuple(labels[c] for c in conditions)
        )
        for row, conditions in enumerate(square)
    ]


def test_the_published_first_rows() -> None:
    # Williams 1949, as R's crossdes::williams gives them.
    assert (williams(8)[0] + 1).tolist() == [1, 2, 8, 3, 7, 4, 6, 5]
    assert (williams(4) + 1).tolist() == [[1, 2, 4, 3], [2, 3, 1, 4], [3, 4, 2, 1], [4, 1, 3, 2]]
    assert (williams(8)[1] + 1).tolist() == [2, 3, 1, 4, 8, 5, 7, 6]


def test_one_condition_has_no_order() -> None:
    with pytest.raises(ValueError, match="two conditions"):
        williams(1)


def test_whole_squares_come_first_and_the_extra_rows_last(protocol: StudyProtocol) -> None:
    given = assignment(protocol)
    numbers = [sequence.number for sequence in given]
    assert [sequence.participant for sequence in given] == [f"{n:02d}" for n in range(1, 21)]
    assert sorted(numbers[:8]) == sorted(numbers[8:16]) == list(range(1, 9))
    assert sorted(numbers[16:]) == [1, 3, 5, 7]
    assert numbers[:8] != numbers[8:16]
    assert given == assignment(protocol)


def test_another_seed_draws_other_lots(protocol: StudyProtocol) -> None:
    values = protocol.model_dump(mode="json")
    values["study"]["seed"] = 2
    assert assignment(StudyProtocol.model_validate(values)) != assignment(protocol)


def test_sequences_follow_the_labels(protocol: StudyProtocol) -> None:
    square, labels = williams(8), protocol.conditions_list()
    for sequence in assignment(protocol):
        assert [labels.index(name) for name in sequence.conditions] == square[sequence.number - 1].tolist()


def test_twenty_people_are_as_balanced_as_twenty_can_be(protocol: StudyProtocol) -> None:
    report = balance(assignment(protocol))
    assert set(report.position_counts.ravel()) == {2, 3}
    assert set(report.carry_overs) == {2, 3}
    assert not report.is_balanced
    assert report.has_balanced_levels
    assert all(counts.tolist() == [10] * 8 for counts in report.level_counts.values())
    assert report.balanced_participants == (16, 24)
    text = str(report)
    assert "20 participants cannot be balanced fully; 16 or 24 would be." in text
    assert "A condition stands in a position 2 to 3 times." in text


@pytest.mark.parametrize("participants", [16, 24])
def test_whole_squares_are_balanced(protocol: StudyProtocol, participants: int) -> None:
    report = balance(assignment(protocol.with_participants(participants)))
    assert report.is_balanced
    assert report.has_balanced_levels
    assert str(report).endswith("Everything is balanced.")


def test_other_extra_rows_unbalance_the_levels(protocol: StudyProtocol) -> None:
    values = protocol.model_dump(mode="json")
    values["order"]["extra_rows"] = [1, 2, 3, 4]
    assert not balance(assignment(StudyProtocol.model_validate(values))).has_balanced_levels


def test_a_square_that_only_rotates_is_not_balanced(protocol: StudyProtocol) -> None:
    rotating = (np.arange(8) + np.arange(8)[:, None]) % 8
    report = balance(sequences(rotating, protocol.conditions_list()))
    assert np.ptp(report.position_counts) == 0
    assert not report.is_balanced


def test_incomplete_sequences_are_refused(protocol: StudyProtocol) -> None:
    whole = assignment(protocol)[0]
    part = Sequence(participant="02", number=1, conditions=whole.conditions[:7])
    with pytest.raises(InputError, match="participant 02 does not dance the same conditions"):
        balance([whole, part])
    with pytest.raises(InputError, match="nobody"):
        balance([])
