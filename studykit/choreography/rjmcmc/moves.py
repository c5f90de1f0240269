"""The ways to change a dance, each with its exact odds, written to be read."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, pairwise
from typing import Literal

from studykit.choreography.measures import Blocks
from studykit.choreography.rjmcmc.repertoire import Repertoire


@dataclass(frozen=True, kw_only=True, slots=True)
class Move:
    """One change of a dance.

    Parameters
    ----------
    kind : {"insert", "remove", "replace"}
        What is done.
    block, place : int
        Where.
    segment : int or None
        The new segment.
    log_odds : float
        Log of how much likelier the way back is than the way there, times the ratio of the priors: what
        Green (1995) multiplies with the ratio of the targets.
    """

    kind: Literal["insert", "remove", "replace"]
    block: int
    place: int
    segment: int | None
    log_odds: float

    def made(self, now: Blocks) -> Blocks:
        """Give the changed dance."""
        old = now[self.block]
        new = () if self.segment is None else (self.segment,)
        rest = self.place if self.kind == "insert" else self.place + 1
        block = (*old[: self.place], *new, *old[rest:])
        return (*now[: self.block], block, *now[self.block + 1 :])

    def joins(self, now: Blocks) -> tuple[tuple[int, int], ...]:
        """Give the joins that the change makes, as segments before and after."""
        at = sum(len(block) for block in now[: self.block]) + self.place
        changed = tuple(pairwise(chain.from_iterable(self.made(now))))
        first = max(at - 1, 0)
        return changed[first : at if self.segment is None else at + 1]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Moves:
    """The paper's moves: add (40 %), replace (40 %), remove (20 %).

    Parameters
    ----------
    repertoire : Repertoire
        Where segments come from.
    bounds : tuple of (int, int)
        Fewest and most segments, block by block.
    novelties : tuple of float or None
        How often a new segment is any one of the library rather than a copy of one in its block: with n
        others, novelty / (novelty + n); infinite leaves repetition to chance. None repeats no movement.
    neighbour : float
        Share of new segments drawn from the successors of the segment before.
    at_end : bool
        Whether segments are added at the end of a block only.
    is_exact : bool
        Whether the chain shall be reversible (Green 1995); otherwise odds are left out, as by Eq. 13 alone.
    insert, remove : float
        How often each is tried, as shares of 1; what is left is for replacing.

    Notes
    -----
    The prior over the segments of a block is the urn of Blackwell and MacQueen with concentration `novelty`
    (or all alike), lengths within their bounds are alike, and new segments come from the urn's own
    conditional. The urn does not look at the order, so a segment's share in the prior and the odds of
    proposing it cancel everywhere: what is left of Green's ratio is how often the moves are tried and, where
    neighbours are proposed, how much likelier that makes a segment than the urn does.
    """

    repertoire: Repertoire
    bounds: tuple[tuple[int, int], ...]
    novelties: tuple[float | None, ...]
    neighbour: float = 0.0
    at_end: bool = False
    is_exact: bool = True
    insert: float = 0.4
    remove: float = 0.2

    def proposed(self, now: Blocks, draws: Sequence[float]) -> Move | None:  # noqa: PLR0911
        """Draw a change from five numbers between 0 and 1; None where it is not allowed."""
        number, share = divmod(draws[1] * len(now), 1.0)
        block = int(number)
        count = len(now[block])
        fewest, most = self.bounds[block]
        if draws[0] < self.insert:
            if count >= most:
                return None
            place = count if self.at_end else int(share * (count + 1))
            segment = self._drawn(now, block, place, now[block], draws)
            if self._is_repetition(block, segment, now[block]):
                return None
            # There: one of n + 1 places; back: one of n + 1 segments; at the end there is one place only.
            odds = math.log(self.remove / self.insert) - (math.log(count + 1.0) if self.at_end else 0.0)
            odds -= self._log_density(now, block, place, now[block], segment)
            return Move(kind="insert", block=block, place=place, segment=segment, log_odds=odds)
        place = int(share * count)
        old, rest = now[block][place], now[block][:place] + now[block][place + 1 :]
        back = self._log_density(now, block, place, rest, old)
        if draws[0] < self.insert + self.remove:
            # What was not added at the end could not come back: an exact chain removes the last one only.
            if count <= fewest or (self.at_end and self.is_exact and place < count - 1):
                return None
            odds = math.log(self.insert / self.remove) + (math.log(count) if self.at_end else 0.0)
            return Move(kind="remove", block=block, place=place, segment=None, log_odds=odds + back)
        segment = self._drawn(now, block, place, rest, draws)
        if self._is_repetition(block, segment, rest):
            return None
        there = self._log_density(now, block, place, rest, segment)
        return Move(kind="replace", block=block, place=place, segment=segment, log_odds=back - there)

    def _drawn(
        self, now: Blocks, block: int, place: int, others: tuple[int, ...], draws: Sequence[float]
    ) -> int:
        """Draw a segment for a place: a successor of the one before, a copy of another, or any."""
        source, which = draws[2], draws[3]
        before = _before(now, block, place)
        if before is not None:
            if source < self.neighbour:
                successors = self.repertoire.successors(before)
                return int(successors[int(which * len(successors))])
            source = (source - self.neighbour) / (1.0 - self.neighbour)
        novelty = self.novelties[block]
        if novelty is not None and source * (1.0 + len(others) / novelty) >= 1.0:
            return others[int(which * len(others))]
        return int(which * self.repertoire.size)

    def _log_density(
        self, now: Blocks, block: int, place: int, others: tuple[int, ...], segment: int
    ) -> float:
        """Give the log of how much likelier a segment is proposed at a place than the prior has it there."""
        before = _before(now, block, place)
        if self.neighbour <= 0.0 or before is None:
            return 0.0
        successors = self.repertoire.successors(before)
        near = self.neighbour / len(successors) if segment in successors else 0.0
        return math.log(1.0 - self.neighbour + near / self._prior(block, others, segment))

    def _prior(self, block: int, others: tuple[int, ...], segment: int) -> float:
        novelty = self.novelties[block]
        if novelty is None or math.isinf(novelty):
            return 1.0 / self.repertoire.size
        new = novelty / self.repertoire.size
        return (new + others.count(segment)) / (novelty + len(others))

    def _is_repetition(self, block: int, segment: int, others: tuple[int, ...]) -> bool:
        return self.novelties[block] is None and any(
            self.repertoire.same_movement(segment, other) for other in others
        )


def _before(now: Blocks, block: int, place: int) -> int | None:
    """Give the segment before a place."""
    if place > 0:
        return now[block][place - 1]
    return now[block - 1][-1] if block > 0 else None
