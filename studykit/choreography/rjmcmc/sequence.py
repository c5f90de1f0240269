"""A dance in the making and what changes when a segment comes, goes or is exchanged."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

from studykit.choreography.dance_library import DanceLibrary, distances
from studykit.choreography.measures import Measures
from studykit.choreography.preset import Metric
from studykit.motion.segmentation import SEGMENT_S


@dataclass(frozen=True, slots=True)
class DanceSequence:
    """Segments in order, with the sums that their costs need.

    Parameters
    ----------
    segments : tuple of int
        Rows of the library.
    linear_energy, rotational_energy : float, J per kg
        Sums over the segments.
    distance_sum : float
        Sum of the distances of all pairs.
    displacements_m : tuple of float
        Displacement at each join.
    """

    segments: tuple[int, ...]
    linear_energy: float
    rotational_energy: float
    distance_sum: float
    displacements_m: tuple[float, ...]

    @property
    def measures(self) -> Measures:
        """What the costs depend on."""
        count = len(self.segments)
        pairs = count * (count - 1) // 2
        return Measures(
            duration_s=count * SEGMENT_S,
            linear_energy=self.linear_energy,
            rotational_energy=self.rotational_energy,
            variety=self.distance_sum / pairs if pairs else 0.0,
            displacements_m=self.displacements_m,
        )


class Repertoire:
    """A library made ready for the search: it builds sequences and changes them step by step.

    Every change costs one row of distances and at most two displacements, whatever the size of the library.

    Parameters
    ----------
    library : DanceLibrary
        Where segments come from.
    metric : {"euclidean_z", "cosine"}
        How different segments are.
    """

    def __init__(self, library: DanceLibrary, metric: Metric) -> None:
        self.size = len(library)
        self._distances = distances(library, metric)
        # The same joins come back all the time.
        self._displacement = lru_cache(maxsize=1 << 18)(library.displacement)
        self._linear = [float(energy) for energy in library.linear_energies.sum(axis=1)]
        self._rotational = [float(energy) for energy in library.rotational_energies.sum(axis=1)]

    def sequence(self, segments: tuple[int, ...]) -> DanceSequence:
        """Build a sequence from nothing."""
        return DanceSequence(
            segments,
            sum(self._linear[segment] for segment in segments),
            sum(self._rotational[segment] for segment in segments),
            float(self._distances.between(segments, segments).sum()) / 2.0,
            tuple(self._displacement(a, b) for a, b in pairwise(segments)),
        )

    def inserted(self, now: DanceSequence, place: int, segment: int) -> DanceSequence:
        """Put a segment before the one at `place` (or at the end)."""
        old = now.segments
        joins = now.displacements_m
        before = (self._displacement(old[place - 1], segment),) if place > 0 else ()
        after = (self._displacement(segment, old[place]),) if place < len(old) else ()
        return DanceSequence(
            (*old[:place], segment, *old[place:]),
            now.linear_energy + self._linear[segment],
            now.rotational_energy + self._rotational[segment],
            now.distance_sum + self._distance_to(segment, old),
            (*joins[: max(place - 1, 0)], *before, *after, *joins[place:]),
        )

    def removed(self, now: DanceSequence, place: int) -> DanceSequence:
        """Take the segment at `place` out."""
        segment, rest = now.segments[place], now.segments[:place] + now.segments[place + 1 :]
        joins = now.displacements_m
        inner = 0 < place < len(rest)
        bridge = (self._displacement(rest[place - 1], rest[place]),) if inner else ()
        return DanceSequence(
            rest,
            now.linear_energy - self._linear[segment],
            now.rotational_energy - self._rotational[segment],
            now.distance_sum - self._distance_to(segment, rest),
            (*joins[: max(place - 1, 0)], *bridge, *joins[place + 1 :]),
        )

    def replaced(self, now: DanceSequence, place: int, segment: int) -> DanceSequence:
        """Put another segment at `place`."""
        return self.inserted(self.removed(now, place), place, segment)

    def _distance_to(self, segment: int, others: tuple[int, ...]) -> float:
        return self._distances.total(segment, others) if others else 0.0
