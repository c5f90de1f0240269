"""A library made ready for the search: which segments may be danced, and all that costs need of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property, lru_cache
from itertools import chain, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studykit.choreography.cost.mask import spared_energies
from studykit.choreography.cost.term import CostTerm, SegmentTerm
from studykit.choreography.dance_library import MOVEMENT_S, DanceLibrary, distances
from studykit.choreography.measures import Blocks, Measures
from studykit.choreography.preset import Preset
from studykit.choreography.reduction import Reduced
from studykit.choreography.rjmcmc.kernel.arrays import Tables
from studykit.core.arrays import Floats, Integers
from studykit.core.errors import InputError
from studykit.motion.joint_mask import JointMask
from studykit.motion.segmentation import SEGMENT_S

_TAIL = 7


class Repertoire:
    """The segments of a library that a dance may have, numbered anew, with what their costs depend on.

    Parameters
    ----------
    library : DanceLibrary
        Where segments come from.
    preset : Preset
        How the formulas are read.
    mask : JointMask or None
        Joints that are spared: segments in which one exceeds a limit are left out.
    terms : sequence of SegmentTerm or CostTerm
        Further terms.

    Raises
    ------
    InputError
        If the mask leaves no segment, or a term is incomplete, has the name of another, or has values that
        are not one number a segment.
    """

    def __init__(
        self,
        library: DanceLibrary,
        preset: Preset,
        *,
        mask: JointMask | None = None,
        terms: Sequence[SegmentTerm | CostTerm] = (),
    ) -> None:
        self.library = library
        self.rows: Integers = allowed(library, mask)
        self.size = len(self.rows)
        self.values: Mapping[str, Floats] = {
            "linear": library.linear_energies.sum(axis=1, dtype=np.float64)[self.rows],
            "rotational": _rotational(library, preset, mask)[self.rows],
        }
        if mask is not None:
            self.values = {**self.values, "mask": spared_energies(library, mask)[self.rows]}
        _require_terms(terms)
        for term in terms:
            if isinstance(term, SegmentTerm):
                self.values = {**self.values, term.name: _checked(term, library)[self.rows]}
        self.first_poses = np.asarray(library.first_poses[self.rows], dtype=np.float32)
        self.last_poses = np.asarray(library.last_poses[self.rows], dtype=np.float32)
        takes, starts_s = library.movements
        self.takes, self.starts_s = takes[self.rows], starts_s[self.rows]
        self._distances = distances(library, preset.variety)
        self._successors = self._followers()
        limits = np.full(24, np.inf) if mask is None else mask.speed_limits_rad_s
        # The pelvis is turned as a whole where segments meet; the finished dance is asked about it.
        self.protected = np.flatnonzero(np.isfinite(limits) & (np.arange(24) > 0))
        self.speed_limits: Floats = limits[self.protected]
        self.tails, self.heads = self._ends()

    def _followers(self) -> NDArray[np.int32]:
        """Give the successors of every segment among those that may be danced."""
        if self.size == len(self.library):
            return np.ascontiguousarray(self.library.successors, dtype=np.int32)
        from studykit.choreography.neighbours import successors

        return successors(self.first_poses, self.last_poses)

    def _ends(self) -> tuple[Floats, Floats]:
        """Give the rotations of protected joints at both ends, each shape (segment, joint, 7, 4)."""
        shape = (self.size, len(self.protected), _TAIL, 4)
        tails, heads = np.zeros(shape), np.zeros(shape)
        if len(self.protected):
            for number, row in enumerate(self.rows):
                rotations = np.asarray(self.library.rotations[int(row)])[:, self.protected]
                tails[number] = rotations[-_TAIL:].swapaxes(0, 1)
                heads[number] = rotations[:_TAIL].swapaxes(0, 1)
        return tails, heads

    def library_rows(self, blocks: Blocks) -> Blocks:
        """Give the rows of the library that segments stand for."""
        return tuple(tuple(int(self.rows[segment]) for segment in block) for block in blocks)

    def successors(self, segment: int) -> Sequence[int]:
        """Give the segments that begin much as one ends."""
        found: list[int] = self._successors[segment].tolist()
        return found

    @cached_property
    def tables(self) -> Tables:
        """Everything the compiled search reads, laid out once."""
        table, reduced = self.table, self.reduced
        tables = Tables(
            values=np.stack(list(self.values.values())),
            first_poses=np.ascontiguousarray(self.first_poses.swapaxes(1, 2)),
            last_poses=np.ascontiguousarray(self.last_poses.swapaxes(1, 2)),
            distances=np.zeros((0, 0)) if table is None else table,
            coordinates=np.zeros((0, 0), dtype=np.float32) if reduced is None else reduced.coordinates,
            residuals=np.zeros(0) if reduced is None else reduced.residuals**2,
            takes=np.ascontiguousarray(self.takes),
            starts_s=np.ascontiguousarray(self.starts_s),
            successors=self._successors,
            tails=self.tails,
            heads=self.heads,
            speed_limits=np.ascontiguousarray(self.speed_limits),
        )
        # What is mapped from disk cannot be written to; were that not so of all, each kind would be compiled.
        return Tables._make(map(_read_only, tables))

    @cached_property
    def reduced(self) -> Reduced | None:
        """Reduced features, where not all distances are kept and the metric has them."""
        if not self._distances.is_reduced or self.library.reduced is None:
            return None
        kept = self.library.reduced
        return Reduced(
            coordinates=np.ascontiguousarray(kept.coordinates[self.rows]),
            residuals=np.ascontiguousarray(kept.residuals[self.rows]),
        )

    @cached_property
    def table(self) -> Floats | None:
        """Distances of all pairs, shape (segment, segment), where they are kept."""
        dense = self._distances.table
        if dense is None or self.size == len(self.library):
            return dense
        return np.ascontiguousarray(dense[np.ix_(self.rows, self.rows)])

    def distance(self, one: int, other: int) -> float:
        """Give how different two segments are, as the search sees it."""
        return self._distances.guide(int(self.rows[one]), int(self.rows[other]))

    def displacement(self, before: int, after: int) -> float:
        """Give how far the joints jump where one segment follows another (Eq. 3), m."""
        jump = self.first_poses[after].astype(np.float64) - self.last_poses[before]
        return float(np.linalg.norm(jump, axis=-1).mean())

    @property
    def movements(self) -> int:
        """How many segments can stand side by side without a movement that comes back."""
        count = 0
        for take in np.unique(self.takes):
            last = -np.inf
            for start in np.unique(self.starts_s[self.takes == take]):
                if start - last >= MOVEMENT_S:
                    count, last = count + 1, start
        return count

    def same_movement(self, one: int, other: int) -> bool:
        """Tell whether two segments are the same, mirror images, or overlapping pieces of one take."""
        apart = abs(self.starts_s[one] - self.starts_s[other])
        return bool(self.takes[one] == self.takes[other] and apart < MOVEMENT_S)

    def is_held(self, before: int, after: int) -> bool:
        """Tell whether protected joints stay below their limits where one segment follows another."""
        if not len(self.protected):
            return True
        from studykit.choreography.rjmcmc.join_speed import join_peak

        pairs = zip(self.tails[before], self.heads[after], self.speed_limits, strict=True)
        return all(join_peak(tail, head) <= limit for tail, head, limit in pairs)

    def measures(self, blocks: Blocks, *, is_exact: bool = False) -> Measures:
        """Measure a dance from nothing.

        Parameters
        ----------
        blocks : tuple of tuple of int
            Its segments.
        is_exact : bool
            Whether varieties come from the features themselves, where the search only has them reduced.
        """
        joins = pairwise(chain.from_iterable(blocks))
        return Measures(
            segments=blocks,
            blocks={
                "duration": tuple(len(block) * SEGMENT_S for block in blocks),
                "variety": tuple(self.variety(block, is_exact=is_exact) for block in blocks),
                **{
                    name: tuple(float(sum(values[segment] for segment in block)) for block in blocks)
                    for name, values in self.values.items()
                },
            },
            displacements_m=tuple(self.displacement(*join) for join in joins),
        )

    def variety(self, block: tuple[int, ...], *, is_exact: bool = False) -> float:
        """Give phi of Eq. 5 for the segments of one block; 0 for a single one."""
        pairs = len(block) * (len(block) - 1) // 2
        if not pairs:
            return 0.0
        if is_exact:
            rows = [int(self.rows[segment]) for segment in block]
            return float(self._distances.exact(rows).sum()) / (2 * pairs)
        total = 0.0
        for place, segment in enumerate(block):
            for other in block[:place]:
                total += self.distance(segment, other)
        return total / pairs


def repertoire(
    library: DanceLibrary, preset: Preset, mask: JointMask | None, terms: tuple[SegmentTerm | CostTerm, ...]
) -> Repertoire:
    """Give a repertoire, kept for the dances that follow; with terms of one's own, which may change, anew."""
    return Repertoire(library, preset, mask=mask, terms=terms) if terms else _kept(library, preset, mask)


