"""What is measured on a dance in the making: all that its costs depend on."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True, slots=True)
class Measures:
    """The measures of a sequence of segments.

    Parameters
    ----------
    duration_s : float
        Length of the dance.
    linear_energy, rotational_energy : float, J per kg
        Sums of Eq. 8 and 11 over all poses, within segments.
    variety : float
        phi of Eq. 5, in the unit of the metric in use.
    displacements_m : tuple of float
        Eq. 3 at each join, m.
    """

    duration_s: float
    linear_energy: float
    rotational_energy: float
    variety: float
    displacements_m: tuple[float, ...]
