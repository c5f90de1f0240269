"""What is measured on a dance in the making: all that its costs depend on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

Blocks = tuple[tuple[int, ...], ...]
"""A dance in the making: the numbers of its segments, block by block."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Measures:
    """The measures of a sequence of segments.

    Parameters
    ----------
    segments : tuple of tuple of int
        The segments themselves, block by block.
    blocks : mapping of str to tuple of float
        One number a block for each measure: `duration` in s, `variety` (phi of Eq. 5, in the unit of the
        metric in use), `linear` and `rotational` energy (sums of Eq. 8 and 11 over all poses, within
        segments, J per kg), and whatever further terms add up.
    displacements_m : tuple of float
        Eq. 3 at each join, also between blocks, m.
    """

    segments: Blocks
    blocks: Mapping[str, tuple[float, ...]]
    displacements_m: tuple[float, ...]

    @property
    def duration_s(self) -> float:
        """Length of the whole dance."""
        return sum(self.blocks["duration"])

    @property
    def linear_energy(self) -> float:
        """Linear energy of the whole dance, J per kg."""
        return sum(self.blocks["linear"])

    @property
    def rotational_energy(self) -> float:
        """Rotational energy of the whole dance, J per kg."""
        return sum(self.blocks["rotational"])

    @property
    def variety(self) -> float:
        """Variety within the blocks of more than one segment, a longer one counting for more."""
        return mean_variety(self.blocks["variety"], tuple(len(block) for block in self.segments))


def mean_variety(varieties: tuple[float, ...], segments: tuple[int, ...]) -> float:
    """Give the mean of blocks' varieties, weighted by their segments; 0 where no block has two."""
    counted = [(count, variety) for count, variety in zip(segments, varieties, strict=True) if count > 1]
    total = sum(count for count, _ in counted)
    return sum(count * variety for count, variety in counted) / total if total else 0.0