@lru_cache(maxsize=8)
def _kept(library: DanceLibrary, preset: Preset, mask: JointMask | None) -> Repertoire:
    return Repertoire(library, preset, mask=mask)


def allowed(library: DanceLibrary, mask: JointMask | None) -> Integers:
    """Give the segments in which no protected joint exceeds its limits.

    Raises
    ------
    InputError
        If there is none.
    """
    if mask is None:
        return np.arange(len(library))
    rows = np.flatnonzero(mask.keeps(library.peak_speeds, library.peak_angles).all(axis=1))
    if not len(rows):
        speeds, angles = mask.speed_limits_rad_s, mask.angle_limits_rad
        excess = np.maximum(library.peak_speeds / speeds, library.peak_angles / angles).max(axis=1)
        raise InputError(
            f"{', '.join(mask.spared)} exceed their limits in every segment, at best {excess.min():.2f}-fold",
            where=library.name,
            remedy="allow more, or splice still limbs in",
        )
    return rows


def _rotational(library: DanceLibrary, preset: Preset, mask: JointMask | None) -> Floats:
    """Give the rotational energy of each segment; Eq. 11 as printed leaves out what spared joints do."""
    if mask is None or not preset.masks_energies:
        return np.asarray(library.rotational_energies.sum(axis=1), dtype=np.float64)
    return np.asarray(library.rotational_energies @ mask.weights, dtype=np.float64)


