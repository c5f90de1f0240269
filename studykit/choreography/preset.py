"""How the paper is read: studykit's reading, and the printed one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from studykit.choreography.cost.block import Scale
from studykit.choreography.cost.term import Form
from studykit.choreography.rjmcmc.annealing import Annealing
from studykit.motion.blending import Blend

Metric = Literal["euclidean_z", "cosine"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Preset:
    """One reading of the paper's formulas and search.

    Parameters
    ----------
    name : str
        What dances are marked with.
    variety : {"euclidean_z", "cosine"}
        Metric between segments: Eq. 5 as printed is "cosine".
    form : {"mean_of_costs", "printed"}
        How joins (Eq. 4) and blocks (Eq. 14) make one cost.
    intensity : {"log", "absolute"}
        Scale of Eq. 9 and 12.
    masks_energies : bool
        Whether spared joints do not count for the energies (Eq. 11). Otherwise the energy of the whole body
        is as asked, and what spared joints do has a cost of its own.
    moves : {"anywhere", "at_end"}
        Where a new segment is inserted.
    acceptance : {"exact", "metropolis"}
        "exact" keeps the search reversible; "metropolis" is Eq. 13 alone.
    copies : bool
        Whether segments already in the dance are proposed again where the variety asked for needs repetition,
        and never where it does not.
    neighbour : float
        Share of new segments that are drawn from those that begin much as the one before ends.
    annealing, preview : Annealing
        Temperatures and tolerances over the iterations; the same for a first look.
    chains, preview_chains : int
        Searches from different beginnings, of which the best is taken.
    descent : float
        How much more the blocks' own terms count in the descent that ends each search, in which single
        segments and pairs are changed while that helps; 0 leaves the descent out.
    blend : {"offset", "bridge"}
        How segments are joined; see `motion.blending.joined`.
    is_cleaned : bool
        Whether joins are smoothed and standing feet held; see `motion.animation.animate`.
    is_reached : bool
        Whether its targets can be reached: a dance that misses them is then an error, not a result.
    """

    name: str
    variety: Metric
    form: Form
    intensity: Scale
    masks_energies: bool
    moves: Literal["anywhere", "at_end"]
    acceptance: Literal["exact", "metropolis"]
    copies: bool
    neighbour: float
    annealing: Annealing = field(hash=False)
    preview: Annealing = field(hash=False)
    chains: int
    preview_chains: int
    descent: float
    blend: Blend
    is_cleaned: bool
    is_reached: bool


STUDYKIT = Preset(
    name="studykit",
    variety="euclidean_z",
    form="mean_of_costs",
    intensity="log",
    masks_energies=False,
    moves="anywhere",
    acceptance="exact",
    copies=True,
    neighbour=0.3,
    annealing=Annealing.geometric(iterations=60_000, start=0.3, end=0.001, start_width=6.0),
    preview=Annealing.geometric(iterations=10_000, start=0.3, end=0.001, start_width=6.0),
    chains=12,
    preview_chains=2,
    descent=5.0,
    blend="offset",
    is_cleaned=True,
    is_reached=True,
)
"""The reading whose targets are reached."""

PAPER = Preset(
    name="paper",
    variety="cosine",
    form="printed",
    intensity="absolute",
    masks_energies=True,
    moves="at_end",
    acceptance="metropolis",
    copies=False,
    neighbour=0.0,
    annealing=Annealing.paper(),
    preview=Annealing.paper(),
    chains=1,
    preview_chains=1,
    descent=0.0,
    blend="bridge",
    is_cleaned=False,
    is_reached=False,
)
"""The printed formulas, constants and search, but for a bound on the length, without which it diverges."""

PRESETS = {preset.name: preset for preset in (STUDYKIT, PAPER)}
