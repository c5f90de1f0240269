"""The order in which people dance: a square that is fair to every condition."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from studykit.core.arrays import Integers
from studykit.core.errors import InputError
from studykit.core.seeding import stream
from studykit.protocol.condition import FACTORS, Condition
from studykit.protocol.study_protocol import StudyProtocol


@dataclass(frozen=True, kw_only=True, slots=True)
class Sequence:
    """The order of conditions that one participant gets.

    Parameters
    ----------
    participant : str
        Number of the participant, "01", "02" and so on.
    number : int
        Row of the square, counted from 1.
    conditions : tuple of str
        The conditions in the order in which they are danced.
    """

    participant: str
    number: int
    conditions: tuple[str, ...]


def williams(count: int) -> Integers:
    """Give orders in which every condition comes first, second ... and after every other equally often.

    Row i is the first row with i added to every number. The first row goes to and fro between the ends:
    1, 2, n, 3, n-1, 4 ... For an odd number of conditions one square cannot be balanced, so the same rows
    read backwards follow.

    Parameters
    ----------
    count : int
        Number of conditions n, 2 or more.

    Returns
    -------
    array, shape (n or 2 n, n)
        Rows are sequences, columns are periods; conditions count from 0.

    Raises
    ------
    ValueError
        If there are fewer than two conditions.

    References
    ----------
    Williams, E. J. (1949). Experimental designs balanced for the estimation of residual effects of
    treatments. Australian Journal of Chemistry, 2(2).

    Examples
    --------
    >>> williams(8)[0] + 1
    array([1, 2, 8, 3, 7, 4, 6, 5])
    """
    if count < 2:
        raise ValueError("an order needs two conditions or more")
    steps = np.arange(count, dtype=np.int64)
    first = np.where(steps % 2, (steps + 1) // 2, -(steps // 2))
    square: Integers = (first + steps[:, None]) % count
    return np.vstack([square, square[:, ::-1]]) if count % 2 else square


def assignment(protocol: StudyProtocol) -> tuple[Sequence, ...]:
    """Draw lots for which participant gets which sequence.

    Whole squares are given out first, each in an order of its own, so that the study is balanced after
    every whole square; the protocol's extra rows serve those who remain.

    Parameters
    ----------
    protocol : StudyProtocol
        Gives the labels, the number of participants, the extra rows and the seed.

    Returns
    -------
    tuple of Sequence
        One a participant; the same protocol always gives the same.
    """
    labels, participants = protocol.order.labels, protocol.study.participants
    square = williams(len(labels))
    rows: list[int] = []
    for block in range(-(-participants // len(square))):
        left = min(participants - len(rows), len(square))
        block_rows = (
            range(len(square)) if left == len(square) else [row - 1 for row in protocol.order.extra_rows]
        )
        rows += stream(protocol.study.seed, "order", block).permutation(list(block_rows)[:left]).tolist()
    width = max(2, len(str(participants)))
    return tuple(
        Sequence(
            participant=f"{number:0{width}d}",
            number=row + 1,
            conditions=tuple(labels[c] for c in square[row]),
        )
        for number, row in enumerate(rows, start=1)
    )


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class BalanceReport:
    """How fair an assignment is; print it to read it.

    Parameters
    ----------
    participants : int
        Number of people.
    conditions : tuple of str
        Names of the conditions.
    position_counts : array, shape (condition, period)
        How many people dance a condition in a period.
    carry_over_counts : array, shape (condition, condition)
        How many people dance the second condition directly after the first; the diagonal is zero.
    level_counts : dict of str to array, shape (period,)
        How many people dance a factor's level in a period.
    """

    participants: int
    conditions: tuple[str, ...]
    position_counts: Integers
    carry_over_counts: Integers
    level_counts: dict[str, Integers]

    @property
    def carry_overs(self) -> Integers:
        """The counts of all ordered pairs of different conditions, in one row."""
        return self.carry_over_counts[~np.eye(len(self.conditions), dtype=bool)]

    @property
    def is_balanced(self) -> bool:
        """Whether all conditions have equal counts in all positions and after all others."""
        return bool(np.ptp(self.position_counts) == 0 and np.ptp(self.carry_overs) == 0)

    @property
    def has_balanced_levels(self) -> bool:
        """Whether all levels of each factor that varies occur equally often in every position."""
        return all(
            np.ptp(np.concatenate([self.level_counts[level] for level in levels])) == 0
            for levels in self._factors()
        )

    @property
    def balanced_participants(self) -> tuple[int, ...]:
        """Numbers of participants near this one with which whole squares would be filled."""
        rows = len(self.conditions) * (1 + len(self.conditions) % 2)
        below = self.participants // rows * rows
        return (below, below + rows) if below else (rows,)

    def _factors(self) -> list[list[str]]:
        levels = [
            list(dict.fromkeys(getattr(Condition.parse(name), factor) for name in self.conditions))
            for factor in FACTORS
        ]
        return [factor for factor in levels if len(factor) > 1]

    def __str__(self) -> str:
        width = max(map(len, self.conditions))
        periods = range(1, self.position_counts.shape[1] + 1)
        table = [" ".join([" " * width, *(f"{period:>3}" for period in periods)])]
        for name, counts in zip(self.conditions, self.position_counts, strict=True):
            table.append(" ".join([f"{name:<{width}}", *(f"{count:>3}" for count in counts)]))
        levels = "are balanced" if self.has_balanced_levels else "are not balanced"
        lines = [
            (
                f"Order of {len(self.conditions)} conditions for {self.participants} participants: "
                "how many dance a condition as their 1st, 2nd ..."
            ),
            *table,
            f"A condition stands in a position {_span(self.position_counts)}.",
            f"A condition follows another directly {_span(self.carry_overs)}.",
            f"The levels of the factors {levels} in every position.",
        ]
        if self.is_balanced:
            lines.append("Everything is balanced.")
        else:
            others = " or ".join(map(str, self.balanced_participants))
            lines.append(f"{self.participants} participants cannot be balanced fully; {others} would be.")
        return "\n".join(lines)


def balance(sequences: Iterable[Sequence]) -> BalanceReport:
    """Count how fair an assignment is to the conditions, their neighbours and the factors.

    Parameters
    ----------
    sequences : iterable of Sequence
        What the participants dance; all dance the same conditions.

    Raises
    ------
    InputError
        If nobody takes part or someone does not dance all conditions once.
    """
    people = list(sequences)
    if not people:
        raise InputError("nobody takes part", remedy="give one sequence or more")
    conditions = tuple(sorted(people[0].conditions))
    position = np.zeros((len(conditions), len(conditions)), dtype=np.int64)
    carry_over = np.zeros_like(position)
    for sequence in people:
        if tuple(sorted(sequence.conditions)) != conditions:
            raise InputError(
                f"participant {sequence.participant} does not dance the same conditions as the first",
                remedy="give everybody every condition once",
            )
        numbers = np.array([conditions.index(name) for name in sequence.conditions])
        position[numbers, np.arange(len(numbers))] += 1
        np.add.at(carry_over, (numbers[:-1], numbers[1:]), 1)
    levels: dict[str, Integers] = {}
    for name, counts in zip(conditions, position, strict=True):
        for level in name.split("-"):
            levels[level] = levels.get(level, np.zeros_like(counts)) + counts
    return BalanceReport(
        participants=len(people),
        conditions=conditions,
        position_counts=position,
        carry_over_counts=carry_over,
        level_counts=levels,
    )


def _span(counts: Integers) -> str:
    low, high = int(counts.min()), int(counts.max())
    return f"{low} times" if low == high else f"{low} to {high} times"