def _read_only(array: Any) -> NDArray[Any]:
    view = np.asarray(array).view()
    view.flags.writeable = False
    return view


def _require_terms(terms: Sequence[SegmentTerm | CostTerm]) -> None:
    taken = {"duration", "variety", "linear", "rotational", "mask", "transition"}
    for term in terms:
        if term.name in taken:
            problem = f'there is a term "{term.name}" already'
            raise InputError(problem, where="terms", remedy="give it another name")
        taken.add(term.name)
        if not 0.0 <= getattr(term, "weight", 0.0) < math.inf:
            problem = f"a weight of {term.weight:g}"
            raise InputError(problem, where=f"the term {term.name}", remedy="give 0 or more")
        if isinstance(term, SegmentTerm):
            if not (math.isfinite(term.target) and 0.0 < term.tolerance < math.inf):
                problem = f"a target of {term.target:g} and a tolerance of {term.tolerance:g}"
                remedy = "give numbers, the tolerance above 0"
                raise InputError(problem, where=f"the term {term.name}", remedy=remedy)
        elif not hasattr(term, "cost"):
            problem = "it has neither a cost, nor a target, a tolerance and values"
            raise InputError(problem, where=f"the term {term.name}", remedy="see CostTerm and SegmentTerm")


def _checked(term: SegmentTerm, library: DanceLibrary) -> Floats:
    values = np.asarray(term.values(library), dtype=np.float64)
    if values.shape != (len(library),) or not np.isfinite(values).all():
        raise InputError(
            f"its values have the shape {values.shape} or are not all numbers",
            where=f"the term {term.name}",
            remedy=f"give one number for each of the {len(library)} segments",
        )
    return values
