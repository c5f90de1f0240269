"""The three ways to change a dance, each with its exact odds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from studykit.choreography.rjmcmc.sequence import DanceSequence, Repertoire


@dataclass(frozen=True, slots=True)
class Proposal:
    """A changed dance.

    Parameters
    ----------
    sequence : DanceSequence
        The dance proposed.
    log_odds : float
        Log of how much likelier the way back is than the way there, times the ratio of the priors: what
        Green (1995) multiplies with the ratio of the targets.
    """

    sequence: DanceSequence
    log_odds: float


class Move(Protocol):
    """A way to change a dance."""

    def propose(self, now: DanceSequence, rng: np.random.Generator) -> Proposal | None:
        """Propose a changed dance, or None where the length would leave its bounds."""
        ...


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MoveSet:
    """The paper's moves: add (40 %), replace (40 %), remove (20 %).

    Parameters
    ----------
    repertoire : Repertoire
        Where segments come from.
    bounds : tuple of int
        Fewest and most segments.
    novelty : float or None
        How often a new segment is any one of the library rather than a copy of one in the dance: with n
        others, novelty / (novelty + n); infinite leaves repetition to chance. None never repeats a segment.
    place : {"anywhere", "at_end"}
        Where a segment is added.
    add, remove : float
        How often each is tried, as shares of 1; what is left is for replacing.

    Notes
    -----
    The prior over dances of n segments is the urn of Blackwell and MacQueen with concentration `novelty` (or
    all dances without repetition), and new segments are drawn from its own conditional. The urn does not look
    at the order, so a segment's share in the prior and the odds of proposing it cancel everywhere: what is
    left of Green's ratio is the frequency of the moves.
    """

    repertoire: Repertoire
    bounds: tuple[int, int]
    novelty: float | None = math.inf
    place: Literal["anywhere", "at_end"] = "anywhere"
    add: float = 0.4
    remove: float = 0.2

    def propose(self, now: DanceSequence, rng: np.random.Generator) -> Proposal | None:
        """Draw one of the three moves and make it."""
        draw, count = rng.random(), len(now.segments)
        if draw < self.add:
            if count >= self.bounds[1]:
                return None
            place = int(rng.integers(count + 1)) if self.place == "anywhere" else count
            segment = self._segment(now.segments, rng)
            # There: one of n + 1 places; back: one of n + 1 segments.
            return Proposal(self.repertoire.inserted(now, place, segment), math.log(self.remove / self.add))
        place = int(rng.integers(count))
        if draw < self.add + self.remove:
            if count <= self.bounds[0]:
                return None
            return Proposal(self.repertoire.removed(now, place), math.log(self.add / self.remove))
        rest = now.segments[:place] + now.segments[place + 1 :]
        return Proposal(self.repertoire.replaced(now, place, self._segment(rest, rng)), 0.0)

    def _segment(self, others: tuple[int, ...], rng: np.random.Generator) -> int:
        """Draw a segment from the urn: a copy of one of the others, or any."""
        if self.novelty is None:
            while (segment := int(rng.integers(self.repertoire.size))) in others:
                pass
            return segment
        if rng.random() * (1.0 + len(others) / self.novelty) >= 1.0:
            return others[int(rng.integers(len(others)))]
        return int(rng.integers(self.repertoire.size))
